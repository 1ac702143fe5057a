//! Pieces of a far field that travel: what is read of a part of a world, and the blocks that light a tile.
//!
//! A far field is found and used on many machines. Each reads some parts ([`FarPart`]); one merges these, and hands out
//! the blocks that the rays of a tile cross ([`FarBlocks`]), which are few: [`Rings`] of each level around the tile.

use super::block::FarBlock;
use super::levels::{BlockLevel, CLIPPED, ClearSquares, EMPTY, FIRST, SHUT, SOLID, record};
use super::march::Rings;
use super::read::SIDE;
use super::shut::WallWay;
use super::surfaces::PartLight;
use super::{ALIGNMENT, COARSEST, FarField, MEASURED, blocks_of};
use crate::stages::bounce::SurfaceLight;
use crate::{Cells, Error, GridWindow, Result, Sky};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// The matter of a part of a world, as it was read for the far field.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FarPart {
    first: [u32; 2],
    finest: LevelRecord,
    /// Blocks of the second level that walls run through.
    walls: Vec<([i32; 2], WallWay)>,
    /// As in the far field, by column and row.
    measured: Vec<Vec<([i32; 2], FarBlock)>>,
    /// Radiance that its surfaces send on, and how much that is and has changed.
    light: PartLight,
    change: [f64; 2],
}

/// The blocks of a finished far field, or those of them that light one tile, with what surfaces send on there.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FarBlocks {
    pub(crate) levels: Vec<LevelRecord>,
    pub(crate) surfaces: Vec<PartLight>,
    pub(crate) state: BounceState,
}

/// The bounces that a far field has, what its surfaces send on in all, and the change of it in the last one.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct BounceState {
    pub bounces: u32,
    pub sent: f64,
    pub changed: f64,
}

/// A level without its empty blocks.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct LevelRecord {
    size: [i32; 2],
    /// For each block that is not empty, row by row: the blocks passed since the one before, times 4, plus its kind.
    steps: Vec<u64>,
    /// The records of those that have one.
    blocks: Vec<FarBlock>,
}

/// The blocks of a whole level.
const ALL: [[[i32; 2]; 2]; 2] = [[[0; 2], [i32::MAX; 2]], [[0; 2]; 2]];

/// Kinds of blocks in [`LevelRecord::steps`].
const KIND_CLIPPED: u64 = 0;
const KIND_SOLID: u64 = 1;
const KIND_OPEN: u64 = 2;
const KIND_SHUT: u64 = 3;

impl LevelRecord {
    /// Keeps the blocks of a level within a rectangle, from its first to its last, exclusive, except for those within
    /// another one.
    fn of(level: &BlockLevel, [[first, end], inner]: [[[i32; 2]; 2]; 2]) -> Self {
        let mut kept = Self { size: level.size, ..Self::default() };
        let mut before = 0;
        let range = |a: usize| first[a].clamp(0, level.size[a])..end[a].clamp(0, level.size[a]);
        for [x, y] in range(1).flat_map(|y| range(0).map(move |x| [x, y])) {
            let at = y as usize * level.size[0] as usize + x as usize;
            let is_inner = (0..2).all(|a| (inner[0][a]..inner[1][a]).contains(&[x, y][a]));
            let number = level.numbers[at];
            if number == EMPTY || is_inner {
                continue;
            }
            let kind = match number {
                SOLID => KIND_SOLID,
                number if number & SHUT != 0 => KIND_SHUT,
                number if number & CLIPPED != 0 => KIND_CLIPPED,
                _ => KIND_OPEN,
            };
            kept.steps.push((at as u64 + 1 - before) << 2 | kind);
            before = at as u64 + 1;
            if number != SOLID {
                kept.blocks.push(level.blocks[record(number)]);
            }
        }
        kept
    }

    /// Calls `each` with the place and the number of every block, whose records begin at `first`. Returns `None` if they
    /// do not fit a level of this size.
    fn read(&self, first: u32, mut each: impl FnMut(usize, u32)) -> Option<()> {
        let count = self.size[0] as u64 * self.size[1] as u64;
        let (mut end, mut record) = (0u64, first);
        for step in &self.steps {
            end = end.checked_add(step >> 2).filter(|end| (1..=count).contains(end))?;
            let number = match step & 3 {
                KIND_SOLID => SOLID,
                kind => {
                    record += 1;
                    let flag = match kind {
                        KIND_CLIPPED => CLIPPED,
                        KIND_SHUT => SHUT,
                        _ => 0,
                    };
                    (record - 1) | flag
                }
            };
            each((end - 1) as usize, number);
        }
        ((record - first) as usize == self.blocks.len()).then_some(())
    }

    /// Makes the level again.
    fn level(self) -> Option<BlockLevel> {
        let columns = self.size[0] as usize;
        let mut numbers = vec![EMPTY; columns * self.size[1] as usize];
        let [mut first, mut last] = [self.size, [0; 2]];
        self.read(FIRST, |at, number| {
            numbers[at] = number;
            let at = [at % columns, at / columns].map(|v| v as i32);
            for a in 0..2 {
                first[a] = first[a].min(at[a]);
                last[a] = last[a].max(at[a] + 1);
            }
        })?;
        let Self { size, blocks, .. } = self;
        let mut level = BlockLevel { size, numbers, blocks, ..BlockLevel::default() };
        level.clear = ClearSquares::of(&level, [first, last]);
        Some(level)
    }
}

impl FarPart {
    /// The window of the part.
    pub fn window(&self) -> GridWindow {
        self.light.window()
    }

