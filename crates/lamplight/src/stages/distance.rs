//! The distance field: px from each cell's centre to the centre of the nearest occupied cell.
//!
//! 0 in occupied cells, +∞ in a grid without any. It is in px and so correct for every aspect
//! ratio (the field of Bigos, 2020, is in UV and is not). The nearest cell itself is in the output of the
//! jump flood.

use super::jump_flood::SETTLED_ERROR;
use super::seed::{NONE, unpack};
use rayon::prelude::*;

/// px from any point of a cell to any point of a cell `d` px away, centre to centre, is at least
/// `d − MARGIN`: half a diagonal at either end, plus the error of the jump flood.
pub const MARGIN: f32 = std::f32::consts::SQRT_2 + SETTLED_ERROR;

/// Fills `distance` from the nearest seeds, one entry per cell.
pub fn distance(width: u32, nearest: &[u32], distance: &mut Vec<f32>) {
    distance.resize(nearest.len(), 0.0);
    let w = width as usize;
    distance.par_chunks_mut(w).zip(nearest.par_chunks(w)).enumerate().for_each(
        |(y, (out, nearest))| {
            for (x, (out, &seed)) in out.iter_mut().zip(nearest).enumerate() {
                let [sx, sy] = unpack(seed);
                let (dx, dy) = (sx as f32 - x as f32, sy as f32 - y as f32);
                let d = (dx * dx + dy * dy).sqrt();
                *out = if seed == NONE { f32::INFINITY } else { d };
            }
        },
    );
}
