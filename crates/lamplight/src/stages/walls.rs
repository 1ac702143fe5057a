//! What is seen of solid cells: light sinks from the faces inwards, emission shows on top.

use crate::{Cells, Rgb};

/// Buffers for [`Walls::sink`], kept between frames.
#[derive(Debug, Default)]
pub struct Walls {}

impl Walls {
    /// Completes `light` in solid cells. On entry solid cells that touch an open one hold the mean
    /// light of their faces and other solid cells hold anything; on return light fades inwards over
    /// `wall_depth` px and emission is added.
    pub fn sink(&mut self, cells: &Cells, wall_depth: f32, light: &mut [Rgb]) {
        let _ = (cells, wall_depth, light);
    }
}
