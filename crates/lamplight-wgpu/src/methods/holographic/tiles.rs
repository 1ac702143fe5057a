//! Rows of a workgroup that fuses levels of intervals: as many as its memory holds.
//!
//! Rays that spread need rows beside the tile, which the next tile makes again: taller tiles repeat less.

use crate::options::LightingOptions;

/// Rows of the tallest tile.
const TALLEST: u32 = 64;
/// Rows to each side of a tile, for paths that bend away from it: one for each level that is held.
pub const BESIDE: u32 = LightingOptions::MAX_FUSED_LEVELS - 1;
/// Bytes of a word of an interval.
const WORD: u32 = 4;

/// Chooses the rows of a tile for a workgroup memory of `bytes`, and intervals of `words`.
pub fn tile(bytes: u32, words: u32) -> u32 {
    let mut tile = TALLEST;
    while tile > 1 && intervals(tile) * words * WORD > bytes {
        tile /= 2;
    }
    tile
}

/// The most intervals in workgroup memory: of the first and the second level above the lowest (extend.wgsl).
pub fn intervals(tile: u32) -> u32 {
    let level = |up: u32| {
        let planes = 1 << (LightingOptions::MAX_FUSED_LEVELS - up);
        ((1 << up) + 3) * (planes * (tile + 2 * BESIDE) + ((planes * (planes - 1) / 2) << up))
    };
    level(1) + level(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_fit_into_the_memory_of_workgroups() {
        for (bytes, words, rows) in
            [(16 << 10, 2, 32), (16 << 10, 3, 32), (32 << 10, 2, 64), (32 << 10, 3, 64)]
        {
            assert_eq!(tile(bytes, words), rows, "{bytes} bytes, {words} words");
            assert!(intervals(rows) * words * WORD <= bytes);
        }
    }
}
