//! Larger blocks measured by lines through all cells of a window.
//!
//! A block composed of smaller ones stops too much: where a surface runs through several of them, rays that pass
//! beside it in one count as spread over all of the next. So lines of each direction go through the cells, and every
//! block on their way, of every size at once, counts what they see and what is stopped between its entry and its exit.

use super::block::{FarBlock, PackedRgb};
use super::paths::{Across, DIRECTIONS, PER_DIRECTION, Strips, direction, face, slot};
use super::read::{BlockReader, HIDDEN_WEIGHT, SIDE};
use super::squares;
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

/// Sums over the lines in a slot of a block.
#[derive(Clone, Copy, Debug, Default)]
struct SlotSum {
    /// Those from open space, and those out of a wall.
    lines: f32,
    hidden: f32,
    sent: Rgb,
    stopped: Rgb,
}

/// A line since it entered a block of some size.
#[derive(Clone, Copy, Debug, Default)]
struct LineState {
    /// The index of the block among the sums, and the number of the line's slot in its direction.
    block: usize,
    number: usize,
    /// False if it came out of a solid cell.
    reachable: bool,
    sent: Rgb,
    through: Rgb,
}

/// A line through the window.
struct SweptLine {
    /// The place at which it enters, px.
    from: [f64; 2],
    /// The unit vector along it, the lengths along it per px along each axis, and the signs of its components.
    way: [f64; 2],
    inverse: [f64; 2],
    ahead: [i64; 2],
    across: Across,
    strips: Strips,
    /// Its own.
    offset: f64,
}

impl SweptLine {
    /// Returns the axis along which it leaves the square of 2^`doubled` cells around a cell, at a multiple of that, and
    /// the length up to there.
    #[inline]
    fn leaves(&self, cell: [i64; 2], doubled: usize) -> (usize, f64) {
        let length = |a: usize| {
            if self.way[a] == 0.0 {
                return f64::INFINITY;
            }
            let edge = ((cell[a] >> doubled) + i64::from(self.ahead[a] > 0)) << doubled;
            (edge as f64 - self.from[a]) * self.inverse[a]
        };
        let lengths = [length(0), length(1)];
        let axis = usize::from(lengths[1] < lengths[0]);
        (axis, lengths[axis])
    }
}

impl LineState {
    /// Adds the line to the sums of the block, when it leaves it.
    fn add_to(&self, sums: &mut [[SlotSum; PER_DIRECTION]]) {
        let sum = &mut sums[self.block][self.number];
        if !self.reachable {
            sum.hidden += 1.0;
            return;
        }
        sum.lines += 1.0;
        for c in 0..3 {
            sum.sent[c] += self.sent[c];
            sum.stopped[c] += 1.0 - self.through[c];
        }
    }
}

