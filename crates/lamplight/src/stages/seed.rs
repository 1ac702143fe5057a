//! The seed map: occupied cells hold their own position, others an explicit "none".
//!
//! A position is packed as `x | y << 16`, so that the map is one `u32` a cell on the CPU and on the
//! GPU. (Seed 1, Bigos 2020, stores UV and takes 0 for "none", which loses the cells at coordinate
//! 0.)

use crate::Cells;

/// No seed: what an empty cell holds, and every cell of an empty grid.
pub const NONE: u32 = u32::MAX;

/// Packs a cell's position.
#[inline]
pub fn pack(x: u32, y: u32) -> u32 {
    x | y << 16
}

/// The position of a packed cell: `[x, y]`.
#[inline]
pub fn unpack(seed: u32) -> [u32; 2] {
    [seed & 0xffff, seed >> 16]
}

/// Whether light notices the matter at an index: opacity above `threshold`, or a tint.
#[inline]
pub fn is_occupied(cells: &Cells, index: usize, threshold: f32) -> bool {
    cells.opacity()[index] > threshold || cells.tint()[index] != [1.0; 3]
}

/// Fills `seeds`, one entry a cell.
pub fn seed(cells: &Cells, threshold: f32, seeds: &mut Vec<u32>) {
    seeds.clear();
    for y in 0..cells.height() {
        let row = y as usize * cells.width() as usize;
        seeds.extend((0..cells.width()).map(|x| {
            if is_occupied(cells, row + x as usize, threshold) { pack(x, y) } else { NONE }
        }));
    }
}