    /// Reads the matter of a part, which begins at a multiple of `ALIGNMENT`, as `add` does. `light` is what
    /// its surfaces send on, in the whole window also `sent`, and `change` that of it.
    pub fn read(
        part: GridWindow,
        cells: &Cells,
        sent: &SurfaceLight,
        origin: [u32; 2],
        light: PartLight,
        change: [f64; 2],
    ) -> Self {
        // One square past the beginning, for the margin.
        let place = [ALIGNMENT; 2];
        let mut field = FarField::new(part.size.map(|side| ALIGNMENT + side), Sky::BLACK);
        let origin = [0, 1].map(|a| place[a] + origin[a] - part.first[a]);
        field.add(GridWindow { first: place, ..part }, cells, sent, origin);
        let FarField { levels, walls, measured, .. } = field;
        let finest = &levels[0];
        let columns = finest.size[0] / 2;
        let walls = (0..).zip(walls).filter(|(_, wall)| *wall != WallWay::None);
        Self {
            first: part.first,
            finest: LevelRecord::of(finest, ALL),
            walls: walls.map(|(at, wall)| ([at % columns, at / columns], wall)).collect(),
            measured: measured.into_iter().map(sorted).collect(),
            light,
            change,
        }
    }
}

/// Returns blocks in an order that is always the same.
fn sorted(blocks: HashMap<[i32; 2], FarBlock>) -> Vec<([i32; 2], FarBlock)> {
    let mut blocks: Vec<_> = blocks.into_iter().collect();
    blocks.sort_unstable_by_key(|(at, _)| *at);
    blocks
}

impl FarField {
    /// Adds what was read of a part, whose window lies in the world. Returns what its surfaces send on, and the change of it.
    ///
    /// # Errors
    /// Fails, and changes nothing, if it was damaged on its way.
    pub fn insert(&mut self, part: FarPart) -> Result<(PartLight, [f64; 2])> {
        let damaged = || Error::value("part", "damaged", "one that was read of this world");
        let FarPart { first, finest: found, walls, measured, light, change } = part;
        let window = light.window();
        // Blocks of a level by which all that was read is moved to its place.
        let moved =
            |level: usize| first.map(|v| ((v as i32 - ALIGNMENT as i32) / SIDE as i32) >> level);
        let finest = &mut self.levels[0];
        let size = finest.size;
        let place = |[x, y]: [i32; 2], level: usize| {
            let at = [x + moved(level)[0], y + moved(level)[1]];
            let is_inside = (0..2).all(|a| (0..size[a] >> level).contains(&at[a]));
            is_inside.then(|| (at[1] * (size[0] >> level) + at[0]) as usize)
        };
        let place_of_found = |at: usize| {
            let (at, columns) = (at as i32, found.size[0]);
            place([at % columns, at / columns], 0)
        };
        // All of it is checked before any is written.
        let expected = blocks_of(window.size.map(|side| ALIGNMENT + side));
        if first != window.first || found.size != expected || !light.is_sound() {
            return Err(damaged());
        }
        let mut fits = measured.len() == MEASURED;
        let whole = found.read(FIRST, |at, _| fits &= place_of_found(at).is_some());
        let near = |at: &[i32; 2]| at.iter().all(|v| (0..=ALIGNMENT as i32).contains(v));
        fits &= measured.iter().flatten().all(|(at, _)| near(at));
        fits &= walls.iter().all(|&(at, _)| near(&at) && place(at, 1).is_some());
        if whole.is_none() || !fits {
            return Err(damaged());
        }
        let first_record = finest.blocks.len() as u32;
        let written = found.read(first_record + FIRST, |at, number| {
            if let Some(at) = place_of_found(at) {
                finest.numbers[at] = number;
            }
        });
        written.ok_or_else(damaged)?;
        finest.blocks.extend(found.blocks);
        for (at, wall) in walls {
            self.walls[place(at, 1).ok_or_else(damaged)?] = wall;
        }
        for (number, of_level) in measured.into_iter().enumerate() {
            let [dx, dy] = moved(number + 1);
            self.measured[number]
                .extend(of_level.into_iter().map(|([x, y], block)| ([x + dx, y + dy], block)));
        }
        Ok((light, change))
    }

    /// Returns all levels; with a window, which begins at a multiple of 4, the blocks that light it.
    pub fn levels(&self, window: Option<GridWindow>) -> Vec<LevelRecord> {
        let rings = window.map(|window| Rings::around(window, self.levels.len()));
        let levels = self.levels.iter().enumerate();
        let part = |number| rings.as_ref().map_or(ALL, |rings| rings.of_level(number));
        levels.map(|(number, level)| LevelRecord::of(level, part(number))).collect()
    }

    /// Creates the far field of a world of this size from such levels.
    ///
    /// # Errors
    /// Fails if they are those of a world of another size, or were damaged on their way.
    pub fn of_levels(size: [u32; 2], sky: Sky, levels: Vec<LevelRecord>) -> Result<Self> {
        let damaged = || Error::value("blocks", "damaged", "those of a world of this size");
        let mut field = Self::new(size, sky);
        let mut expected = field.levels[0].size;
        field.levels.clear();
        field.walls.clear();
        let count = levels.len();
        for (number, level) in levels.into_iter().enumerate() {
            let is_last = expected.iter().all(|v| *v <= COARSEST);
            if level.size != expected || is_last != (number + 1 == count) {
                return Err(damaged());
            }
            field.levels.push(level.level().ok_or_else(damaged)?);
            expected = expected.map(|v| (v + 1) / 2);
        }
        if count == 0 { Err(damaged()) } else { Ok(field) }
    }
}
