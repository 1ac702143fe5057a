//! Cookies: pictures that lie on the plane around a lamp and multiply its light.

use crate::{Error, Result, Rgb, check, notation};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{Deserializer, Error as _, SeqAccess, Unexpected, Visitor};
use serde::ser::{SerializeSeq, Serializer};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt::{self, Display};
use std::path::PathBuf;
use std::sync::Arc;

/// A picture on the plane around a lamp, which multiplies the lamp's direct light: leaves above a lantern, the cross of a
/// window, the blotches of a torch.
///
/// The middle of the picture is at the lamp. It is `size` px wide, and its texels are square. At an offset p from the
/// lamp, light is multiplied per channel by the picture at p, turned back by `turn`. Values are linear between the
/// middles of texels and 0 outside, so that light ends half a texel beyond the edge, or earlier at the lamp's range.
///
/// Only the lamp's own light is multiplied, where it arrives. What walls and fog send on comes from there, and passes
/// beyond the picture. A lamp with a cookie is `exact`.
///
/// Cost: a lookup per cell that the lamp reaches; less than the light that black texels save. Limit: a picture much finer
/// than the cells is read at single points, not averaged over cells: shrink it to `size` texels.
///
/// ```
/// use lamplight::{Cookie, CookiePixels, Lamp};
/// // Red light to the left of the lamp, blue light to the right.
/// let pixels = CookiePixels::new([2, 1], &[[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])?;
/// let cookie = Cookie::new(pixels, 80.0);
/// assert_eq!(cookie.at([-20.0, 0.0]), [1.0, 0.0, 0.0]);
/// // A quarter turn, and red is above.
/// let cookie = Cookie { turn: std::f32::consts::FRAC_PI_2, ..cookie };
/// assert!(cookie.at([0.0, -20.0])[0] > 0.999);
/// let lamp = Lamp { position: [64.0, 48.0], cookie: Some(cookie), ..Lamp::default() };
/// assert!(lamp.is_exact());
/// # Ok::<(), lamplight::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(
    description = "A picture on the plane around a lamp, which multiplies the lamp's direct light."
)]
pub struct Cookie {
    /// The picture: a PNG, EXR, WebP or JPEG of up to 2048×2048 px, whose path starts at the scene file's folder, or rows of
    /// colours. An EXR is linear as it is, other images are sRGB-decoded; transparent pixels are black.
    pub picture: CookiePicture,
    /// The width of the picture on the plane, px, 0.1 to 100 000. Its height follows from its own proportions.
    pub size: f32,
    /// The angle by which the picture is turned around the lamp, radians from +x towards +y, −2π to 2π.
    #[serde(
        default,
        deserialize_with = "notation::angle",
        skip_serializing_if = "notation::is_zero"
    )]
    #[schemars(with = "notation::Angle")]
    pub turn: f32,
}

/// The picture of a [`Cookie`].
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum CookiePicture {
    /// An image that a scene names, and [`crate::Scene::cells`] reads. [`crate::Cells`] reject it.
    File(PathBuf),
    /// The pixels.
    Pixels(CookiePixels),
}

/// The pixels of a [`Cookie`]: linear RGB factors, 0 to 1e6. A clone shares them.
#[derive(Clone, Debug)]
pub struct CookiePixels {
    width: u32,
    height: u32,
    /// Rows from the top, each from the left.
    texels: Arc<[Rgb]>,
}

impl Cookie {
    /// Creates a cookie that is not turned, `size` px wide.
    pub fn new(picture: impl Into<CookiePicture>, size: f32) -> Self {
        Self { picture: picture.into(), size, turn: 0.0 }
    }

    /// The factors on the light at an offset from the lamp, px. 0 of a picture that has not been read.
    pub fn at(&self, offset: [f32; 2]) -> Rgb {
        self.pixels().map_or([0.0; 3], |pixels| pixels.at(offset, axis(self)))
    }

    /// The pixels; none of a picture that has not been read.
    pub fn pixels(&self) -> Option<&CookiePixels> {
        match &self.picture {
            CookiePicture::File(_) => None,
            CookiePicture::Pixels(pixels) => Some(pixels),
        }
    }

