//! The stages of a frame as pictures.

use crate::failure::{Failure, Outcome};
use crate::place::Place;
use image::{Rgb as Pixel, RgbImage, imageops};
use lamplight::stages::seed::{NONE, unpack};
use lamplight::{Cells, Display, Light, Rgb, ToneMap};

/// What of a frame is to be seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Stage {
    /// What the cells give off, lamps drawn in.
    Emission,
    /// White is solid.
    Opacity,
    /// What share of light the cells send on.
    Albedo,
    /// What colours light takes on in passing through the cells.
    Tint,
    /// Each cell in the colour of the occupied cell nearest to it, as the jump flood found it.
    Voronoi,
    /// Distance to the nearest occupied cell, with contour lines.
    Distance,
    /// The light that arrives at each cell, alone.
    Light,
    /// The final picture.
    #[default]
    Final,
}

impl Stage {
    /// Every stage, in the order of a frame.
    pub const ALL: [Self; 8] = [
        Self::Emission,
        Self::Opacity,
        Self::Albedo,
        Self::Tint,
        Self::Voronoi,
        Self::Distance,
        Self::Light,
        Self::Final,
    ];

    /// The name in flags and file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Emission => "emission",
            Self::Opacity => "opacity",
            Self::Albedo => "albedo",
            Self::Tint => "tint",
            Self::Voronoi => "voronoi",
            Self::Distance => "distance",
            Self::Light => "light",
            Self::Final => "final",
        }
    }

    /// What the stage shows, in a few words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Emission => "the light that cells give off, lamps drawn in",
            Self::Opacity => "what stops light: white is solid",
            Self::Albedo => "the share of light that is sent on",
            Self::Tint => "the colour filter of what light passes",
            Self::Voronoi => "the nearest occupied cell, a colour each",
            Self::Distance => "px to it, with contour lines",
            Self::Light => "the light that arrives, alone, tone mapped",
            Self::Final => "colour × light, tone mapped",
        }
    }

    /// Whether the stage shows what arrives, so that the frame has to be lit.
    pub fn needs_light(self) -> bool {
        matches!(self, Self::Light | Self::Final)
    }

    /// Whether the stage shows [`Fields`].
    pub fn needs_fields(self) -> bool {
        matches!(self, Self::Voronoi | Self::Distance)
    }
}

/// A frame to be looked at: what there is of it, and how it is to be shown.
pub struct View<'a> {
    cells: &'a Cells,
    light: Option<&'a Light>,
    fields: Option<&'a Fields>,
    display: Display,
}

/// The stages before the rays.
pub struct Fields {
    /// The nearest occupied cell of each cell, packed; [`NONE`] where there is no matter.
    pub nearest: Vec<u32>,
    /// px to it; infinite where there is no matter.
    pub distance: Vec<f32>,
    /// Where they were found.
    pub place: Place,
}

impl<'a> View<'a> {
    /// The cells (lamps drawn in), shown through `display`.
    pub fn new(cells: &'a Cells, display: Display) -> Self {
        Self { cells, light: None, fields: None, display }
    }

    /// With light.
    pub fn lit(mut self, light: &'a Light) -> Self {
        self.light = Some(light);
        self
    }

    /// With the stages before the rays.
    pub fn with_fields(mut self, fields: &'a Fields) -> Self {
        self.fields = Some(fields);
        self
    }

    /// A stage as a picture, each cell as `scale` × `scale` pixels.
    pub fn picture(&self, stage: Stage, scale: u32) -> Outcome<RgbImage> {
        let (w, h) = (self.cells.width(), self.cells.height());
        let plain = Display { tonemap: ToneMap::None, exposure: 0.0 };
        let picture = match stage {
            Stage::Emission => self.display.picture(w, h, self.cells.emission()),
            Stage::Albedo => plain.picture(w, h, self.cells.albedo()),
            // As layers hold them: shares, without sRGB.
            Stage::Opacity => pixels(w, h, |i| Pixel([share(self.cells.opacity()[i]); 3])),
            Stage::Tint => pixels(w, h, |i| Pixel(self.cells.tint()[i].map(share))),
            Stage::Voronoi => self.voronoi()?,
            Stage::Distance => self.distance()?,
            Stage::Light => self.light()?.picture(&self.display),
            Stage::Final => self.light()?.compose(self.cells, &self.display)?,
        };
        enlarge(&picture, scale)
    }

    /// A stage as linear numbers, nothing applied to them; the final picture with its exposure.
    pub fn floats(&self, stage: Stage) -> Outcome<Vec<Rgb>> {
        let grey = |values: &[f32]| values.iter().map(|&v| [v; 3]).collect();
        Ok(match stage {
            Stage::Emission => self.cells.emission().to_vec(),
            Stage::Opacity => grey(self.cells.opacity()),
            Stage::Albedo => self.cells.albedo().to_vec(),
            Stage::Tint => self.cells.tint().to_vec(),
            Stage::Voronoi => {
                return Err(Failure::bad_input(
                    "the stage voronoi is a picture of cells, not of numbers",
                )
                .hint("write it to a file that ends in .png"));
            }
            Stage::Distance => grey(&self.fields()?.distance),
            Stage::Light => self.light()?.pixels().to_vec(),
            Stage::Final => {
                let gain = self.display.gain();
                let mut seen = self.light()?.radiance(self.cells)?;
                seen.as_flattened_mut().iter_mut().for_each(|v| *v *= gain);
                seen
            }
        })
    }

