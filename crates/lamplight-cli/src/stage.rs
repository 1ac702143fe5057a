//! The stages of a frame as pictures.

use crate::failure::{Failure, Outcome};
use crate::place::Place;
use image::{RgbImage, imageops};
use lamplight::{Cells, Display, Light, Rgb, views};

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
    /// The nearest occupied cell of each cell, packed ([`lamplight::stages::seed`]).
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
        let picture = match stage {
            Stage::Emission => views::emission(self.cells, &self.display),
            Stage::Albedo => views::albedo(self.cells),
            Stage::Opacity => views::opacity(self.cells),
            Stage::Tint => views::tint(self.cells),
            Stage::Voronoi => views::seeds(self.cells.width(), &self.fields()?.nearest),
            Stage::Distance => views::distance(self.cells.width(), &self.fields()?.distance),
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
