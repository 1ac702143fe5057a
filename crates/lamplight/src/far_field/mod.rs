//! Light from afar: a world in blocks of cells, each known by what it sends and stops in sixteen directions.
//!
//! A tile of a world is lit by all of it, but does not need to know it cell by cell: what lies far away looks the same
//! if it is known as roughly as it is far, as in the far field of fast multipole methods (Greengard and Rokhlin 1987).
//! The smallest blocks are 4×4 cells ([`read`]), and each level has blocks twice as large, up to 512 px measured by
//! lines through the cells ([`sweep`]), beyond that composed of the smaller ones ([`levels`]). Rays from the border of a
//! tile cross smaller blocks near it and larger ones farther away ([`march`]; [`inflow`]), and cells before them if the
//! tile's margin is narrow ([`near`]).
//!
//! A block keeps two means for each of sixteen directions and for each of four strips across it: the radiance that
//! parallel rays in the strip see in it, and the fraction of light that it stops ([`paths`]). They are means over the
//! paths that come in from open space, and the strip in which the block's nearest corner lies is parted there, so that a
//! wall does not show what is behind it. A light of one cell is as bright as it was, seen from anywhere. A block that a
//! wall cuts in two is shut ([`shut`]), wherever the wall lies in it.
//!
//! Surfaces send what they emit and what they send on of the light that they receive. The latter is found tile by tile,
//! a bounce after the other ([`crate::world`]; [`surfaces`]).
//!
//! Cost: a block of matter takes 650 bytes, an empty one five. Time goes with the number of blocks of matter, and for a
//! tile with the length of its border, times the logarithm of the world's size.
//!
//! Known failures: a thing that borders of blocks part looks wider, by up to a fifth if it is about as large as they are.
//! Walls are up to a block thicker where one is shut, and gaps between walls that are narrower than a block are shut
//! with them.

mod block;
mod inflow;
mod lamps;
mod levels;
mod march;
mod near;
mod parts;
mod paths;
mod read;
mod shut;
mod squares;
mod surfaces;
mod sweep;

use crate::stages::bounce::SurfaceLight;
use crate::{Cells, GridWindow, Inflow, Lamp, Result, Sky};
use block::FarBlock;
pub use inflow::IsSolid;
use levels::{BlockLevel, ClearSquares, EMPTY, SOLID};
pub use near::NearCells;
pub use parts::{BounceState, FarBlocks, FarPart};
use rayon::prelude::*;
use read::{BlockReader, Found, SIDE};
use shut::WallWay;
use std::collections::HashMap;
pub use surfaces::PartLight;
use sweep::{Content, Swept};

/// Levels are added until one is no more than this many blocks wide.
const COARSEST: i32 = 24;

/// The light that the parts of a world send each other.
#[derive(Debug)]
pub struct FarField {
    sky: Sky,
    levels: Vec<BlockLevel>,
    /// Ways of walls through the blocks of the second level.
    walls: Vec<WallWay>,
    /// Blocks of each level but the finest, by column and row, until they are merged.
    measured: Vec<HashMap<[i32; 2], FarBlock>>,
}

/// Levels above the finest that are measured, cell by cell.
const MEASURED: usize = 7;
/// The side of the squares in whose multiples cells are added: that of the largest blocks that are measured, px.
pub const ALIGNMENT: u32 = (SIDE as u32) << MEASURED;

/// The columns and rows of the smallest blocks of so many cells: even, so that those of the next level hold two each.
fn blocks_of(size: [u32; 2]) -> [i32; 2] {
    size.map(|side| side.div_ceil(2 * SIDE as u32) as i32 * 2)
}

impl FarField {
    /// Creates that of an empty world of so many cells.
    pub fn new(size: [u32; 2], sky: Sky) -> Self {
        let blocks = blocks_of(size);
        let count = (blocks[0] * blocks[1]) as usize;
        let finest =
            BlockLevel { size: blocks, numbers: vec![EMPTY; count], ..BlockLevel::default() };
        Self {
            sky,
            levels: vec![finest],
            walls: vec![WallWay::None; count / 4],
            measured: vec![HashMap::new(); MEASURED],
        }
    }

