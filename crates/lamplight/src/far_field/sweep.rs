//! Larger blocks measured by lines through all cells of a window.
//!
//! A block composed of smaller ones stops too much: where a surface runs through several of them, rays that pass
//! beside it in one count as spread over all of the next. So lines of each direction go through the cells, and every
//! block on their way, of every size at once, counts what they see and what is stopped between its entry and its exit.

use super::block::{FarBlock, PackedRgb};
use super::paths::{DIRECTIONS, direction, slot};
use super::read::{BlockReader, SIDE};
use crate::Rgb;
use crate::grid::class::CellClass;
use rayon::prelude::*;

/// Lines per px along the side that most of them enter by.
const PER_PX: f64 = 2.0;
/// Sizes of blocks that a window is measured in.
const MOST: usize = 16;

/// A block of the finest level, as lines meet it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    Empty,
    Solid,
    Mixed,
}

/// The window that lines go through.
pub struct Swept<'a> {
    pub reader: &'a BlockReader<'a>,
    /// The place of its first cell among those of the reader.
    pub origin: [i64; 2],
    /// Columns and rows of finest blocks, and what is in each, row by row.
    pub blocks: [usize; 2],
    pub contents: Vec<Content>,
}

/// Sums over the lines that enter a block by a side.
#[derive(Clone, Copy, Debug, Default)]
struct SideSum {
    lines: f32,
    sent: Rgb,
    stopped: Rgb,
}

/// A line since it entered a block of some size.
#[derive(Clone, Copy, Debug, Default)]
struct LineState {
    /// The index of the block among the sums, and the axis along which it was entered.
    block: usize,
    axis: usize,
    /// False if it came out of a solid cell.
    reachable: bool,
    sent: Rgb,
    through: Rgb,
}

