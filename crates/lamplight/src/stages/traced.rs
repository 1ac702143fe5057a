//! What a method that traces rays at random leaves behind, one entry a cell.

use crate::Rgb;

/// Light, how noisy it is, and whether it is news.
#[derive(Debug, Default)]
pub struct Traced {
    /// Fluence in open cells, the mean over the faces of walls, 0 inside them.
    pub light: Vec<Rgb>,
    /// Variance of the noise of the light's luminance; 0 in walls.
    pub variance: Vec<f32>,
    /// Whether what the cell sees changed since the frame before.
    pub stale: Vec<bool>,
}

impl Traced {
    /// Makes room for a number of cells.
    pub fn resize(&mut self, cells: usize) {
        self.light.resize(cells, Rgb::default());
        self.variance.resize(cells, 0.0);
        self.stale.resize(cells, false);
    }
}
