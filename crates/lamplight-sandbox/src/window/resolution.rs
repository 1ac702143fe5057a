//! On how many cells light is found: as many as there are, or fewer and larger ones.

use anyhow::Result;
use lamplight::coarse::{coarsen, coarsest};
use lamplight::{Cells, Light, Settings};
use lamplight_sandbox::pace::Pace;

/// How large cells are, and who decides.
pub struct Resolution {
    /// Each side of a cell of light, in cells.
    pub factor: u32,
    /// Whether frames that come late make it coarser.
    pub adapts: bool,
    pace: Pace,
    coarse: Cells,
}

impl Resolution {
    pub fn new(adapts: bool) -> Result<Self> {
        Ok(Self { factor: 1, adapts, pace: Pace::default(), coarse: Cells::new(1, 1)? })
    }

    /// Takes a factor for good: what somebody chose is not changed behind their back.
    pub fn choose(&mut self, factor: u32) {
        (self.factor, self.adapts) = (factor, false);
    }

    /// Draws the larger cells, where there are to be some.
    pub fn prepare(&mut self, cells: &Cells) -> Result<()> {
        if self.factor > 1 {
            coarsen(cells, self.factor, &mut self.coarse)?;
        }
        Ok(())
    }

    /// The cells that light is found on, as they were prepared.
    pub fn cells<'a>(&'a self, cells: &'a Cells) -> &'a Cells {
        if self.factor == 1 { cells } else { &self.coarse }
    }

    /// The settings for those cells: what is told in px, in their px.
    pub fn settings(&self, settings: &Settings) -> Settings {
        Settings { wall_depth: settings.wall_depth / self.factor as f32, ..settings.clone() }
    }

    /// Watches a frame of so many columns, and changes the factor for the next where it adapts.
    pub fn watch(&mut self, frame: f64, light: Option<f64>, columns: u32) {
        if self.adapts {
            self.factor = self.pace.advise(frame, light, self.factor, coarsest(columns));
        }
    }
}

/// How large the cells of a light are in a picture of so many columns.
pub fn factor(light: &Light, width: u32) -> u32 {
    width.div_ceil(light.width().max(1))
}
