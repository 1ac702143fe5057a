//! The noisy light that a method finds with random rays, one entry per cell.

use crate::{Moment, Rgb};

/// Light, how noisy it is, and whether its history is still valid.
#[derive(Debug, Default)]
pub struct Estimate {
    /// Mean radiance in open cells, the mean over the faces of walls, 0 inside them.
    pub light: Vec<Rgb>,
    /// First moment of the light; none if it was not asked for.
    pub moment: Option<Vec<Moment>>,
    /// Variance of the noise of the light's luminance; 0 inside walls.
    pub variance: Vec<f32>,
    /// True if anything that the cell sees changed since the frame before.
    pub invalidated: Vec<bool>,
}

impl Estimate {
    /// Makes room for a number of cells.
    pub fn resize(&mut self, cells: usize) {
        self.light.resize(cells, Rgb::default());
        if let Some(moment) = &mut self.moment {
            moment.resize(cells, Moment::default());
        }
        self.variance.resize(cells, 0.0);
        self.invalidated.resize(cells, false);
    }
}