impl Swept<'_> {
    /// Measures the blocks of each of so many larger sizes, row by row; those without matter, and those that no line
    /// enters, are `None`.
    pub fn measure(&self, sizes: usize) -> Vec<Vec<Option<FarBlock>>> {
        let sizes = sizes.min(MOST);
        let count = |size: usize| self.side(0, size) * self.side(1, size);
        let counts: Vec<usize> = (1..=sizes).map(count).collect();
        let uniform = squares::uniform(self.blocks, self.contents.clone(), Content::Mixed, sizes);
        let widths = squares::widths(self.blocks, &uniform);
        let sums: Vec<Vec<Vec<[SlotSum; PER_DIRECTION]>>> = (0..DIRECTIONS)
            .into_par_iter()
            .map(|number| {
                let mut sums: Vec<_> =
                    counts.iter().map(|&n| vec![[SlotSum::default(); PER_DIRECTION]; n]).collect();
                self.draw_lines(number, &widths, &mut sums);
                sums
            })
            .collect();
        let block = |size: usize, at: usize| {
            let mut block = FarBlock::HIDDEN;
            let mut reachable = false;
            for (number, sums) in sums.iter().enumerate() {
                for (part, sum) in
                    sums[size][at].iter().enumerate().filter(|(_, sum)| sum.lines > 0.0)
                {
                    reachable = true;
                    let count = sum.lines + HIDDEN_WEIGHT * sum.hidden;
                    let mean = |rgb: Rgb| PackedRgb::new(rgb.map(|v| v / count));
                    block.sent[slot(number, part)] = mean(sum.sent);
                    block.stopped[slot(number, part)] = mean(sum.stopped);
                }
            }
            reachable.then_some(block)
        };
        let of_size = |size: usize| {
            let is_empty = |at: usize| uniform[size + 1][at] == Content::Empty;
            (0..counts[size]).map(|at| if is_empty(at) { None } else { block(size, at) }).collect()
        };
        (0..sizes).into_par_iter().map(of_size).collect()
    }

    /// The number of blocks of a size along an axis.
    pub fn side(&self, axis: usize, size: usize) -> usize {
        squares::side(self.blocks[axis], size)
    }

    /// Returns the place of a cell of the window among those of the reader.
    fn place(&self, cell: [i64; 2]) -> [i64; 2] {
        [0, 1].map(|a| cell[a] + self.origin[a])
    }

    /// Draws all lines of a direction.
    fn draw_lines(&self, number: usize, widths: &[u8], sums: &mut [Vec<[SlotSum; PER_DIRECTION]>]) {
        let way = direction(number);
        let across = Across::new(way);
        let strips = Strips::new(&across);
        // The axis along which most lines enter.
        let main = usize::from(way[1].abs() > way[0].abs());
        let other = 1 - main;
        let size = self.blocks.map(|side| (side * SIDE) as f64);
        let entry = if way[main] > 0.0 { 0.0 } else { size[main] };
        let drift = size[main] * way[other] / way[main].abs();
        let per_px = if way[other] == 0.0 { 1.0 } else { PER_PX };
        let [low, high] = [drift.min(0.0), drift.max(0.0)];
        let ahead = way.map(|v| if v > 0.0 { 1 } else { -1 });
        let inverse = way.map(|v| 1.0 / v);
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
            let offset = across.offset(at);
            let line = SweptLine { from: at, way, inverse, ahead, across, strips, offset };
            self.draw_line(&line, axis, widths, sums);
        }
    }

    /// Draws a line that enters the window along an axis.
    fn draw_line(
        &self,
        line: &SweptLine,
        axis: usize,
        widths: &[u8],
        sums: &mut [Vec<[SlotSum; PER_DIRECTION]>],
    ) {
        let last = self.blocks.map(|side| (side * SIDE) as i64 - 1);
        let mut cell: [i64; 2] = std::array::from_fn(|a| match (a == axis, line.ahead[a] > 0) {
            (true, true) => 0,
            (true, false) => last[a],
            _ => (line.from[a] as i64).clamp(0, last[a]),
        });
        let mut crossings = [LineState::default(); MOST];
        let crossings = &mut crossings[..sums.len()];
        let mut entered = axis;
        let mut at = 0.0;
        self.enter(line, cell, entered, crossings);
        loop {
            let block = cell.map(|v| v as usize / SIDE);
            let here = block[1] * self.blocks[0] + block[0];
            if self.contents[here] == Content::Mixed {
                entered = self.cross_cells(line, &mut cell, &mut at, entered, crossings);
            } else {
                // Across the largest block around that is empty or solid.
                if self.contents[here] == Content::Solid {
                    crossings.iter_mut().for_each(|crossing| crossing.through = [0.0; 3]);
                }
                let doubled = SIDE.ilog2() as usize + usize::from(widths[here]);
                let side = 1 << doubled;
                (entered, at) = line.leaves(cell, doubled);
                let along = 1 - entered;
                let first = cell.map(|v| v & !(side - 1));
                let place = line.from[along] + line.way[along] * at;
                cell[along] = (place as i64).clamp(first[along], first[along] + side - 1);
                cell[entered] = first[entered] + if line.ahead[entered] > 0 { side - 1 } else { 0 };
            }
            cell[entered] += line.ahead[entered];
            let outside = !(0..=last[entered]).contains(&cell[entered]);
            // An edge of blocks of some size is one of all smaller ones; that of the window one of all.
            let edge = cell[entered] + i64::from(line.ahead[entered] < 0);
            let sizes = (edge / SIDE as i64).trailing_zeros() as usize;
            let left = if outside { crossings.len() } else { sizes.min(crossings.len()) };
            for (crossing, sums) in crossings[..left].iter().zip(&mut *sums) {
                crossing.add_to(sums);
            }
            if outside {
                return;
            }
            self.enter(line, cell, entered, &mut crossings[..left]);
        }
    }

    /// Lets a line enter blocks of the first sizes, by a cell along an axis.
    fn enter(&self, line: &SweptLine, cell: [i64; 2], axis: usize, crossings: &mut [LineState]) {
        if crossings.is_empty() {
            return;
        }
        let mut outside = cell;
        outside[axis] -= line.ahead[axis];
        let reachable = self.reader.class(self.place(outside)) != CellClass::Solid;
        for (size, crossing) in (1..).zip(crossings) {
            let [x, y] = cell.map(|v| (v as usize / SIDE) >> size);
            let middle = [x, y].map(|v| v as f64 + 0.5);
            let offset = line.offset / (SIDE << size) as f64 - line.across.offset(middle);
            *crossing = LineState {
                block: y * self.side(0, size) + x,
                number: line.strips.number(line.across.entry(offset)),
                reachable,
                sent: [0.0; 3],
                through: [1.0; 3],
            };
        }
    }

    /// Crosses the cells of a finest block, from the one at which a line enters along an axis to the last. Returns the
    /// axis along which the line leaves it.
    fn cross_cells(
        &self,
        line: &SweptLine,
        cell: &mut [i64; 2],
        at: &mut f64,
        mut axis: usize,
        crossings: &mut [LineState],
    ) -> usize {
        loop {
            let (next, end) = line.leaves(*cell, 0);
            self.cross(*cell, face(line.way, axis), (end - *at).max(0.0) as f32, crossings);
            *at = end;
            axis = next;
            let beyond = cell[next] + line.ahead[next];
            if beyond.div_euclid(SIDE as i64) != cell[next].div_euclid(SIDE as i64) {
                return next;
            }
            cell[next] = beyond;
        }
    }

    /// Crosses a cell.
    #[inline]
    fn cross(&self, cell: [i64; 2], face: usize, length: f32, crossings: &mut [LineState]) {
        // What stops all light in the smallest block does so in all.
        if crossings[0].through == [0.0; 3] {
            return;
        }
        let at = self.place(cell);
        let class = self.reader.class(at);
        if class == CellClass::Empty {
            return;
        }
        let [radiance, stopped, passed] = self.reader.crossed(at, class, face, length);
        for crossing in crossings {
            for c in 0..3 {
                crossing.sent[c] += crossing.through[c] * stopped[c] * radiance[c];
                crossing.through[c] *= passed[c];
            }
        }
    }
}
