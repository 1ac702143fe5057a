//! The rows of cells that share a point of the lattice, where points lie 2 or 4 px apart.
//!
//! A point stands for those of its open rows that lie side by side in its middle, and a bundle from it is the mean over
//! those from these rows. Where one segment of a path ends and the next one begins, light so moves between open
//! cells side by side, and crosses no wall, however thin.
//!
//! The first or the last of four rows may lie behind a closed one. The point does not stand for it then: rays that end
//! there are left out, and pixels read its light from the point beside it ([`super::fine_rows`]). A corridor one or two px
//! wide for which no point stands has no light from beyond the plane ahead.

use super::interval::RowIntervals;
use super::row_bits::{TILE, mask};
use super::slabs::{Slabs, is_open};
use fearless_simd::{f32x16, prelude::*};

/// Rows before a tile of whose points rays may end.
const BEFORE: usize = 32;

/// Returns whether a point stands for a row of a slab, from the classes of the slab's cells.
#[inline]
pub fn is_in_point(cells: &[u8], row: isize, spacing_level: u32) -> bool {
    let is_open = |row: isize| {
        usize::try_from(row).is_ok_and(|row| cells.get(row).is_some_and(|&class| is_open(class)))
    };
    let in_middle = || match row.rem_euclid(4) {
        0 => is_open(row + 1) || !(is_open(row + 2) || is_open(row + 3)),
        3 => is_open(row - 1) || !(is_open(row - 2) || is_open(row - 3)),
        _ => true,
    };
    is_open(row) && (spacing_level < 2 || in_middle())
}

/// The rows of a tile from which the light of bundles counts.
#[derive(Clone, Copy)]
pub struct PointRows {
    /// Bit mask of the rows of the tile that points stand for.
    begin: u64,
    /// That of the rows at the next plane, from [`BEFORE`] rows before the tile on, at which no ray may end: those that no
    /// point stands for, and those beyond the grid that share a point with some within, since a ray to these may have passed
    /// the end of a wall.
    apart: u128,
    /// The level that is traced, and the distance of points.
    level: u32,
    spacing_level: u32,
}

impl PointRows {
    /// Finds the rows of a tile from its first in a slab on. `level`: which is traced, and `2^level` px from point to point.
    /// `is_empty`: there is no matter near it.
    pub fn new(
        slabs: &Slabs,
        [slab, row]: [usize; 2],
        [level, spacing_level]: [u32; 2],
        is_empty: bool,
    ) -> Self {
        let end = slabs.rows.next_multiple_of(1 << spacing_level);
        let near = slabs.classes_in(slab);
        let begin = (0..TILE.min(slabs.rows - row))
            .filter(|i| is_empty || is_in_point(near, (row + i) as isize, spacing_level))
            .fold(0, |bits, i| bits | 1 << i);
        let far = slabs.classes_in(slab + (1 << (level + spacing_level)));
        let is_apart = |row: usize| {
            let is_passed = || is_open(far[row]) && !is_in_point(far, row as isize, spacing_level);
            row < end && (row >= slabs.rows || !is_empty && spacing_level > 1 && is_passed())
        };
        let apart = (0..u128::BITS as usize)
            .filter(|i| (row + i).checked_sub(BEFORE).is_some_and(is_apart))
            .fold(0, |bits, i| bits | 1 << i);
        Self { begin, apart, level, spacing_level }
    }

    /// Returns the number of rows that share a point.
    pub fn count(&self) -> usize {
        1 << self.spacing_level
    }

    /// Returns the bit mask of the rows from which light of a ray counts.
    #[inline(always)]
    pub fn of_ray(&self, ray: usize) -> u64 {
        let rise = (ray as isize - (1 << self.level)) << self.spacing_level;
        self.begin & !(self.apart >> (BEFORE as isize + rise)) as u64
    }

    /// Returns the bit mask of points by one of rows: any of the rows that share a point.
    #[inline(always)]
    pub fn any(&self, mut rows: u64) -> u64 {
        for _ in 0..self.spacing_level {
            rows = even_bits(rows | rows >> 1);
        }
        rows
    }
}

/// The sum of the intervals of rows that count, and their number.
#[derive(Clone, Copy)]
pub struct RowSums<S: Simd, const K: usize> {
    intervals: RowIntervals<S, K>,
    count: f32x16<S>,
}

impl<S: Simd, const K: usize> RowSums<S, K> {
    /// Returns no sums.
    #[inline(always)]
    pub fn none(simd: S) -> Self {
        Self { intervals: RowIntervals::empty(simd), count: f32x16::splat(simd, 0.0) }
    }