    fn light(&self) -> Outcome<&Light> {
        self.light.ok_or_else(|| Failure::failed("this frame has not been lit"))
    }

    fn fields(&self) -> Outcome<&Fields> {
        self.fields.ok_or_else(|| Failure::failed("this frame has not been solved"))
    }

    fn voronoi(&self) -> Outcome<RgbImage> {
        let nearest = &self.fields()?.nearest;
        let width = self.cells.width();
        Ok(pixels(width, self.cells.height(), |i| {
            let seed = nearest[i];
            if seed == NONE {
                return Pixel([24, 24, 28]);
            }
            let [x, y] = unpack(seed);
            let is_seed = (y * width + x) as usize == i;
            Pixel(seed_color(seed, is_seed))
        }))
    }

    fn distance(&self) -> Outcome<RgbImage> {
        let distance = &self.fields()?.distance;
        let (w, h) = (self.cells.width() as usize, self.cells.height() as usize);
        let far = distance.iter().copied().filter(|d| d.is_finite()).fold(1.0, f32::max);
        let step = contour_step(far);
        let band = |i: usize| (distance[i] / step).floor();
        Ok(pixels(w as u32, h as u32, |i| {
            let d = distance[i];
            if !d.is_finite() {
                return Pixel([24, 24, 28]);
            }
            // A step from what is occupied to what is near, so that shapes stand out.
            let brightness = if d == 0.0 { 1.0 } else { 0.9 - 0.85 * f64::from(d / far) };
            let color = colorous::MAGMA.eval_continuous(brightness);
            let (x, y) = (i % w, i / w);
            let edge = d > 0.0
                && (x + 1 < w && band(i + 1) != band(i) || y + 1 < h && band(i + w) != band(i));
            let mix = |v: u8| if edge { (u16::from(v) + 255).div_ceil(2) as u8 } else { v };
            Pixel([mix(color.r), mix(color.g), mix(color.b)])
        }))
    }
}

/// 0 to 1 as a byte, without sRGB.
fn share(v: f32) -> u8 {
    (v * 255.0).round() as u8
}

fn pixels(width: u32, height: u32, at: impl Fn(usize) -> Pixel<u8>) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| at(y as usize * width as usize + x as usize))
}

/// px between contour lines: 1, 2 or 5 times a power of ten, about twelve lines to the farthest
/// cell.
fn contour_step(far: f32) -> f32 {
    let least = (far / 12.0).max(1.0);
    let power = 10f32.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|f| f * power).into_iter().find(|&s| s >= least).unwrap_or(least)
}

/// A colour for a seed: its hue by a hash, all of about the same lightness; the seeds themselves
/// are darker.
fn seed_color(seed: u32, is_seed: bool) -> [u8; 3] {
    // Two rounds of a multiplicative hash (Wellons' lowbias32): neighbours get unlike hues.
    let mut hash = seed;
    for factor in [0x7feb_352d, 0x846c_a68b] {
        hash = (hash ^ (hash >> 16)).wrapping_mul(factor);
    }
    hash ^= hash >> 16;
    let hue = f64::from(hash & 0xffff) / 65_536.0;
    let color = colorous::SINEBOW.eval_continuous(hue);
    let shade = if is_seed { 0.35 } else { 0.7 + f64::from(hash >> 16) / 65_536.0 * 0.3 };
    // Half way to grey: a map of pastel tiles, not confetti.
    let soften = |v: u8| ((f64::from(v) * 0.6 + 90.0) * shade) as u8;
    [soften(color.r), soften(color.g), soften(color.b)]
}

/// Each pixel as `scale` × `scale` of its kind.
pub fn enlarge(picture: &RgbImage, scale: u32) -> Outcome<RgbImage> {
    let (w, h) = (picture.width(), picture.height());
    if u64::from(w) * u64::from(h) * u64::from(scale).pow(2) > MOST_PIXELS {
        return Err(Failure::bad_input(format_args!(
            "--scale {scale} makes {}×{} pixels of {w}×{h} cells: more than {} million pixels",
            u64::from(w) * u64::from(scale),
            u64::from(h) * u64::from(scale),
            MOST_PIXELS >> 20
        )));
    }
    if scale == 1 {
        return Ok(picture.clone());
    }
    Ok(imageops::resize(picture, w * scale, h * scale, imageops::FilterType::Nearest))
}

/// Pictures beyond this many pixels are refused before memory for them is.
const MOST_PIXELS: u64 = 1 << 28;
