//! Blocks of growing size, each level from the one below.

use super::block::{BlockRayState, FarBlock, PackedRgb};
use super::paths::{PER_DIRECTION, PathStep, Paths, slot};
use super::shut::WallWay;
use super::squares;
use rayon::prelude::*;

/// Blocks of a row of a larger one with its margin.
const WITH_MARGIN: usize = 4;

/// The number of a block without matter; those from [`FIRST`] on have a record.
pub const EMPTY: u32 = 0;
/// The number of a block that no ray enters from open space.
pub const SOLID: u32 = 1;
/// The number of the block of the first record.
pub const FIRST: u32 = 2;
/// Added to the number of a block that a wall cuts in two: no light passes.
pub const SHUT: u32 = 1 << 31;
/// Added to the number of a block that a wall clips: no light passes where anything stops some.
pub const CLIPPED: u32 = 1 << 30;

/// Returns the index of the record of a block by its number.
#[inline]
pub fn record(number: u32) -> usize {
    ((number & !(SHUT | CLIPPED)) - FIRST) as usize
}

/// The blocks of a size.
#[derive(Debug, Default)]
pub struct BlockLevel {
    /// Columns and rows.
    pub size: [i32; 2],
    /// Numbers of all blocks, row by row.
    pub numbers: Vec<u32>,
    pub blocks: Vec<FarBlock>,
    pub clear: ClearSquares,
}

/// Squares of empty blocks, which rays cross at once. Found when all blocks are known.
#[derive(Debug, Default)]
pub struct ClearSquares {
    /// The first and the last blocks, exclusive, between which all matter is, at multiples of the largest squares.
    within: [[i32; 2]; 2],
    /// For each of these blocks, row by row, its [`squares::widths`].
    doubled: Vec<u8>,
}

impl ClearSquares {
    /// The most that a width doubles: rays cross few more blocks of a level.
    const MOST: usize = 6;

    /// Finds those of a level whose matter lies between two blocks, the last exclusive.
    pub fn of(level: &BlockLevel, [first, last]: [[i32; 2]; 2]) -> Self {
        let largest = 1 << Self::MOST;
        let first = first.map(|v| v.div_euclid(largest) * largest);
        let last = last.map(|v| (v + largest - 1).div_euclid(largest) * largest);
        let [columns, rows] = [0, 1].map(|a| (last[a] - first[a]).max(0) as usize);
        let place =
            |at: usize| [first[0] + (at % columns) as i32, first[1] + (at / columns) as i32];
        let is_clear = (0..columns * rows).map(|at| level.number(place(at)) == EMPTY).collect();
        let blocks = [columns, rows];
        let doubled = match columns * rows {
            0 => Vec::new(),
            _ => squares::widths(blocks, &squares::uniform(blocks, is_clear, false, Self::MOST)),
        };
        Self { within: [first, last], doubled }
    }

    /// Those of a level of which none is known.
    #[cfg(test)]
    pub fn none(size: [i32; 2]) -> Self {
        Self { within: [[0; 2], size], doubled: vec![0; (size[0] * size[1]) as usize] }
    }

    /// Returns the width, in blocks, of the largest known square of empty blocks around an empty one. It lies at a multiple
    /// of its width.
    #[inline]
    pub fn width(&self, at: [i32; 2]) -> i32 {
        let [first, last] = self.within;
        let is_known = (0..2).all(|a| first[a] <= at[a] && at[a] < last[a]);
        if !is_known {
            return 1 << Self::MOST;
        }
        let [x, y] = [0, 1].map(|a| (at[a] - first[a]) as usize);
        1 << self.doubled[y * (last[0] - first[0]) as usize + x]
    }
}

impl BlockLevel {
    /// The number of a block; those beyond the world are empty.
    #[inline]
    pub fn number(&self, [x, y]: [i32; 2]) -> u32 {
        if x < 0 || y < 0 || x >= self.size[0] || y >= self.size[1] {
            return EMPTY;
        }
        self.numbers[(y * self.size[0] + x) as usize]
    }