    /// Returns the intervals of a vector of rows, of which those of a tile's bit mask count.
    #[inline(always)]
    pub fn of(simd: S, mut intervals: RowIntervals<S, K>, rows: u64, vector: usize) -> Self {
        let [zero, one] = [0.0, 1.0].map(|v| f32x16::splat(simd, v));
        let count = mask(simd, rows, vector).select(one, zero);
        for c in 0..3 {
            intervals.light[c] *= count;
        }
        for k in 0..K {
            intervals.transmittance[k] *= count;
        }
        Self { intervals, count }
    }

    /// Returns the sums of each two neighbours, these and then others.
    #[inline(always)]
    pub fn halved(mut self, others: Self) -> Self {
        for c in 0..3 {
            self.intervals.light[c] = halved(self.intervals.light[c], others.intervals.light[c]);
        }
        for k in 0..K {
            let [own, other] = [self, others].map(|sums| sums.intervals.transmittance[k]);
            self.intervals.transmittance[k] = halved(own, other);
        }
        self.count = halved(self.count, others.count);
        self
    }

    /// Returns the mean intervals: nothing passes where no row counts.
    #[inline(always)]
    pub fn mean(mut self, simd: S) -> RowIntervals<S, K> {
        let one = f32x16::splat(simd, 1.0);
        let share = one / self.count.max(one);
        for c in 0..3 {
            self.intervals.light[c] *= share;
        }
        for k in 0..K {
            self.intervals.transmittance[k] *= share;
        }
        self.intervals
    }
}

/// Returns the sums of neighbours.
#[inline(always)]
fn halved<S: Simd>(low: f32x16<S>, high: f32x16<S>) -> f32x16<S> {
    let (first, second) = low.deinterleave(high);
    first + second
}

/// Returns the bits of even index, as the lowest 32.
#[inline(always)]
fn even_bits(bits: u64) -> u64 {
    let bits = bits & 0x5555_5555_5555_5555;
    let bits = (bits | bits >> 1) & 0x3333_3333_3333_3333;
    let bits = (bits | bits >> 2) & 0x0f0f_0f0f_0f0f_0f0f;
    let bits = (bits | bits >> 4) & 0x00ff_00ff_00ff_00ff;
    let bits = (bits | bits >> 8) & 0x0000_ffff_0000_ffff;
    (bits | bits >> 16) & 0xffff_ffff
}

#[cfg(test)]
mod tests {
    use super::super::slabs::MATTER;
    use super::*;

    #[test]
    fn a_point_stands_for_open_rows_side_by_side() {
        for pattern in 0..16u32 {
            let cells: Vec<u8> =
                (0..4).map(|row| if pattern >> row & 1 == 1 { 0 } else { MATTER }).collect();
            let shared: u32 = (0..4).map(|row| u32::from(is_in_point(&cells, row, 2)) << row).sum();
            assert_eq!(shared & !pattern, 0, "{pattern:04b}: a closed row");
            let run = shared.checked_shr(shared.trailing_zeros()).unwrap_or(0);
            assert!((run + 1).is_power_of_two(), "{pattern:04b}: {shared:04b} is no run");
            // None in the middle is left.
            let left = pattern & !shared;
            assert_eq!(left & 0b0110, 0, "{pattern:04b}: leaves {left:04b}");
            let mirrored = |rows: u32| rows.reverse_bits() >> 28;
            let other: Vec<u8> = cells.iter().rev().copied().collect();
            let of_other: u32 =
                (0..4).map(|row| u32::from(is_in_point(&other, row, 2)) << row).sum();
            assert_eq!(of_other, mirrored(shared), "{pattern:04b}: not the same from both sides");
            let pairs =
                (0..4).map(|row| u32::from(is_in_point(&cells, row, 1)) << row).sum::<u32>();
            assert_eq!(pairs, pattern, "both rows of a pair");
        }
    }

    #[test]
    fn bits_of_points_are_those_of_any_of_their_rows() {
        let seed = 11;
        println!("seed {seed}");
        let rows = fastrand::Rng::with_seed(seed).u64(..) & 0x8421_1248_f731_0f0f;
        for spacing_level in [1, 2] {
            let points = PointRows { begin: 0, apart: 0, level: 0, spacing_level }.any(rows);
            for point in 0..TILE >> spacing_level {
                let own = rows >> (point << spacing_level) & ((1 << (1 << spacing_level)) - 1);
                assert_eq!(points >> point & 1 == 1, own != 0, "point {point}");
            }
        }
    }
}
