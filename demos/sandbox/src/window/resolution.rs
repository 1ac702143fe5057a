//! The resolution of light: all cells, or fewer and larger ones.

use anyhow::Result;
use lamplight::resample::{downsample, max_factor};
use lamplight::{Cells, Light, Settings};
use lamplight_sandbox::pace::Pace;

/// The size of cells of light, and its adaptation.
pub struct Resolution {
    /// The side of a cell of light, in cells.
    pub factor: u32,
    /// True if it adapts to frame times.
    pub adapts: bool,
    pace: Pace,
    coarse: Cells,
}

impl Resolution {
    pub fn new(adapts: bool) -> Result<Self> {
        Ok(Self { factor: 1, adapts, pace: Pace::default(), coarse: Cells::new(1, 1)? })
    }

    /// Sets the factor and stops adapting.
    pub fn choose(&mut self, factor: u32) {
        (self.factor, self.adapts) = (factor, false);
    }

    /// Draws the larger cells, if there are any.
    pub fn prepare(&mut self, cells: &Cells) -> Result<()> {
        if self.factor > 1 {
            downsample(cells, self.factor, &mut self.coarse)?;
        }
        Ok(())
    }

    /// The cells of light, as prepared.
    pub fn cells<'a>(&'a self, cells: &'a Cells) -> &'a Cells {
        if self.factor == 1 { cells } else { &self.coarse }
    }

    /// Converts settings in px to the px of these cells.
    pub fn settings(&self, settings: &Settings) -> Settings {
        Settings { wall_depth: settings.wall_depth / self.factor as f32, ..settings.clone() }
    }

    /// Observes a frame and adapts the factor for the next one.
    pub fn watch(&mut self, frame: f64, light: Option<f64>, columns: u32) {
        if self.adapts {
            self.factor = self.pace.advise(frame, light, self.factor, max_factor(columns));
        }
    }
}

/// The factor of a light in a picture of `width` columns.
pub fn factor(light: &Light, width: u32) -> u32 {
    width.div_ceil(light.width().max(1))
}
