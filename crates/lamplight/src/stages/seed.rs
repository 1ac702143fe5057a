//! The seed map: occupied cells hold their own position, others an explicit "none".
//!
//! A position is packed as `x | y << 16`, so that the map is one `u32` per cell on the CPU and on the
//! GPU. (Bigos 2020 stores UV and takes 0 for "none", which loses the cells at coordinate
//! 0.)

use crate::Cells;
use crate::grid::class::is_occupied;

/// No seed: the value of empty cells.
pub const NONE: u32 = u32::MAX;

/// Packs a cell's position.
#[inline]
pub fn pack(x: u32, y: u32) -> u32 {
    x | y << 16
}

/// Returns the position of a packed cell: `[x, y]`.
#[inline]
pub fn unpack(seed: u32) -> [u32; 2] {
    [seed & 0xffff, seed >> 16]
}

/// Fills `seeds`, one entry per cell.
pub fn seed(cells: &Cells, threshold: f32, seeds: &mut Vec<u32>) {
    seeds.clear();
    for y in 0..cells.height() {
        let row = y as usize * cells.width() as usize;
        seeds.extend((0..cells.width()).map(|x| {
            if is_occupied(cells, row + x as usize, threshold) { pack(x, y) } else { NONE }
        }));
    }
}
