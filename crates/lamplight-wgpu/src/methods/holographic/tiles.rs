//! Workgroups that fuse levels of intervals: their lanes, and what they hold in workgroup memory (extend.wgsl).
//!
//! A lane is a row. Rays that spread and bend need rows beside the tile, which the next tile makes again: more
//! lanes repeat less.

use crate::options::LightingOptions;

/// The most lanes of a row of invocations: as many as waves of most GPUs have.
const MOST_LANES: u32 = 64;
/// Rows of invocations. They share the rays of a group, or each has a pair of its own if a dispatch makes one level.
pub const WAVES: usize = 4;
/// Rows before a tile, for paths that bend away from it: one for each level that is held.
pub const BEFORE: u32 = LightingOptions::MAX_FUSED_LEVELS - 1;
/// Rows after it: as far as the rays from the first plane to the last spread, and one for a path that bends.
const AFTER: u32 = (1 << LightingOptions::MAX_FUSED_LEVELS) - 1;
/// Planes of the first and the second level above the lowest that are held, of the most fused levels.
pub const PLANES: [u32; 2] = [4, 2];
/// Rays of each of their planes: those of the group, and the ones beside it that bent paths need.
pub const RAYS: [u32; 2] = [5, 6];
/// Bytes of two words of an interval, which are held together.
const PAIR: u32 = 8;

/// A workgroup's share of the grid.
#[derive(Clone, Copy, Debug)]
pub struct Tiles {
    pub lanes: u32,
}

impl Tiles {
    /// Chooses the lanes for a workgroup memory of `bytes`, and intervals of `words`.
    pub fn new(bytes: u32, words: u32) -> Self {
        let mut tiles = Self { lanes: MOST_LANES };
        while tiles.rows() > 1 && tiles.held_pairs(words) * PAIR > bytes {
            tiles.lanes /= 2;
        }
        tiles
    }

    /// Rows of a tile.
    pub fn rows(self) -> u32 {
        self.lanes.saturating_sub(BEFORE + AFTER).max(1)
    }

    /// Intervals in workgroup memory.
    pub fn held(self) -> u32 {
        self.lanes * (PLANES[0] * RAYS[0] + PLANES[1] * RAYS[1])
    }

    /// Pairs of words in workgroup memory, of intervals of `words`: one array, because browsers count each array as up
    /// to 16 bytes more.
    pub fn held_pairs(self, words: u32) -> u32 {
        self.held() * words.div_ceil(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_fit_into_the_memory_of_workgroups() {
        for (bytes, words, rows) in
            [(16 << 10, 2, 55), (16 << 10, 3, 23), (32 << 10, 2, 55), (32 << 10, 3, 55)]
        {
            let tiles = Tiles::new(bytes, words);
            assert_eq!(tiles.rows(), rows, "{bytes} bytes, {words} words");
            assert!(tiles.held_pairs(words) * PAIR <= bytes);
        }
    }
}
