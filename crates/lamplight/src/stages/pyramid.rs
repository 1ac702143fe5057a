//! Blurs of many widths at once: a pyramid of grids, each half the size of the one before (Burt 1981).
//!
//! A grid is made from the finer one by the weights of a quartic B-spline, (1, 5, 10, 10, 5, 1)/32 along each
//! axis, and interpolated by the same spline. Narrower kernels show where the cells of the coarse grids lie.
//! The outermost cells are repeated beyond the grid.

use crate::Rgb;

/// Weights of the six fine cells around a coarse one, along an axis.
pub const KERNEL: [f32; 6] =
    [1.0 / 32.0, 5.0 / 32.0, 10.0 / 32.0, 10.0 / 32.0, 5.0 / 32.0, 1.0 / 32.0];

/// A sum of weighted values, and of the weights.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(16))]
pub struct BlurSum([f32; 4]);

impl BlurSum {
    /// One value with a weight.
    #[inline]
    pub fn of(weight: f32, [r, g, b]: Rgb) -> Self {
        Self([weight * r, weight * g, weight * b, weight])
    }

    /// Drops the weight, for values whose weights are counted already.
    pub fn without_weight(self) -> Self {
        let [r, g, b, _] = self.0;
        Self([r, g, b, 0.0])
    }

    /// Adds a multiple of a sum.
    #[inline]
    pub fn add(&mut self, factor: f32, other: Self) {
        (0..4).for_each(|c| self.0[c] += factor * other.0[c]);
    }

    #[inline(always)]
    fn combination<const N: usize>(factors: [f32; N], sums: [Self; N]) -> Self {
        let mut total = Self::default();
        factors.into_iter().zip(sums).for_each(|(factor, sum)| total.add(factor, sum));
        total
    }

    /// The sum of the weights.
    pub fn weight(self) -> f32 {
        self.0[3]
    }

    /// The weighted mean; not a number if there are no weights.
    pub fn mean(self) -> Rgb {
        self.scaled(1.0 / self.0[3])
    }

    /// The sum of weighted values times a factor.
    #[inline]
    pub fn scaled(self, factor: f32) -> Rgb {
        let [r, g, b, _] = self.0;
        [r, g, b].map(|v| v * factor)
    }
}

/// Blurs of sums over cells, from about 1 px on, each twice as wide as the one before.
#[derive(Debug, Default)]
pub struct Pyramid {
    /// Size of the grid of cells, which is not stored.
    cells: [usize; 2],
    /// Fine to coarse.
    levels: Vec<Level>,
}

#[derive(Debug, Default)]
struct Level {
    size: [usize; 2],
    sums: Vec<BlurSum>,
}

impl Pyramid {
    /// Empties the pyramid over a grid of cells. Fewer octaves than before keep the memory of the others.
    pub fn clear(&mut self, cells: [usize; 2], octaves: u32) {
        self.cells = cells;
        let octaves = octaves as usize;
        if self.levels.len() < octaves {
            self.levels.resize_with(octaves, Level::default);
        }
        let mut size = cells;
        for (k, level) in self.levels.iter_mut().enumerate() {
            size = if k < octaves { size.map(|n| n.div_ceil(2)) } else { [0; 2] };
            level.size = size;
            level.sums.clear();
            level.sums.resize(size[0] * size[1], BlurSum::default());
        }
    }

    /// Adds the sum of a cell.
    pub fn add(&mut self, at: [usize; 2], sum: BlurSum) {
        if let Some(finest) = self.levels.first_mut() {
            finest.spread(at, self.cells, sum);
        }
    }

    /// Takes the weights that were added to another pyramid of this size, but not its values.
    pub fn copy_weights(&mut self, other: &Self) {
        if let (Some(finest), Some(other)) = (self.levels.first_mut(), other.levels.first()) {
            for (sum, other) in finest.sums.iter_mut().zip(&other.sums) {
                sum.0[3] = other.0[3];
            }
        }
    }

    /// Replaces the finest blur by the sum of all; each counts `octave` times the one before.
    pub fn sum_octaves(&mut self, octave: f32) {
        for k in 1..self.levels.len() {
            let (fine, coarse) = self.levels.split_at_mut(k);
            coarse[0].blur(&fine[k - 1]);
        }
        for k in (1..self.levels.len()).rev() {
            let (fine, coarse) = self.levels.split_at_mut(k);
            fine[k - 1].add_interpolated(octave, &coarse[0]);
        }
    }

    /// The finest blur along row `y` of the cells; `None` if there are no octaves.
    pub fn row(&self, y: usize) -> Option<PyramidRow<'_>> {
        self.levels.first()?.row(y)
    }
}

