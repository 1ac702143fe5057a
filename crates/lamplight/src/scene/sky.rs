//! The sky as a scene's author gives it: by values, or as a picture.

use super::picture::Picture;
use super::source::Source;
use crate::exact::Exact;
use crate::{Cells, Error, Gradient, Panorama, Result, Rgb, Sky, check, notation};
use schemars::JsonSchema;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error as _, MapAccess, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::path::PathBuf;

/// The sky of a scene.
///
/// In a file either one colour, `sky = [0.1, 0.1, 0.2]`, a gradient,
/// `sky = { zenith = […], horizon = […], ground = […] }`, a panorama, `sky = { columns = ["#102040", …] }`, or a
/// panorama as a picture, `sky = { picture = "dusk.png" }`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[non_exhaustive]
pub enum SceneSky {
    /// Its radiance.
    Radiance(Sky),
    /// A picture of its radiance.
    Picture(SkyPicture),
}

/// A panorama as a picture: each column is the mean radiance of the picture's column, in the order of [`Panorama`].
///
/// A PNG, EXR, WebP or JPEG of up to [`Panorama::MAX_COLUMNS`] px in width and any height. An EXR is linear as it is,
/// other images are sRGB-decoded; transparent pixels are black.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(
    deny_unknown_fields,
    description = "A sky that differs all the way round, as a picture."
)]
pub struct SkyPicture {
    /// The image; a relative path starts at the scene file's folder.
    pub picture: PathBuf,
    /// Multiplies the radiance, 0 to 1e6.
    #[serde(skip_serializing_if = "is_one")]
    #[schemars(default = "one")]
    pub intensity: f32,
    /// The angle by which the sky is turned, radians from +x towards +y.
    #[serde(skip_serializing_if = "notation::is_zero")]
    #[schemars(default, with = "notation::Angle")]
    pub turn: f32,
}

fn one() -> f32 {
    1.0
}

fn is_one(value: &f32) -> bool {
    *value == 1.0
}

impl SkyPicture {
    /// A picture of intensity 1 that is not turned.
    pub fn new(picture: impl Into<PathBuf>) -> Self {
        Self { picture: picture.into(), intensity: one(), turn: 0.0 }
    }

    /// Reads the panorama.
    fn read(&self, source: Source) -> Result<Panorama> {
        const KEY: &str = "sky.picture";
        let path = source.place(&self.picture);
        let most = Panorama::MAX_COLUMNS;
        let fits = |width, height| {
            let area = Cells::check_size(u64::from(width), u64::from(height));
            if area.is_ok() && width as usize <= most {
                return Ok(());
            }
            let found = format!("an image of {width}×{height} px ({})", path.display());
            let expected = format!("of at most {most} columns and {} px", Cells::MAX_CELLS);
            Err(Error::value(KEY, found, expected))
        };
        let picture = Picture::open(source, &path, KEY, fits)?;
        let [width, height] = picture.size();
        let scale = f64::from(self.intensity) / f64::from(height);
        let column = |x| {
            let mut sum = [0.0; 3];
            for y in 0..height {
                let (rgb, alpha) = picture.color(x, y);
                (0..3).for_each(|c| sum[c] += f64::from(rgb[c] * alpha));
            }
            sum.map(|v| (v * scale) as f32)
        };
        let columns: Vec<Rgb> = (0..width).map(column).collect();
        let valid = |v: &f32| (0.0..=check::BRIGHT).contains(v);
        if let Some(v) = columns.as_flattened().iter().find(|v| !valid(v)) {
            let found = format!("an image with a column of {v} ({})", path.display());
            return Err(Error::value(KEY, found, "of radiances from 0 to 1e12"));
        }
        Ok(Panorama::new(&columns)?.turned(self.turn))
    }
}

impl SceneSky {
    /// Returns whether it is the sky of a scene that gives none.
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// The image, as the scene names it.
    pub(crate) fn image(&self) -> Option<&PathBuf> {
        match self {
            Self::Radiance(_) => None,
            Self::Picture(sky) => Some(&sky.picture),
        }
    }