    /// Adds the matter of a window, which begins at a multiple of [`ALIGNMENT`], from cells whose first one lies at
    /// `origin` in the world, and whose surfaces send this on. They should hold a margin of one cell around the window,
    /// where the world goes on.
    pub fn add(
        &mut self,
        window: GridWindow,
        cells: &Cells,
        light: &SurfaceLight,
        origin: [u32; 2],
    ) {
        let reader = BlockReader::new(cells, light);
        let GridWindow { first, size } = window;
        let begin = [0, 1].map(|a| (first[a] / SIDE as u32) as i32);
        let end = [0, 1].map(|a| (first[a] + size[a]).div_ceil(SIDE as u32) as i32);
        let local = |block: [i32; 2], side: usize| {
            [0, 1].map(|a| i64::from(block[a]) * side as i64 - i64::from(origin[a]))
        };
        let rows = (begin[1]..end[1]).into_par_iter().map(|y| {
            let row = (begin[0]..end[0]).map(|x| reader.read(local([x, y], SIDE)));
            row.collect::<Vec<_>>()
        });
        let rows: Vec<_> = rows.collect();
        let contents = rows.iter().flatten().map(|found| match found {
            Found::Empty => Content::Empty,
            Found::Solid => Content::Solid,
            Found::Matter { .. } => Content::Mixed,
        });
        let swept = Swept {
            reader: &reader,
            origin: local(begin, SIDE),
            blocks: [0, 1].map(|a| (end[a] - begin[a]) as usize),
            contents: contents.collect(),
        };
        for (number, measured) in swept.measure(self.measured.len()).into_iter().enumerate() {
            let columns = swept.side(0, number + 1) as i32;
            let at = begin.map(|v| v >> (number + 1));
            for (i, block) in (0..).zip(measured) {
                let place = [at[0] + i % columns, at[1] + i / columns];
                self.measured[number].extend(block.map(|block| (place, block)));
            }
        }
        let finest = &mut self.levels[0];
        for (y, row) in (begin[1]..).zip(rows) {
            for (x, found) in (begin[0]..).zip(row) {
                let place = (y * finest.size[0] + x) as usize;
                finest.numbers[place] = match found {
                    Found::Empty => EMPTY,
                    Found::Solid => SOLID,
                    Found::Matter { block, wall } => finest.push(*block, wall),
                };
            }
        }
        let columns = finest.size[0] / 2;
        for y in begin[1] / 2..(end[1] + 1) / 2 {
            for x in begin[0] / 2..(end[0] + 1) / 2 {
                let first = local([x, y], 2 * SIDE);
                self.walls[(y * columns + x) as usize] = reader.wall(first, 2 * SIDE as u32);
            }
        }
    }

    /// Makes the larger blocks, when all matter has been added.
    pub fn merge(&mut self) {
        self.levels.truncate(1);
        while let Some(finest) =
            self.levels.last().filter(|last| last.size.iter().any(|v| *v > COARSEST))
        {
            let columns = self.levels[0].size[0] / 2;
            let of_level = self.measured.get(self.levels.len() - 1);
            let measured = |at| of_level.and_then(|of_level| of_level.get(&at).copied());
            let coarser = match self.levels.len() {
                1 => finest.coarser(|[x, y]| self.walls[(y * columns + x) as usize], measured),
                count => {
                    let finer = &self.levels[count - 2];
                    finest.coarser(|at| finer.wall(at.map(|v| 4 * v)), measured)
                }
            };
            self.levels.push(coarser);
        }
        self.levels.par_iter_mut().for_each(|level| {
            level.clear = ClearSquares::of(level, [[0; 2], level.size]);
        });
        self.measured.iter_mut().for_each(HashMap::clear);
    }

    /// Returns the light that enters a window, which begins at a multiple of 4, in `columns` directions, through the cells
    /// near it if they are known. `is_solid`: which cells of the window are.
    ///
    /// # Errors
    /// As [`Inflow::new`].
    pub fn inflow(
        &self,
        window: GridWindow,
        columns: usize,
        is_solid: IsSolid,
        near: Option<&NearCells>,
    ) -> Result<Inflow> {
        inflow::inflow(&self.levels, &self.sky, window, columns, is_solid, near)
    }

    /// Returns an inflow of a window, which begins at a multiple of 4, with the light of lamps in it. Positions are px of
    /// the world.
    ///
    /// # Errors
    /// As [`Inflow::new`].
    pub fn with_lamps(
        &self,
        window: GridWindow,
        inflow: &Inflow,
        lamps: &[Lamp],
    ) -> Result<Inflow> {
        lamps::with_lamps(&self.levels, window, inflow, lamps)
    }
}
