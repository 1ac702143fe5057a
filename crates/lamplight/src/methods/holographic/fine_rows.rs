//! The light of a plane at the rows of cells, where points of the lattice lie 2 px apart.
//!
//! The light between points is a quadratic B-spline, as the final gather reads it. That of half as many points is
//! the same curve as one over all rows, with `¾·R(j) + ¼·R(j ∓ 1)` at the two rows of point j (Chaikin 1974), so
//! pixels gather as from any plane.
//!
//! The neighbour's light counts only if the row that touches it is open: it lies in the same room then, and
//! otherwise perhaps behind a wall. Beyond the border of the grid it does not count: most of the light there is that of the
//! sky, and a border would have dark ticks.

use super::interval::LANES;
use super::slabs::{Slabs, is_open};
use fearless_simd::{f32x16, prelude::*};

/// The share of the neighbouring point.
const NEIGHBOUR: f32 = 0.25;

/// The light of all cones of a plane.
#[derive(Debug, Default)]
pub struct FineRows {
    /// Cone by cone, channel by channel, all rows of cells.
    rows: Vec<f32>,
    /// From one channel to the next.
    stride: usize,
    /// Shares of the points before and after each point, in its first row and in its second.
    shares: [Vec<f32>; 2],
}

impl FineRows {
    /// Sizes the light of a plane: rows of cells between `pad` others.
    pub fn prepare(&mut self, rows: usize, pad: usize) {
        self.stride = rows.next_multiple_of(2 * LANES) + 2 * pad;
        for shares in &mut self.shares {
            shares.resize(self.stride / 2, 0.0);
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
        // The plane may lie beyond the grid, where light enters.
        let start = slabs.start(0).wrapping_add_signed(slab as isize * slabs.step());
        self.find_shares(&slabs.classes[start..][..slabs.rows], pad);
        let channels = light.chunks_exact(stride);
        self.rows.resize(channels.len() * self.stride, 0.0);
        let [first, second] = &self.shares;
        for (points, rows) in channels.zip(self.rows.chunks_exact_mut(self.stride)) {
            for i in (0..rows.len() / 2).step_by(LANES) {
                let at = pad / 2 + i;
                let [before, own, after] =
                    [at - 1, at, at + 1].map(|at| f32x16::from_slice(simd, &points[at..][..LANES]));
                let [first, second] =
                    [first, second].map(|shares| f32x16::from_slice(simd, &shares[i..][..LANES]));
                let (low, high) = (before - own)
                    .mul_add(first, own)
                    .interleave((after - own).mul_add(second, own));
                low.store_slice(&mut rows[2 * i..][..LANES]);
                high.store_slice(&mut rows[2 * i + LANES..][..LANES]);
            }
        }
    }

    /// Finds the shares of neighbours from the classes of the plane's cells.
    fn find_shares(&mut self, cells: &[u8], pad: usize) {
        let count = cells.len().div_ceil(2) as isize;
        let is_shut = |row: isize| {
            usize::try_from(row)
                .is_ok_and(|row| cells.get(row).is_some_and(|&class| !is_open(class)))
        };
        let share = |shut: bool| if shut { 0.0 } else { NEIGHBOUR };
        let [first, second] = &mut self.shares;
        for (i, (first, second)) in first.iter_mut().zip(&mut *second).enumerate() {
            let point = i as isize - (pad / 2) as isize;
            // Nothing comes back into the grid, and light within it is not mixed with that beyond.
            *first = share(is_shut(2 * point - 1) || [0, count].contains(&point));
            *second = share(is_shut(2 * point + 2) || [-1, count - 1].contains(&point));
        }
        if cells.len() % 2 == 1 {
            // The second row of the last point is beyond the grid.
            second[pad / 2 + cells.len() / 2] = 1.0;
        }
    }
}