    /// The distance from the lamp beyond which all is black, px.
    pub(crate) fn reach(&self) -> f32 {
        self.pixels().map_or(0.0, |pixels| {
            let [width, height] = pixels.size().map(|side| side as f32 + 1.0);
            0.5 * width.hypot(height) * self.size / pixels.width as f32
        })
    }

    /// Validates the cookie of a lamp that is lit.
    pub(crate) fn check(&self, key: &dyn Display) -> Result<()> {
        if let CookiePicture::File(path) = &self.picture {
            let expected = "pixels: a picture by its path belongs to a scene, which reads it";
            return Err(Error::value(
                format!("{key}.picture"),
                format!("\"{}\"", path.display()),
                expected,
            ));
        }
        self.check_in_scene(key)
    }

    /// Validates the cookie of a lamp in a scene. An image is not opened.
    pub(crate) fn check_in_scene(&self, key: &dyn Display) -> Result<()> {
        if let CookiePicture::File(path) = &self.picture {
            check::image(format_args!("{key}.picture"), path)?;
        }
        check::number(format_args!("{key}.size"), self.size, 0.1..=1e5)?;
        check::direction(format_args!("{key}.turn"), self.turn)
    }
}

/// The direction of a cookie's rows, as long as there are texels per px.
pub fn axis(cookie: &Cookie) -> [f32; 2] {
    let per_px = cookie.pixels().map_or(0.0, |pixels| pixels.width as f32 / cookie.size);
    let (sin, cos) = cookie.turn.sin_cos();
    [cos * per_px, sin * per_px]
}

impl CookiePixels {
    /// The largest number of pixels a side.
    pub const MAX_SIDE: u32 = 2048;
    /// The largest factor.
    pub(crate) const BRIGHTEST: f32 = 1e6;
    const EXPECTED: &'static str =
        "the path of an image, or 1 to 2048 rows of colours, each with as many, up to 2048";

    /// Creates a picture of columns × rows from its pixels, linear RGB: rows from the top, each from the left.
    ///
    /// # Errors
    /// Fails if a side is 0 or longer than [`Self::MAX_SIDE`], there are not as many pixels, or a value is not from 0 to
    /// 1e6.
    pub fn new(size: [u32; 2], pixels: &[Rgb]) -> Result<Self> {
        const KEY: &str = "cookie.picture";
        let [width, height] = size;
        let sides = 1..=Self::MAX_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) {
            let expected = "of at least one pixel, and of at most 2048×2048 px";
            return Err(Error::value(KEY, format!("a picture of {width}×{height} px"), expected));
        }
        if pixels.len() as u64 != u64::from(width) * u64::from(height) {
            let found = format!("{} pixels", pixels.len());
            return Err(Error::value(KEY, found, format!("{width}×{height} pixels")));
        }
        if let Some([r, g, b]) = Self::wrong(pixels) {
            let expected = "pixels of three numbers from 0 to 1e6";
            return Err(Error::value(KEY, format!("a picture with [{r}, {g}, {b}]"), expected));
        }
        Ok(Self { width, height, texels: pixels.into() })
    }

    /// Returns the first pixel with a value out of its range.
    fn wrong(pixels: &[Rgb]) -> Option<Rgb> {
        let valid = |v: &f32| (0.0..=Self::BRIGHTEST).contains(v);
        pixels.iter().find(|rgb| !rgb.iter().all(valid)).copied()
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// The pixels, in rows.
    pub fn pixels(&self) -> &[Rgb] {
        &self.texels
    }

    /// Returns whether two share their pixels, so that one place in memory serves both.
    pub fn shares(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.texels, &other.texels) && self.size() == other.size()
    }

    /// The values at an offset from the middle, by the [`axis`] of the picture.
    #[inline]
    pub(crate) fn at(&self, [dx, dy]: [f32; 2], [ax, ay]: [f32; 2]) -> Rgb {
        let [width, height] = self.size().map(|side| side as f32);
        // In texels from the middle of the first.
        let x = ax * dx + ay * dy + (0.5 * width - 0.5);
        let y = ax * dy - ay * dx + (0.5 * height - 0.5);
        if !(x > -1.0 && y > -1.0 && x < width && y < height) {
            return [0.0; 3];
        }
        let (left, top) = (x.floor(), y.floor());
        let [top_left, top_right, below_left, below_right] =
            [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]
                .map(|[i, j]| self.texel(left + i, top + j));
        let (along, down) = (x - left, y - top);
        std::array::from_fn(|c| {
            let above = top_left[c] + (top_right[c] - top_left[c]) * along;
            let below = below_left[c] + (below_right[c] - below_left[c]) * along;
            above + (below - above) * down
        })
    }

    /// A texel; 0 outside.
    fn texel(&self, x: f32, y: f32) -> Rgb {
        let [width, height] = self.size().map(|side| side as f32);
        if x < 0.0 || y < 0.0 || x >= width || y >= height {
            return [0.0; 3];
        }
        self.texels[y as usize * self.width as usize + x as usize]
    }
}

