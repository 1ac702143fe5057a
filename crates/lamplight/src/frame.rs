//! One frame, from cells to light, top to bottom.

use crate::{Cells, Light, Result, Settings};

/// Runs a method; keeps its buffers between frames.
#[derive(Debug)]
pub struct Solver {
    settings: Settings,
    light: Light,
}

impl Solver {
    /// A solver with checked settings.
    pub fn new(settings: Settings) -> Result<Self> {
        settings.check()?;
        Ok(Self { settings, light: Light::default() })
    }

    /// The settings it was made with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Solves one frame.
    pub fn solve(&mut self, cells: &Cells) -> Result<&Light> {
        cells.check()?;
        let rgb = vec![[0.0; 3]; cells.len()];
        if let Some(light) = Light::from_pixels(cells, rgb) {
            self.light = light;
        }
        Ok(&self.light)
    }

    /// Forgets the frames before: the next one starts afresh.
    pub fn reset(&mut self) {}
}
/// Stub.
#[derive(Debug)]
pub struct Stages<'a> {
    /// Seeds.
    pub seed: &'a [u32],
    /// Nearest.
    pub nearest: &'a [u32],
    /// Distance.
    pub distance: &'a [f32],
}
impl Solver {
    /// Stub.
    pub fn timings(&self) -> &[(&'static str, std::time::Duration)] {
        &[]
    }
    /// Stub.
    pub fn stages(&self) -> Stages<'_> {
        Stages { seed: &[], nearest: &[], distance: &[] }
    }
}