impl Swept<'_> {
    /// Measures the blocks of each of so many larger sizes, row by row; those without matter, and those that no line
    /// enters, are `None`.
    pub fn measure(&self, sizes: usize) -> Vec<Vec<Option<FarBlock>>> {
        let sizes = sizes.min(MOST);
        let count = |size: usize| self.side(0, size) * self.side(1, size);
        let counts: Vec<usize> = (1..=sizes).map(count).collect();
        let sums: Vec<Vec<Vec<[SideSum; 2]>>> = (0..DIRECTIONS)
            .into_par_iter()
            .map(|number| {
                let mut sums: Vec<_> =
                    counts.iter().map(|&n| vec![[SideSum::default(); 2]; n]).collect();
                self.draw_lines(number, &mut sums);
                sums
            })
            .collect();
        let block = |size: usize, at: usize| {
            let mut block = FarBlock::HIDDEN;
            let mut reachable = false;
            for (number, sums) in sums.iter().enumerate() {
                for (axis, sum) in
                    sums[size][at].iter().enumerate().filter(|(_, sum)| sum.lines > 0.0)
                {
                    reachable = true;
                    let mean = |rgb: Rgb| PackedRgb::new(rgb.map(|v| v / sum.lines));
                    block.sent[slot(number, axis)] = mean(sum.sent);
                    block.stopped[slot(number, axis)] = mean(sum.stopped);
                }
            }
            reachable.then_some(block)
        };
        let of_size = |size: usize| {
            let occupied = self.occupied(size + 1, counts[size]);
            (0..counts[size]).map(|at| if occupied[at] { block(size, at) } else { None }).collect()
        };
        (0..sizes).into_par_iter().map(of_size).collect()
    }

    /// The number of blocks of a size along an axis.
    pub fn side(&self, axis: usize, size: usize) -> usize {
        ((self.blocks[axis] - 1) >> size) + 1
    }

    /// Returns whether there is matter in each block of a size.
    fn occupied(&self, size: usize, count: usize) -> Vec<bool> {
        let columns = self.side(0, size);
        let mut occupied = vec![false; count];
        for (i, _) in
            self.contents.iter().enumerate().filter(|(_, content)| **content != Content::Empty)
        {
            let [x, y] = [i % self.blocks[0], i / self.blocks[0]].map(|v| v >> size);
            occupied[y * columns + x] = true;
        }
        occupied
    }

    /// Returns the place of a cell of the window among those of the reader.
    fn place(&self, cell: [i64; 2]) -> [i64; 2] {
        [0, 1].map(|a| cell[a] + self.origin[a])
    }

    /// Draws all lines of a direction.
    fn draw_lines(&self, number: usize, sums: &mut [Vec<[SideSum; 2]>]) {
        let way = direction(number);
        // The axis along which most lines enter.
        let main = usize::from(way[1].abs() > way[0].abs());
        let other = 1 - main;
        let size = self.blocks.map(|side| (side * SIDE) as f64);
        let entry = if way[main] > 0.0 { 0.0 } else { size[main] };
        let drift = size[main] * way[other] / way[main].abs();
        let per_px = if way[other] == 0.0 { 1.0 } else { PER_PX };
        let [low, high] = [drift.min(0.0), drift.max(0.0)];
        let count = ((size[other] + high - low) * per_px) as usize;
        for i in 0..count {
            let place = (i as f64 + 0.5) / per_px - high;
            let mut at = [0.0; 2];
            (at[main], at[other]) = (entry, place);
            let mut axis = main;
            if place < 0.0 || place > size[other] {
                let edge = if place < 0.0 { 0.0 } else { size[other] };
                if (edge - place) * way[other] <= 0.0 {
                    continue;
                }
                let length = (edge - place) / way[other];
                (at[main], at[other]) = (entry + length * way[main], edge);
                axis = other;
                if at[main] < 0.0 || at[main] > size[main] {
                    continue;
                }
            }
            self.draw_line(way, at, axis, sums);
        }
    }

    /// Draws a line from a place on the edge of the window.
    fn draw_line(
        &self,
        way: [f64; 2],
        from: [f64; 2],
        axis: usize,
        sums: &mut [Vec<[SideSum; 2]>],
    ) {
        let ahead = way.map(|v| if v > 0.0 { 1i64 } else { -1 });
        let inverse = way.map(|v| if v == 0.0 { f64::INFINITY } else { 1.0 / v.abs() });
        let last = self.blocks.map(|side| (side * SIDE) as i64 - 1);
        let mut cell: [i64; 2] = std::array::from_fn(|a| match (a == axis, ahead[a] > 0) {
            (true, true) => 0,
            (true, false) => last[a],
            _ => (from[a] as i64).clamp(0, last[a]),
        });
        let columns: [usize; MOST] = std::array::from_fn(|size| self.side(0, size + 1));
        let mut crossings = [LineState::default(); MOST];
        let crossings = &mut crossings[..sums.len()];
        let mut at = 0.0;
        let enter = |crossings: &mut [LineState], cell: [i64; 2], axis: usize, sizes: usize| {
            let mut outside = cell;
            outside[axis] -= ahead[axis];
            let reachable = sizes > 0 && self.reader.class(self.place(outside)) != CellClass::Solid;
            let block = cell.map(|v| v as usize / SIDE);
            for (size, crossing) in crossings[..sizes].iter_mut().enumerate() {
                let block = (block[1] >> (size + 1)) * columns[size] + (block[0] >> (size + 1));
                *crossing = LineState { block, axis, reachable, sent: [0.0; 3], through: [1.0; 3] };
            }
        };
        let all = crossings.len();
        enter(crossings, cell, axis, all);
        while (0..2).all(|a| (0..=last[a]).contains(&cell[a])) {
            let block = cell.map(|v| v as usize / SIDE);
            // To where it leaves the finest block.
            let to = |cell: i64, side: i64, a: usize| {
                let edge = if ahead[a] > 0 { (cell / side + 1) * side } else { cell / side * side };
                (edge as f64 - from[a]) * ahead[a] as f64 * inverse[a]
            };
            let leaves = |cell: [i64; 2], side: i64| {
                let next = [0, 1]
                    .map(|a| if way[a] == 0.0 { f64::INFINITY } else { to(cell[a], side, a) });
                let axis = usize::from(next[1] < next[0]);
                (axis, next[axis])
            };
            let (out, end) = leaves(cell, SIDE as i64);
            let content = self.contents[block[1] * self.blocks[0] + block[0]];
            match content {
                Content::Empty => {}
                Content::Solid => {
                    crossings.iter_mut().for_each(|crossing| crossing.through = [0.0; 3])
                }
                Content::Mixed => loop {
                    let (next, leave) = leaves(cell, 1);
                    self.cross(cell, (leave - at).max(0.0) as f32, crossings);
                    let mut beyond = cell;
                    beyond[next] += ahead[next];
                    at = leave;
                    if beyond[next].div_euclid(SIDE as i64) != cell[next].div_euclid(SIDE as i64) {
                        break;
                    }
                    cell = beyond;
                },
            }
            // Into the next finest block, by the axis that its edge lies on.
            let entered = if content == Content::Mixed {
                leaves(cell, 1).0
            } else {
                let along = 1 - out;
                let place = from[along] + way[along] * end;
                let [low, high] =
                    [block[along] * SIDE, block[along] * SIDE + SIDE - 1].map(|v| v as i64);
                cell[along] = (place as i64).clamp(low, high);
                cell[out] =
                    ((block[out] * SIDE) as i64) + if ahead[out] > 0 { SIDE as i64 - 1 } else { 0 };
                at = end;
                out
            };
            cell[entered] += ahead[entered];
            let edge = if ahead[entered] > 0 { cell[entered] } else { cell[entered] + 1 };
            // An edge of blocks of some sizes is one of all smaller ones; that of the window one of all.
            let outside = !(0..=last[entered]).contains(&cell[entered]);
            let sizes = if outside {
                all
            } else {
                ((edge / SIDE as i64).trailing_zeros() as usize).min(all)
            };
            for (crossing, sums) in
                crossings[..sizes].iter().zip(&mut *sums).filter(|(crossing, _)| crossing.reachable)
            {
                let sum = &mut sums[crossing.block][crossing.axis];
                sum.lines += 1.0;
                for c in 0..3 {
                    sum.sent[c] += crossing.sent[c];
                    sum.stopped[c] += 1.0 - crossing.through[c];
                }
            }
            if !outside {
                enter(crossings, cell, entered, sizes);
            }
        }
    }

    /// Crosses a cell.
    #[inline]
    fn cross(&self, cell: [i64; 2], length: f32, crossings: &mut [LineState]) {
        let at = self.place(cell);
        let class = self.reader.class(at);
        if class == CellClass::Empty {
            return;
        }
        let [emission, _, stopped, passed] = self.reader.crossed(at, class, length);
        for crossing in crossings {
            for c in 0..3 {
                crossing.sent[c] += crossing.through[c] * stopped[c] * emission[c];
                crossing.through[c] *= passed[c];
            }
        }
    }
}
