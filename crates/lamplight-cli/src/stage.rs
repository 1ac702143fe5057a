//! The stages of a frame as pictures.

use crate::device_info::DeviceInfo;
use crate::error::{CliError, Result};
use image::{RgbImage, imageops};
use lamplight::{Cells, Display, Light, Rgb, debug_views};

/// A stage of a frame to show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Stage {
    /// Light that cells emit, with lamps drawn in.
    Emission,
    /// Opacity; white is solid.
    Opacity,
    /// Fraction of the light that cells reflect or scatter.
    Albedo,
    /// Colour filter of the light that passes through cells.
    Tint,
    /// Nearest occupied cell of each cell, as colours.
    Voronoi,
    /// Distance to the nearest occupied cell, with contour lines.
    Distance,
    /// Light alone, without the colours it falls on.
    Light,
    /// Final picture.
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

    /// A caption for the stage.
    pub fn caption(self) -> &'static str {
        match self {
            Self::Emission => "light that cells emit, with lamps drawn in",
            Self::Opacity => "white is solid",
            Self::Albedo => "fraction of the light that is reflected",
            Self::Tint => "colour filter of the light that passes",
            Self::Voronoi => "nearest occupied cell, one colour each",
            Self::Distance => "px to the nearest occupied cell",
            Self::Light => "light alone, tone mapped",
            Self::Final => "colour × light, tone mapped",
        }
    }

    /// True if the stage shows light, which has to be found first.
    pub fn needs_light(self) -> bool {
        matches!(self, Self::Light | Self::Final)
    }

    /// True if the stage shows [`Fields`].
    pub fn needs_fields(self) -> bool {
        matches!(self, Self::Voronoi | Self::Distance)
    }
}

/// The parts of a frame, and how they are shown.
pub struct FrameView<'a> {
    cells: &'a Cells,
    drawn: &'a Cells,
    light: Option<&'a Light>,
    fields: Option<&'a Fields>,
    display: Display,
}

/// The stages before any rays.
pub struct Fields {
    /// The nearest occupied cell of each cell, packed as in [`lamplight::Stages`].
    pub nearest: Vec<u32>,
    /// Distance to it, px; infinite in a grid without matter.
    pub distance: Vec<f32>,
    /// The device that found them.
    pub device: DeviceInfo,
}

impl<'a> FrameView<'a> {
    /// A view of cells; `drawn` have their lamps drawn in.
    pub fn new(cells: &'a Cells, drawn: &'a Cells, display: Display) -> Self {
        Self { cells, drawn, light: None, fields: None, display }
    }

    /// Adds light.
    pub fn lit(mut self, light: &'a Light) -> Self {
        self.light = Some(light);
        self
    }

    /// Adds the stages before any rays.
    pub fn with_fields(mut self, fields: &'a Fields) -> Self {
        self.fields = Some(fields);
        self
    }

    /// A stage as a picture, with `scale` × `scale` pixels per cell.
    pub fn picture(&self, stage: Stage, scale: u32) -> Result<RgbImage> {
        let picture = match stage {
            Stage::Emission => debug_views::emission(self.drawn, &self.display),
            Stage::Albedo => debug_views::albedo(self.drawn),
            Stage::Opacity => debug_views::opacity(self.drawn),
            Stage::Tint => debug_views::tint(self.drawn),
            Stage::Voronoi => debug_views::seeds(self.cells.width(), &self.fields()?.nearest),
            Stage::Distance => debug_views::distance(self.cells.width(), &self.fields()?.distance),
            Stage::Light => self.light()?.picture(&self.display)?,
            Stage::Final => self.light()?.compose(self.cells, &self.display)?,
        };
        enlarge(&picture, scale)
    }

    /// A stage as the layers of a file of linear numbers: itself, without a name, and for light its first moment if it
    /// was found.
    pub fn layers(&self, stage: Stage) -> Result<Vec<(&'static str, Vec<Rgb>)>> {
        let mut layers = vec![("", self.floats(stage)?)];
        let moment = if stage == Stage::Light { self.light()?.moment() } else { None };
        if let Some(moment) = moment {
            layers.push(("moment.x", moment.iter().map(|[x, _]| *x).collect()));
            layers.push(("moment.y", moment.iter().map(|[_, y]| *y).collect()));
        }
        Ok(layers)
    }

    /// A stage as linear numbers. Only the final picture has exposure applied.
    fn floats(&self, stage: Stage) -> Result<Vec<Rgb>> {
        let grey = |values: &[f32]| values.iter().map(|&v| [v; 3]).collect();
        Ok(match stage {
            Stage::Emission => debug_views::emitted(self.drawn).into_owned(),
            Stage::Opacity => grey(self.drawn.opacity()),
            Stage::Albedo => self.drawn.albedo().to_vec(),
            Stage::Tint => self.drawn.tint().to_vec(),
            Stage::Voronoi => {
                return Err(CliError::bad_input(
                    "the stage voronoi is a picture of cells, not of numbers",
                )
                .hint("write it to a file that ends in .png"));
            }
            Stage::Distance => grey(&self.fields()?.distance),
            Stage::Light => self.light()?.pixels().to_vec(),
            Stage::Final => {
                let gain = self.display.gain();
                let mut seen = self.light()?.radiance(self.cells, &self.display)?;
                seen.as_flattened_mut().iter_mut().for_each(|v| *v *= gain);
                seen
            }
        })
    }

    fn light(&self) -> Result<&Light> {
        self.light.ok_or_else(|| CliError::failed("this frame has not been lit"))
    }

    fn fields(&self) -> Result<&Fields> {
        self.fields.ok_or_else(|| CliError::failed("this frame has not been solved"))
    }
}

/// Refuses pictures that are too large.
pub fn check_scale([width, height]: [u32; 2], scale: u32) -> Result {
    let [wide, high] = [width, height].map(|side| u64::from(side) * u64::from(scale));
    if wide * high <= MOST_PIXELS {
        return Ok(());
    }
    Err(CliError::bad_input(format_args!(
        "--scale {scale} makes {wide}×{high} pixels of {width}×{height} cells: more than {} million pixels",
        MOST_PIXELS >> 20
    )))
}

/// A picture with each pixel repeated `scale` × `scale` times.
pub fn enlarge(picture: &RgbImage, scale: u32) -> Result<RgbImage> {
    let (w, h) = (picture.width(), picture.height());
    check_scale([w, h], scale)?;
    if scale == 1 {
        return Ok(picture.clone());
    }
    Ok(imageops::resize(picture, w * scale, h * scale, imageops::FilterType::Nearest))
}

/// Most pixels of an enlarged picture.
const MOST_PIXELS: u64 = 1 << 28;
