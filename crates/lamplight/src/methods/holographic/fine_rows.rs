//! The light of a plane at the rows of cells, where points of the lattice lie 2 or 4 px apart.
//!
//! The light between points is a quadratic B-spline, as the final gather reads it. That of half as many points is
//! the same curve as one over twice as many, with `¾·R(j) + ¼·R(j ∓ 1)` at the two halves of point j (Chaikin 1974), and
//! the halves of these once more if four rows share a point. So pixels gather as from any plane.
//!
//! The neighbour's light counts only if the rows that touch are both open: it lies in the same room then, and
//! otherwise perhaps behind a wall. Beyond the border of the grid it does not count: most of the light there is that of the
//! sky, and a border would have dark ticks. An open row that its point does not stand for ([`super::point_rows`]) has all
//! of its light from the point beside it, if that stands for the row that it touches, and else none.

use super::interval::LANES;
use super::point_rows::is_in_point;
use super::slabs::{Slabs, is_open};
use fearless_simd::{f32x16, prelude::*};

/// The share of the neighbouring point.
const NEIGHBOUR: f32 = 0.25;

/// The shares of the neighbours before and after in the halves of points.
#[derive(Debug, Default)]
struct Shares {
    /// In the first half of each, and in the second.
    halves: [Vec<f32>; 2],
    /// Halves before those of the grid.
    pad: usize,
}

/// The light of all cones of a plane.
#[derive(Debug, Default)]
pub struct FineRows {
    spacing_level: u32,
    /// Cone by cone, channel by channel, all rows of cells.
    rows: Vec<f32>,
    /// From one channel to the next.
    stride: usize,
    /// In the halves of points, and in the halves of these if four rows share a point.
    shares: Vec<Shares>,
    /// The halves of points between, of one cone and channel.
    between: Vec<f32>,
    /// Rows that no point stands for.
    dark: Vec<usize>,
}

impl FineRows {
    /// Sizes the light of a plane: rows of cells between `pad` others, which are a multiple of two vectors.
    pub fn prepare(&mut self, rows: usize, pad: usize, spacing_level: u32) {
        self.spacing_level = spacing_level;
        self.stride = rows.next_multiple_of(4 * LANES) + 2 * pad;
        // Halves between reach a vector farther, since those of them have neighbours.
        let between = self.stride / 2 + 2 * LANES;
        self.between.resize(if spacing_level > 1 { between } else { 0 }, 0.0);
        self.shares.resize_with(spacing_level as usize, Shares::default);
        for (pass, shares) in self.shares.iter_mut().enumerate() {
            let is_last = pass + 1 == spacing_level as usize;
            let (own, stride) =
                if is_last { (pad, self.stride) } else { (pad / 2 + LANES, between) };
            shares.pad = own;
            for halves in &mut shares.halves {
                halves.resize(stride / 2, 0.0);
            }
        }
    }

    /// Returns the light of a cone of the plane that was read last, by channel.
    #[inline(always)]
    pub fn cone(&self, cone: usize) -> [&[f32]; 3] {
        let rows = &self.rows[3 * cone * self.stride..][..3 * self.stride];
        let (red, rest) = rows.split_at(self.stride);
        let (green, blue) = rest.split_at(self.stride);
        [red, green, blue]
    }

    /// Reads the light of a plane in a slab, cone by cone, channel by channel: `stride` points each, the first `pad` of them
    /// beside the grid.
    #[inline(always)]
    pub fn read<S: Simd>(
        &mut self,
        simd: S,
        slabs: &Slabs,
        slab: usize,
        light: &[f32],
        [stride, pad]: [usize; 2],
    ) {
        self.find_shares(slabs.classes_in(slab));
        let channels = light.chunks_exact(stride);
        self.rows.resize(channels.len() * self.stride, 0.0);
        let Self { rows, shares, between, dark, .. } = self;
        for (points, rows) in channels.zip(rows.chunks_exact_mut(self.stride)) {
            match &shares[..] {
                [halves] => halves.read(simd, points, pad, rows),
                [halves, quarters] => {
                    halves.read(simd, points, pad, between);
                    quarters.read(simd, between, halves.pad, rows);
                }
                _ => {}
            }
            for &row in &*dark {
                rows[row] = 0.0;
            }
        }
    }

    /// Finds the shares of neighbours from the classes of the plane's cells.
    fn find_shares(&mut self, cells: &[u8]) {
        let (count, spacing_level) = (cells.len() as isize, self.spacing_level);
        let end = cells.len().next_multiple_of(1 << spacing_level) as isize;
        let is_own = |row: isize| is_in_point(cells, row, spacing_level);
        // Whether light of a row counts in the one after it.
        let is_joined = |row: isize| match row + 1 {
            // Nothing comes back into the grid, and light within it is not mixed with that beyond.
            0 => false,
            after if after == end => false,
            after if after < 0 || after > end => true,
            after => is_own(row) && is_own(after),
        };
        for (pass, shares) in self.shares.iter_mut().enumerate() {
            let width = 1 << (spacing_level as usize - pass);
            let [first, second] = &mut shares.halves;
            for (i, (first, second)) in first.iter_mut().zip(second).enumerate() {
                let row = (i as isize - (shares.pad / 2) as isize) * width;
                let share = |joined: bool| if joined { NEIGHBOUR } else { 0.0 };
                *first = share(is_joined(row - 1));
                *second = share(is_joined(row + width - 1));
                // Rows of the last point that lie beyond the grid have the light there.
                if row < end && row + width / 2 >= count {
                    *second = 1.0;
                }
            }
        }
        self.find_lone_rows(cells);
    }

    /// Finds the open rows that their points do not stand for, and has them read from the point beside.
    fn find_lone_rows(&mut self, cells: &[u8]) {
        self.dark.clear();
        let Some(Shares { halves, pad }) =
            self.shares.last_mut().filter(|_| self.spacing_level > 1)
        else {
            return;
        };
        let lone = (0..cells.len()).filter(|&row| is_open(cells[row]));
        for row in lone.filter(|&row| !is_in_point(cells, row as isize, self.spacing_level)) {
            let side = if row % 4 == 0 { -1 } else { 1 };
            if is_in_point(cells, row as isize + side, self.spacing_level) {
                halves[row % 2][(*pad + row) / 2] = 1.0;
            } else {
                self.dark.push(*pad + row);
            }
        }
    }
}

impl Shares {
    /// Reads the halves of points, the first `pad` of which lie beside the grid.
    #[inline(always)]
    fn read<S: Simd>(&self, simd: S, points: &[f32], pad: usize, halves: &mut [f32]) {
        let [first, second] = &self.halves;
        for i in (0..halves.len() / 2).step_by(LANES) {
            let at = pad - self.pad / 2 + i;
            let [before, own, after] =
                [at - 1, at, at + 1].map(|at| f32x16::from_slice(simd, &points[at..][..LANES]));
            let [first, second] =
                [first, second].map(|shares| f32x16::from_slice(simd, &shares[i..][..LANES]));
            let (low, high) =
                (before - own).mul_add(first, own).interleave((after - own).mul_add(second, own));
            low.store_slice(&mut halves[2 * i..][..LANES]);
            high.store_slice(&mut halves[2 * i + LANES..][..LANES]);
        }
    }
}
