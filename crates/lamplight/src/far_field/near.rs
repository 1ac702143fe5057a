//! The cells around a window, which rays from its border cross one by one before they come to blocks.
//!
//! Blocks close to a tile look coarse: with a narrow margin light jumps at the seams of tiles, less so if the next px are
//! crossed cell by cell. With a wide margin that gains nothing more.

use super::paths::face;
use super::read::{BlockReader, SIDE};
use crate::grid::class::CellClass;
use crate::math::transmittance::OPAQUE_TRANSMITTANCE;
use crate::stages::bounce::SurfaceLight;
use crate::{Cells, GridWindow, Rgb};

/// The cells of a window of the world, which begins and ends at multiples of 4 or with the world.
#[derive(Debug)]
pub struct NearCells<'a> {
    reader: BlockReader<'a>,
    window: GridWindow,
}

/// A ray that has left the cells.
#[derive(Clone, Copy, Debug)]
pub struct NearRay {
    pub light: Rgb,
    pub through: Rgb,
    /// The smallest block that it comes to, by column and row.
    pub block: [i32; 2],
}

impl<'a> NearCells<'a> {
    /// Creates those of a window, whose surfaces send this on.
    pub fn new(cells: &'a Cells, window: GridWindow, light: &SurfaceLight) -> Self {
        Self { reader: BlockReader::new(cells, light), window }
    }

    /// Lets a ray cross the cells from a place, px of the world, at which it enters a cell along an axis.
    pub fn cross(&self, from: [f64; 2], way: [f64; 2], axis: usize) -> NearRay {
        let first = self.window.first.map(i64::from);
        let size = self.window.size.map(i64::from);
        let ahead = way.map(|v| if v > 0.0 { 1i64 } else { -1 });
        let inverse = way.map(|v| 1.0 / if v.abs() < 1e-12 { 1e-12 } else { v.abs() });
        // Relative to the window.
        let mut cell = [0, 1].map(|a| from[a].floor() as i64 - first[a]);
        if ahead[axis] < 0 {
            cell[axis] = from[axis].ceil() as i64 - 1 - first[axis];
        }
        let mut next = [0, 1].map(|a| {
            let edge = (cell[a] + first[a] + i64::from(ahead[a] > 0)) as f64;
            (edge - from[a]) * ahead[a] as f64 * inverse[a]
        });
        let (mut light, mut through) = ([0.0; 3], [1.0; 3]);
        let (mut at, mut entered) = (0.0, axis);
        while (0..2).all(|a| (0..size[a]).contains(&cell[a])) {
            let leaves = usize::from(next[1] < next[0]);
            let class = self.reader.class(cell);
            if class != CellClass::Empty {
                let length = (next[leaves] - at).max(0.0) as f32;
                let [radiance, stopped, passed] =
                    self.reader.crossed(cell, class, face(way, entered), length);
                for c in 0..3 {
                    light[c] += through[c] * stopped[c] * radiance[c];
                    through[c] *= passed[c];
                }
                if through.iter().all(|v| *v < OPAQUE_TRANSMITTANCE) {
                    through = [0.0; 3];
                    break;
                }
            }
            at = next[leaves];
            entered = leaves;
            cell[leaves] += ahead[leaves];
            next[leaves] += inverse[leaves];
        }
        let block = [0, 1].map(|a| {
            let (at, side) = (cell[a] + first[a], SIDE as i64);
            // Where the window ends with the world, its last block may reach beyond it, and has been crossed.
            let is_behind = ahead[a] > 0 && cell[a] >= size[a];
            let at = if is_behind { at + side - 1 } else { at };
            at.div_euclid(side) as i32
        });
        NearRay { light, through, block }
    }
}
