//! Rows of a workgroup that fuses levels: as many as its memory holds.
//!
//! Rays that spread need rows beside the tile, which the next tile makes again: taller tiles repeat less.

use crate::options::LightingOptions;

/// Rows of a workgroup.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tiles {
    /// Rows of one that extends intervals.
    pub extend: u32,
    /// Rows of one that merges cones.
    pub merge: u32,
}

/// Rows of the tallest tile.
const TALLEST: u32 = 64;
/// Bytes of a word of an interval, and of light.
const WORD: u32 = 4;
const LIGHT: u32 = 8;

impl Tiles {
    /// Chooses tiles for a workgroup memory of `bytes`, and intervals of `words`.
    pub fn new(bytes: u32, words: u32) -> Self {
        let tallest = |needed: fn(u32) -> u32, each: u32| {
            let mut tile = TALLEST;
            while tile > 1 && needed(tile) * each > bytes {
                tile /= 2;
            }
            tile
        };
        Self { extend: tallest(intervals, words * WORD), merge: tallest(light, LIGHT) }
    }

    /// The most intervals in workgroup memory: of the first and the second level above the lowest; the third
    /// takes the place of the first (extend.wgsl).
    pub fn intervals(self) -> u32 {
        intervals(self.extend)
    }

    /// The most light of cones in workgroup memory: of the third level, whose place the first then takes, and
    /// of the second (merge.wgsl).
    pub fn light(self) -> u32 {
        light(self.merge)
    }
}

fn intervals(tile: u32) -> u32 {
    let level = |up: u32| {
        let planes = 1 << (LightingOptions::MAX_FUSED_LEVELS - up);
        ((1 << up) + 1) * (planes * tile + ((planes * (planes - 1) / 2) << up))
    };
    level(1) + level(2)
}

fn light(tile: u32) -> u32 {
    let level = |up: u32| (tile + (1 << up) - 1) << LightingOptions::MAX_FUSED_LEVELS;
    level(3) + level(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_fit_into_the_memory_of_workgroups() {
        for (bytes, words, extend, merge) in [
            (16 << 10, 2, 32, 32),
            (16 << 10, 3, 16, 32),
            (32 << 10, 2, 64, 64),
            (32 << 10, 3, 32, 64),
        ] {
            let tiles = Tiles::new(bytes, words);
            assert_eq!(tiles, Tiles { extend, merge }, "{bytes} bytes, {words} words");
            assert!(tiles.intervals() * words * WORD <= bytes && tiles.light() * LIGHT <= bytes);
        }
    }
}
