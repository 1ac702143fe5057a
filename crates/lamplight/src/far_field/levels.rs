//! Blocks of growing size, each level from the one below.

use super::block::{BlockRayState, FarBlock, PackedRgb, Sent};
use super::paths::{DIRECTIONS, Paths, slot};
use super::shut::is_cut;
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

/// Returns the index of the record of a block by its number.
#[inline]
pub fn record(number: u32) -> usize {
    ((number & !SHUT) - FIRST) as usize
}

/// The blocks of a size.
#[derive(Debug, Default)]
pub struct BlockLevel {
    /// Columns and rows.
    pub size: [i32; 2],
    /// Numbers of all blocks, row by row.
    pub numbers: Vec<u32>,
    pub blocks: Vec<FarBlock>,
    /// Light that they send without bounces; empty while there are none.
    pub emitted: Vec<Sent>,
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
    pub fn push(&mut self, block: FarBlock, is_cut: bool) -> u32 {
        self.blocks.push(block);
        (self.blocks.len() as u32 - 1 + FIRST) | if is_cut { SHUT } else { 0 }
    }

    /// Returns whether a wall lies across a block.
    fn is_wall(&self, at: [i32; 2]) -> bool {
        match self.number(at) {
            EMPTY => false,
            SOLID => true,
            number => number & SHUT != 0 || self.blocks[record(number)].is_shut(),
        }
    }

    /// Returns the level of blocks twice as large. `is_cut`: whether a wall cuts one in two. `measured`: what was
    /// measured of a block, if anything was.
    pub fn coarser(
        &self,
        is_cut: impl Fn([i32; 2]) -> bool + Sync,
        measured: impl Fn([i32; 2]) -> Option<FarBlock> + Sync,
    ) -> Self {
        let size = self.size.map(|side| (side + 1) / 2);
        let paths = Paths::new(2);
        let rows = (0..size[1]).into_par_iter().map(|y| {
            let merge = |x| {
                let merged = self.merged(&paths, [x, y], |record| &self.blocks[record].sent);
                merged.map(|block| (measured([x, y]).unwrap_or(block), is_cut([x, y])))
            };
            (0..size[0]).map(merge).collect::<Vec<_>>()
        });
        let mut level = Self { size, ..Self::default() };
        for merged in rows.collect::<Vec<_>>().into_iter().flatten() {
            let number = match merged {
                Err(number) => number,
                Ok((block, is_cut)) => level.push(block, is_cut),
            };
            level.numbers.push(number);
        }
        level
    }

    /// Returns what the blocks of a coarser level reflect if these reflect `reflected`. A block composed of smaller ones
    /// stops too much, and reflects too much by the same factor.
    pub fn reflected_by(&self, coarser: &Self, reflected: &[Sent]) -> Vec<Sent> {
        let paths = Paths::new(2);
        let columns = coarser.size[0];
        let with_record = (0..).zip(&coarser.numbers).filter(|(_, number)| **number >= FIRST);
        let places: Vec<i32> = with_record.map(|(at, _)| at).collect();
        let records = coarser.blocks.par_iter().zip(places).map(|(block, at)| {
            let merged =
                self.merged(&paths, [at % columns, at / columns], |record| &reflected[record]);
            let Ok(FarBlock { mut sent, stopped }) = merged else { return FarBlock::CLEAR.sent };
            for (slot, sent) in sent.iter_mut().enumerate() {
                if *sent == PackedRgb::HIDDEN {
                    continue;
                }
                let [own, of_parts] = [&block.stopped, &stopped].map(|of| of[slot].unpack());
                let share =
                    |c: usize| if own[c] < of_parts[c] { own[c] / of_parts[c] } else { 1.0 };
                let light = sent.unpack();
                *sent = PackedRgb::new(std::array::from_fn(|c| light[c] * share(c)));
            }
            sent
        });
        records.collect()
    }

    /// Returns the change of all that the blocks send if they reflect this, relative to that.
    pub fn change(&self, reflected: &[Sent]) -> f32 {
        let sum = |sent: &Sent| -> f64 {
            let open = sent.iter().filter(|sent| **sent != PackedRgb::HIDDEN);
            open.flat_map(|sent| sent.unpack()).map(f64::from).sum()
        };
        let (mut change, mut total) = (0.0, 0.0);
        for ((block, emitted), reflected) in self.blocks.iter().zip(&self.emitted).zip(reflected) {
            let now = sum(reflected);
            change += now - (sum(&block.sent) - sum(emitted));
            total += sum(emitted) + now;
        }
        if total == 0.0 { 0.0 } else { (change.abs() / total) as f32 }
    }

    /// Sets what the blocks send: what they emit, and what they reflect.
    pub fn send(&mut self, reflected: &[Sent]) {
        let records = self.blocks.par_iter_mut().zip(&self.emitted).zip(reflected);
        records.for_each(|((block, emitted), reflected)| {
            for (sent, (emitted, reflected)) in
                block.sent.iter_mut().zip(emitted.iter().zip(reflected))
            {
                if [*emitted, *reflected].contains(&PackedRgb::HIDDEN) {
                    continue;
                }
                let [emitted, reflected] = [emitted, reflected].map(|of| of.unpack());
                *sent = PackedRgb::new([0, 1, 2].map(|c| emitted[c] + reflected[c]));
            }
        });
    }

    /// Merges the four blocks that make a larger one, which send this; or returns its number, if it has no record.
    fn merged<'a>(
        &self,
        paths: &Paths,
        at: [i32; 2],
        sent_by: impl Fn(usize) -> &'a Sent,
    ) -> Result<FarBlock, u32> {
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
        for way in 0..DIRECTIONS {
            for axis in 0..2 {
                let (mut sent, mut stopped, mut count) = ([0.0; 3], [0.0; 3], 0.0);
                for path in &paths.of_slots[slot(way, axis)] {
                    // Those that come out of a wall are none.
                    let is_hidden = |number: u32| match number {
                        EMPTY => false,
                        SOLID => true,
                        number => self.blocks[record(number)].in_slot(slot(way, axis)).is_none(),
                    };
                    if path.steps.first().is_none_or(|step| is_hidden(numbers[step.cell])) {
                        continue;
                    }
                    count += path.weight;
                    let mut state = BlockRayState::START;
                    for step in &path.steps {
                        let slot = slot(way, step.axis);
                        state.cross(match numbers[step.cell] {
                            EMPTY => continue,
                            SOLID => None,
                            number => {
                                self.blocks[record(number)].in_slot(slot).map(|[_, stopped]| {
                                    [sent_by(record(number))[slot].unpack(), stopped]
                                })
                            }
                        });
                    }
                    (0..3).for_each(|c| sent[c] += path.weight * state.light[c]);
                    (0..3).for_each(|c| stopped[c] += path.weight * (1.0 - state.through[c]));
                }
                if count > 0.0 {
                    reachable = true;
                    let slot = slot(way, axis);
                    block.sent[slot] = PackedRgb::new(sent.map(|v| v / count));
                    block.stopped[slot] = PackedRgb::new(stopped.map(|v| v / count));
                }
            }
        }
        if own == [SOLID; 4] && !reachable {
            return Err(SOLID);
        }
        Ok(block)
    }

    /// Returns whether walls cut the square of 4×4 blocks with this first one in two.
    pub fn is_cut(&self, [left, top]: [i32; 2]) -> bool {
        let is_wall = |i: &i32| self.is_wall([left + i % 4, top + i / 4]);
        is_cut((0..16).filter(is_wall).fold(0, |all, i| all | 1 << i), 4)
    }
}