impl Level {
    /// The sums along row `y` of the finer grid; `None` if the level is empty.
    fn row(&self, y: usize) -> Option<PyramidRow<'_>> {
        let [width, height] = self.size;
        if height == 0 {
            return None;
        }
        let rows = around(y, height).map(|y| &self.sums[y * width..][..width]);
        Some(PyramidRow {
            rows,
            weights: weights(y),
            at: usize::MAX - 1,
            columns: Default::default(),
        })
    }

    /// Adds a sum of the finer grid.
    #[inline]
    fn spread(&mut self, [x, y]: [usize; 2], finer: [usize; 2], sum: BlurSum) {
        let [width, height] = self.size;
        let [columns, rows] = [shares(x, finer[0]), shares(y, finer[1])];
        for (y, row) in (y / 2..).zip(rows).filter(|(y, _)| (1..=height).contains(y)) {
            let first = (y - 1) * width + x / 2;
            if (1..width - 1).contains(&(x / 2)) {
                let three = self.sums[first - 1..].iter_mut().zip(columns);
                three.for_each(|(cell, column)| cell.add(row * column, sum));
                continue;
            }
            for (k, column) in columns.into_iter().enumerate() {
                if (1..=width).contains(&(x / 2 + k)) {
                    self.sums[first + k - 1].add(row * column, sum);
                }
            }
        }
    }

    /// Sets all sums from those of the finer grid.
    fn blur(&mut self, finer: &Self) {
        let [width, height] = finer.size;
        for (y, blurred) in self.sums.chunks_mut(self.size[0].max(1)).enumerate() {
            let rows = taps(y, height).map(|y| &finer.sums[y * width..][..width]);
            let column = |x: usize| BlurSum::combination(KERNEL, rows.map(|row| row[x]));
            let mut columns = taps(0, width).map(column);
            for (x, blurred) in blurred.iter_mut().enumerate() {
                if x > 0 {
                    columns.rotate_left(2);
                    let [.., before_last, last] = taps(x, width);
                    (columns[4], columns[5]) = (column(before_last), column(last));
                }
                *blurred = BlurSum::combination(KERNEL, columns);
            }
        }
    }

    /// Adds the coarser grid, interpolated and scaled.
    fn add_interpolated(&mut self, factor: f32, coarser: &Self) {
        for (y, row) in self.sums.chunks_mut(self.size[0].max(1)).enumerate() {
            let Some(mut coarse) = coarser.row(y) else { return };
            for (x, sum) in row.iter_mut().enumerate() {
                sum.add(factor, coarse.at(x));
            }
        }
    }
}

/// A row of fine cells between three rows of a coarser grid.
#[derive(Debug)]
pub struct PyramidRow<'a> {
    rows: [&'a [BlurSum]; 3],
    weights: [f32; 3],
    /// The coarse column around which `columns` are known; the last but one of all numbers at first.
    at: usize,
    /// The rows, interpolated at three columns.
    columns: [BlurSum; 3],
}

impl PyramidRow<'_> {
    /// Interpolates at column `x` of the fine cells. Fastest from left to right.
    #[inline]
    pub fn at(&mut self, x: usize) -> BlurSum {
        let coarse = x / 2;
        if self.at != coarse {
            let [left, middle, right] = around(x, self.rows[0].len());
            let [.., before, here] = self.columns;
            self.columns = if self.at.wrapping_add(1) == coarse {
                [before, here, self.column(right)]
            } else {
                [self.column(left), self.column(middle), self.column(right)]
            };
            self.at = coarse;
        }
        BlurSum::combination(weights(x), self.columns)
    }

    #[inline]
    fn column(&self, x: usize) -> BlurSum {
        let [above, row, below] = self.rows;
        BlurSum::combination(self.weights, [above[x], row[x], below[x]])
    }
}

/// The coarse cell that contains fine cell `x`, between those beside it, of `n` along an axis.
#[inline]
fn around(x: usize, n: usize) -> [usize; 3] {
    [(x / 2).saturating_sub(1), x / 2, (x / 2 + 1).min(n - 1)]
}

/// Weights of the coarse cells [`around`] a fine one.
#[inline]
fn weights(x: usize) -> [f32; 3] {
    let [outer, inner, middle, ..] = KERNEL.map(|weight| 2.0 * weight);
    if x.is_multiple_of(2) { [inner, middle, outer] } else { [outer, middle, inner] }
}

/// The fine cells around coarse cell `x`, of `n` along an axis.
#[inline]
fn taps(x: usize, n: usize) -> [usize; 6] {
    [0, 1, 2, 3, 4, 5].map(|tap| (2 * x + tap).saturating_sub(2).min(n - 1))
}

/// The shares of fine cell `x`, of `n` along an axis, in the coarse cells [`around`] it.
#[inline]
fn shares(x: usize, n: usize) -> [f32; 3] {
    if x > 0 && x + 1 < n {
        return weights(x).map(|weight| 0.5 * weight);
    }
    // The outermost cells count for those beyond the grid too.
    [0, 1, 2].map(|k| {
        let Some(coarse) = (x / 2 + k).checked_sub(1) else { return 0.0 };
        let of_cell = taps(coarse, n).into_iter().zip(KERNEL).filter(|(tap, _)| *tap == x);
        of_cell.map(|(_, weight)| weight).sum()
    })
}
