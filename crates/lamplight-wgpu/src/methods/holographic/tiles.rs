//! How many rows go to a workgroup that fuses levels: as many as its memory holds.
//!
//! Rays that spread need rows beside the tile, which the next tile makes again: taller tiles repeat less.

use crate::options::Options;

/// Rows of a workgroup.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tiles {
    /// That extends intervals.
    pub extend: u32,
    /// That merges cones.
    pub cones: u32,
}

/// The tallest, where there is enough memory.
const TALLEST: u32 = 64;
/// Bytes of a word of an interval, and of light.
const WORD: u32 = 4;
const LIGHT: u32 = 8;

impl Tiles {
    /// For workgroups of so many bytes, and intervals of so many words.
    pub fn new(bytes: u32, words: u32) -> Self {
        let tallest = |needed: fn(u32) -> u32, each: u32| {
            let mut tile = TALLEST;
            while tile > 1 && needed(tile) * each > bytes {
                tile /= 2;
            }
            tile
        };
        Self { extend: tallest(intervals, words * WORD), cones: tallest(light, LIGHT) }
    }

    /// Intervals that are held, at most: of the first and the second level above the lowest; the third
    /// takes the place of the first (shaders/extend.wgsl).
    pub fn intervals(self) -> u32 {
        intervals(self.extend)
    }

    /// Light of cones that is held, at most: of the third level, in whose place the first goes, and of
    /// the second (shaders/cones.wgsl).
    pub fn light(self) -> u32 {
        light(self.cones)
    }
}

fn intervals(tile: u32) -> u32 {
    let level = |up: u32| {
        let planes = 1 << (Options::MOST_FUSED - up);
        ((1 << up) + 1) * (planes * tile + ((planes * (planes - 1) / 2) << up))
    };
    level(1) + level(2)
}

fn light(tile: u32) -> u32 {
    let level = |up: u32| (tile + (1 << up) - 1) << Options::MOST_FUSED;
    level(3) + level(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_fit_into_what_devices_have() {
        for (bytes, words, extend, cones) in [
            (16 << 10, 2, 32, 32),
            (16 << 10, 3, 16, 32),
            (32 << 10, 2, 64, 64),
            (32 << 10, 3, 32, 64),
        ] {
            let tiles = Tiles::new(bytes, words);
            assert_eq!(tiles, Tiles { extend, cones }, "{bytes} bytes, {words} words");
            assert!(tiles.intervals() * words * WORD <= bytes && tiles.light() * LIGHT <= bytes);
        }
    }
}