    /// Adds a record, and returns its number.
    pub fn push(&mut self, block: FarBlock, wall: WallWay) -> u32 {
        self.blocks.push(block);
        let flag = match wall {
            WallWay::None => 0,
            WallWay::Clips => CLIPPED,
            WallWay::Cuts => SHUT,
        };
        (self.blocks.len() as u32 - 1 + FIRST) | flag
    }

    /// Returns whether a wall lies across a block.
    fn is_wall(&self, at: [i32; 2]) -> bool {
        match self.number(at) {
            EMPTY => false,
            SOLID => true,
            number => number & SHUT != 0 || self.blocks[record(number)].is_shut(),
        }
    }

    /// Returns the level of blocks twice as large. `wall`: the way of a wall through one. `measured`: what was measured of
    /// a block, if anything was.
    pub fn coarser(
        &self,
        wall: impl Fn([i32; 2]) -> WallWay + Sync,
        measured: impl Fn([i32; 2]) -> Option<FarBlock> + Sync,
    ) -> Self {
        let size = self.size.map(|side| (side + 1) / 2);
        let paths = Paths::through_blocks(2);
        let rows = (0..size[1]).into_par_iter().map(|y| {
            let merge = |x| {
                let found = measured([x, y]).map_or_else(|| self.merged(&paths, [x, y]), Ok);
                found.map(|block| (block, wall([x, y])))
            };
            (0..size[0]).map(merge).collect::<Vec<_>>()
        });
        let mut level = Self { size, ..Self::default() };
        for merged in rows.collect::<Vec<_>>().into_iter().flatten() {
            let number = match merged {
                Err(number) => number,
                Ok((block, wall)) => level.push(block, wall),
            };
            level.numbers.push(number);
        }
        level
    }

    /// Merges the four blocks that make a larger one; or returns its number, if it has no record.
    fn merged(&self, paths: &Paths, at: [i32; 2]) -> Result<FarBlock, u32> {
        let numbers: [u32; WITH_MARGIN * WITH_MARGIN] = std::array::from_fn(|i| {
            let [x, y] = [i % WITH_MARGIN, i / WITH_MARGIN].map(|v| v as i32 - 1);
            self.number([2 * at[0] + x, 2 * at[1] + y])
        });
        let own = [5, 6, 9, 10].map(|i| numbers[i]);
        if own == [EMPTY; 4] {
            return Err(EMPTY);
        }
        let mut block = FarBlock::HIDDEN;
        let mut reachable = false;
        for (number, of_slot) in paths.of_slots.iter().enumerate() {
            let of_step = |step: &PathStep| slot(number / PER_DIRECTION, step.number);
            let (mut sent, mut stopped, mut count) = ([0.0; 3], [0.0; 3], 0.0);
            for path in of_slot {
                // Those that come out of a wall are none.
                let is_hidden = |step: &PathStep| match numbers[step.cell] {
                    EMPTY => false,
                    SOLID => true,
                    number => self.blocks[record(number)].in_slot(of_step(step)).is_none(),
                };
                if path.steps.first().is_none_or(is_hidden) {
                    continue;
                }
                count += path.weight;
                let mut state = BlockRayState::START;
                for step in &path.steps {
                    let slot = of_step(step);
                    state.cross(match numbers[step.cell] {
                        EMPTY => continue,
                        SOLID => None,
                        number => self.blocks[record(number)].in_slot(slot),
                    });
                }
                (0..3).for_each(|c| sent[c] += path.weight * state.light[c]);
                (0..3).for_each(|c| stopped[c] += path.weight * (1.0 - state.through[c]));
            }
            if count > 0.0 {
                reachable = true;
                block.sent[number] = PackedRgb::new(sent.map(|v| v / count));
                block.stopped[number] = PackedRgb::new(stopped.map(|v| v / count));
            }
        }
        if own == [SOLID; 4] && !reachable {
            return Err(SOLID);
        }
        Ok(block)
    }

    /// Returns the way of walls through the square of 4×4 blocks with this first one.
    pub fn wall(&self, [left, top]: [i32; 2]) -> WallWay {
        let is_wall = |i: &i32| self.is_wall([left + i % 6 - 1, top + i / 6 - 1]);
        WallWay::of((0..36).filter(is_wall).fold(0, |all, i| all | 1 << i), 6)
    }
}
