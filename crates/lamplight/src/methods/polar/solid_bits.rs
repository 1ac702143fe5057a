//! Which cells are solid, a bit each, so that a shadow tests 64 of them at once, and 16 times as many where all around is
//! empty.

use crate::grid::class::CellClass;
use crate::grid::medium_grid::MediumGrid;

/// Bits of a word.
const WORD: usize = u64::BITS as usize;
/// Columns, or rows, of a block.
pub const BLOCK: usize = 16;

/// The solid cells of a grid, by columns and by rows.
#[derive(Debug, Default)]
pub struct SolidBits {
    pub size: [usize; 2],
    /// Columns of x, each along y; rows of y, each along x.
    lines: [Vec<u64>; 2],
    /// The union of each [`BLOCK`] lines.
    blocks: [Vec<u64>; 2],
}

impl SolidBits {
    /// Reads the grid.
    pub fn read(&mut self, grid: &MediumGrid) {
        self.size = grid.size.map(|n| n as usize);
        let width = self.size[0];
        let words = self.words();
        for axis in 0..2 {
            let Self { size, lines, blocks } = self;
            for (bits, count) in
                [(&mut lines[axis], size[axis]), (&mut blocks[axis], size[axis].div_ceil(BLOCK))]
            {
                bits.clear();
                bits.resize(count * words[axis], 0);
            }
        }
        for (y, row) in grid.classes.chunks(width).enumerate() {
            for x in (0..width).filter(|&x| row[x] == CellClass::Solid) {
                for (axis, [line, at]) in [[x, y], [y, x]].into_iter().enumerate() {
                    let bit = 1 << (at % WORD);
                    self.lines[axis][line * words[axis] + at / WORD] |= bit;
                    self.blocks[axis][line / BLOCK * words[axis] + at / WORD] |= bit;
                }
            }
        }
    }

    /// The words of a column and of a row.
    fn words(&self) -> [usize; 2] {
        [self.size[1], self.size[0]].map(|cells| cells.div_ceil(WORD))
    }

    /// Calls `run` with each run of solid cells of a column (axis 0) or row (axis 1), within `from..to`. Runs end
    /// at words.
    #[inline(always)]
    pub fn runs(
        &self,
        axis: usize,
        line: usize,
        from: usize,
        to: usize,
        mut run: impl FnMut(usize, usize),
    ) {
        let words = self.words()[axis];
        let line = &self.lines[axis][line * words..][..words];
        let mut at = from;
        while at < to {
            let start = at / WORD * WORD;
            let end = to.min(start + WORD);
            let mut bits = line[at / WORD] & mask(at, end);
            while bits != 0 {
                let first = bits.trailing_zeros();
                let length = (bits >> first).trailing_ones();
                run(start + first as usize, start + (first + length) as usize);
                if first + length == u64::BITS {
                    break;
                }
                bits &= u64::MAX << (first + length);
            }
            at = end;
        }
    }

    /// Returns whether no cell of a block of columns or rows is solid within `from..to`.
    #[inline(always)]
    pub fn is_block_empty(&self, axis: usize, block: usize, from: usize, to: usize) -> bool {
        let words = self.words()[axis];
        let block = &self.blocks[axis][block * words..][..words];
        let mut at = from;
        while at < to {
            let end = to.min(at / WORD * WORD + WORD);
            if block[at / WORD] & mask(at, end) != 0 {
                return false;
            }
            at = end;
        }
        true
    }
}

/// The bits of the cells `from..to` of a word.
#[inline(always)]
fn mask(from: usize, to: usize) -> u64 {
    let start = from / WORD * WORD;
    (u64::MAX >> (WORD - (to - start))) & (u64::MAX << (from - start))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::medium_grid::Reading;
    use crate::{Cells, Matter};

    #[test]
    fn blocks_and_runs_hold_the_solid_cells() {
        let seed = fastrand::u64(..);
        println!("seed {seed}");
        let mut random = fastrand::Rng::with_seed(seed);
        let wall = Matter { opacity: 1.0, ..Matter::EMPTY };
        for size in [[1, 1], [64, 16], [131, 75], [40, 150]] {
            let mut cells = Cells::new(size[0], size[1]).unwrap();
            for _ in 0..cells.len() / 300 + 1 {
                cells.set(random.u32(..size[0]), random.u32(..size[1]), wall);
            }
            let mut grid = MediumGrid::default();
            grid.read(&cells, Reading::default());
            let mut bits = SolidBits::default();
            bits.read(&grid);
            let size = size.map(|side| side as usize);
            for _ in 0..2000 {
                let axis = random.usize(..2);
                let line = random.usize(..size[axis]);
                let ends = [0, 1].map(|_| random.usize(..=size[1 - axis]));
                let (from, to) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
                let is_solid = |line: usize, at: usize| {
                    let [x, y] = if axis == 0 { [line, at] } else { [at, line] };
                    cells.is_solid(cells.index(x as u32, y as u32))
                };
                let mut found = vec![false; size[1 - axis]];
                bits.runs(axis, line, from, to, |from, to| found[from..to].fill(true));
                for (at, found) in found.into_iter().enumerate() {
                    assert_eq!(found, (from..to).contains(&at) && is_solid(line, at));
                }
                let block = line / BLOCK;
                let lines = block * BLOCK..(block * BLOCK + BLOCK).min(size[axis]);
                let is_empty = !lines.clone().any(|line| (from..to).any(|at| is_solid(line, at)));
                assert_eq!(bits.is_block_empty(axis, block, from, to), is_empty, "{from}..{to}");
            }
        }
    }
}