    /// Refuses values that no sky has. The image is not opened.
    pub(crate) fn check(&self) -> Result<()> {
        match self {
            Self::Radiance(sky) => sky.check(),
            Self::Picture(sky) => {
                check::image("sky.picture", &sky.picture)?;
                check::number("sky.intensity", sky.intensity, 0.0..=1e6)?;
                check::direction("sky.turn", sky.turn)
            }
        }
    }

    /// The radiance, with that of the picture read.
    pub(crate) fn read(&self, source: Source) -> Result<Sky> {
        match self {
            Self::Radiance(sky) => Ok(sky.clone()),
            Self::Picture(sky) => sky.read(source).map(Sky::from),
        }
    }
}

/// The keys of all notations that are tables.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Table {
    #[serde(default, deserialize_with = "notation::optional_color")]
    zenith: Option<Rgb>,
    #[serde(default, deserialize_with = "notation::optional_color")]
    horizon: Option<Rgb>,
    #[serde(default, deserialize_with = "notation::optional_color")]
    ground: Option<Rgb>,
    #[serde(default, deserialize_with = "columns")]
    columns: Option<Panorama>,
    picture: Option<PathBuf>,
    intensity: Option<f32>,
    #[serde(default, deserialize_with = "notation::angle")]
    turn: f32,
}

fn columns<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Panorama>, D::Error> {
    let columns = notation::colors(from)?;
    let wrong = || D::Error::invalid_length(columns.len(), &Panorama::EXPECTED);
    Panorama::of(&columns).ok_or_else(wrong).map(Some)
}

impl Table {
    /// Returns the sky of the one notation that is used.
    fn sky<E: serde::de::Error>(self) -> Result<SceneSky, E> {
        let Self { zenith, horizon, ground, columns, picture, intensity, turn } = self;
        let gradient = [zenith, horizon, ground].iter().any(Option::is_some);
        match (picture, columns) {
            (Some(picture), None) if !gradient => {
                let intensity = intensity.unwrap_or_else(one);
                Ok(SkyPicture { picture, intensity, turn }.into())
            }
            (None, Some(columns)) if !gradient && intensity.is_none() => {
                Ok(Sky::from(columns.turned(turn)).into())
            }
            (None, None) if intensity.is_none() && turn == 0.0 => Ok(Sky::from(Gradient {
                zenith: zenith.ok_or_else(|| E::missing_field("zenith"))?,
                horizon: horizon.ok_or_else(|| E::missing_field("horizon"))?,
                ground: ground.ok_or_else(|| E::missing_field("ground"))?,
            })
            .into()),
            _ => Err(E::invalid_value(
                Unexpected::Other("a mixture of several"),
                &"{ zenith, horizon, ground }, { columns, turn } or { picture, intensity, turn }",
            )),
        }
    }
}

/// Written by hand, so that errors name the form and the colour that are wrong.
impl<'de> Deserialize<'de> for SceneSky {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Notation;

        impl<'de> Visitor<'de> for Notation {
            type Value = SceneSky;

            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(
                    "a colour, [r, g, b] or \"#rrggbb\", or { zenith, horizon, ground }, { columns } \
                     or { picture }",
                )
            }

            fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<SceneSky, A::Error> {
                let Exact(rgb) = Exact::deserialize(SeqAccessDeserializer::new(list))?;
                Ok(SceneSky::from(Sky::Uniform(rgb)))
            }

            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<SceneSky, E> {
                let wrong = || E::invalid_value(Unexpected::Str(text), &self);
                notation::hex(text).map(|rgb| Sky::Uniform(rgb).into()).ok_or_else(wrong)
            }

            fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<SceneSky, A::Error> {
                Table::deserialize(MapAccessDeserializer::new(table))?.sky()
            }
        }

        from.deserialize_any(Notation)
    }
}

impl<S: Into<Sky>> From<S> for SceneSky {
    fn from(sky: S) -> Self {
        Self::Radiance(sky.into())
    }
}

impl From<SkyPicture> for SceneSky {
    fn from(picture: SkyPicture) -> Self {
        Self::Picture(picture)
    }
}

impl Default for SceneSky {
    fn default() -> Self {
        Self::Radiance(Sky::BLACK)
    }
}