impl PartialEq for CookiePixels {
    fn eq(&self, other: &Self) -> bool {
        // Most are clones of each other.
        self.shares(other) || (self.size() == other.size() && self.texels == other.texels)
    }
}

impl From<CookiePixels> for CookiePicture {
    fn from(pixels: CookiePixels) -> Self {
        Self::Pixels(pixels)
    }
}

impl From<&str> for CookiePicture {
    fn from(path: &str) -> Self {
        Self::File(path.into())
    }
}

impl From<PathBuf> for CookiePicture {
    fn from(path: PathBuf) -> Self {
        Self::File(path)
    }
}

impl Serialize for CookiePicture {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::File(path) => path.serialize(to),
            Self::Pixels(pixels) => {
                let mut rows = to.serialize_seq(Some(pixels.height as usize))?;
                for row in pixels.texels.chunks(pixels.width as usize) {
                    rows.serialize_element(row)?;
                }
                rows.end()
            }
        }
    }
}

/// Written by hand, so that errors name the value that is wrong.
impl<'de> Deserialize<'de> for CookiePicture {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Notation;

        impl<'de> Visitor<'de> for Notation {
            type Value = CookiePicture;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(CookiePixels::EXPECTED)
            }

            fn visit_str<E: serde::de::Error>(self, path: &str) -> Result<CookiePicture, E> {
                Ok(path.into())
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<CookiePicture, A::Error> {
                let (mut texels, mut width, mut height) = (Vec::new(), 0, 0u32);
                while let Some(PixelRow(row)) = list.next_element()? {
                    let fits = (1..=CookiePixels::MAX_SIDE as usize).contains(&row.len());
                    if !fits || height == CookiePixels::MAX_SIDE || height > 0 && row.len() != width
                    {
                        let found = format!("rows of which number {height} has {}", row.len());
                        return Err(A::Error::invalid_value(Unexpected::Other(&found), &self));
                    }
                    (width, height) = (row.len(), height + 1);
                    texels.extend(row);
                }
                if height == 0 {
                    return Err(A::Error::invalid_length(0, &self));
                }
                if let Some([r, g, b]) = CookiePixels::wrong(&texels) {
                    let found = format!("rows with [{r}, {g}, {b}]");
                    let expected = "colours of 0 to 1e6";
                    return Err(A::Error::invalid_value(Unexpected::Other(&found), &expected));
                }
                let width = width as u32;
                Ok(CookiePixels { width, height, texels: texels.into() }.into())
            }
        }

        from.deserialize_any(Notation)
    }
}

/// A row of colours.
struct PixelRow(Vec<Rgb>);

impl<'de> Deserialize<'de> for PixelRow {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        notation::colors(from).map(Self)
    }
}

impl JsonSchema for CookiePicture {
    fn schema_name() -> Cow<'static, str> {
        "CookiePicture".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let color = generator.subschema_for::<notation::Color>();
        let most = CookiePixels::MAX_SIDE;
        json_schema!({
            "anyOf": [
                { "description": "The path of an image.", "type": "string" },
                {
                    "description": "Rows of colours.",
                    "type": "array",
                    "minItems": 1,
                    "maxItems": most,
                    "items": { "type": "array", "items": color, "minItems": 1, "maxItems": most },
                },
            ],
        })
    }
}
