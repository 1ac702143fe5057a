//! The light of small sources, spread across rows before intervals are extended.
//!
//! Planes have a point per row, and the final gather reads them between the rows. A source one or two rows wide
//! is seen through a few bundles that step by a row, so its light would depend on where the steps fall:
//! fans around it. Signals that are about to be resampled are filtered first (Heckbert 1989). Here the radiance
//! of traced bundles that may meet a small source ([`super::slabs::SMALL`]) becomes
//! `r(p) + e·Σ (r(q) − r(p))`, q the points of the rows beside p. What one row gains another loses, so all the
//! light of the source stays.
//!
//! `e = ¼·(1 + 2^{1−m}·s²)` for bundles of the slope s from planes of level m. Rows blur by a variance of 2e, which is
//! `2e·cos²α` across a bundle, α = atan s: with the same e for all slopes diagonal rays would be twice as sharp as those
//! along the axis, and draw a cross. At level 1 this makes them equal. Longer bundles have more directions, so they need
//! less of it, and light right beside single cells is better for that. Level 0 has the e of level 1, since e > ½
//! could make the light of a row negative.
//!
//! Light is exchanged only between two rows that are both open at the plane. These are side by side in one
//! room, so nothing leaks. Larger sources are resolved without the filter, which would blur their edges.

use super::interval::{LANES, PAD, RowIntervals, words};
use super::lattice::rays;
use super::point_rows::is_in_point;
use super::row_bits::{TILE, mask};
use super::slabs::Slabs;
use fearless_simd::{f32x16, prelude::*};

/// Returns the fraction of the difference between two rows that bundles of a level exchange: along the axis, and what is
/// added on the diagonals.
pub fn exchanged(level: u32) -> [f32; 2] {
    [0.25, 0.5 / (1u32 << level.max(1)) as f32]
}

/// The filter for one plane.
#[derive(Debug, Default)]
pub struct Prefilter {
    /// Number of rays of the plane.
    rays: usize,
    /// Points of the lattice lie `2^spacing_level` px apart.
    spacing_level: u32,
    /// Fractions that they exchange ([`exchanged`]).
    exchanged: [f32; 2],
    /// Bit masks by tile: rows of the plane that are open, along with the row after.
    open_pairs: Vec<u64>,
    /// Bit masks by tile and ray: rows from which a bundle may meet a small source.
    small: Vec<u64>,
    /// Pairs of rows that exchange light, as bit masks of the first, by tile.
    pairs: Vec<u64>,
    /// Intervals of a ray before the exchange.
    before: Vec<u32>,
}

impl Prefilter {
    /// Starts with a plane of a level, whose points lie `2^spacing_level` px apart.
    pub fn begin(&mut self, rows: usize, [level, spacing_level]: [u32; 2]) {
        self.rays = rays(level);
        self.spacing_level = spacing_level;
        self.exchanged = exchanged(level);
        self.small.clear();
        self.small.resize(rows.div_ceil(TILE) * self.rays, 0);
    }

    /// Returns the bit masks of a tile, by ray.
    pub fn small_sources(&mut self, tile: usize) -> &mut [u64] {
        &mut self.small[tile * self.rays..][..self.rays]
    }

    /// Filters the intervals of the plane that lies in a slab, of which one word follows another at `stride`.
    #[inline(always)]
    pub fn filter<S: Simd, const K: usize>(
        &mut self,
        simd: S,
        slabs: &Slabs,
        slab: usize,
        plane: &mut [u32],
        stride: usize,
    ) {
        if self.small.iter().all(|&small| small == 0) {
            return;
        }
        self.find_open_pairs(slabs.classes_in(slab));
        for (ray, intervals) in plane.chunks_exact_mut(words(K) * stride).enumerate() {
            self.spread::<S, K>(simd, ray, intervals, stride);
        }
    }

    /// Finds the pairs of rows of the lattice that are both open where they touch, from the classes of cells.
    fn find_open_pairs(&mut self, cells: &[u8]) {
        let spacing_level = self.spacing_level;
        let is_open = |row: usize| is_in_point(cells, row as isize, spacing_level);
        self.open_pairs.clear();
        for tile in 0..self.small.len() / self.rays {
            let bits = (0..TILE).fold(0, |bits, row| {
                let after = (tile * TILE + row + 1) << spacing_level;
                bits | u64::from(is_open(after - 1) && is_open(after)) << row
            });
            self.open_pairs.push(bits);
        }
    }

    /// Exchanges light between the rows of a ray.
    #[inline(always)]
    fn spread<S: Simd, const K: usize>(
        &mut self,
        simd: S,
        ray: usize,
        intervals: &mut [u32],
        stride: usize,
    ) {
        self.pairs.clear();
        self.pairs.extend(self.small.iter().skip(ray).step_by(self.rays));
        if self.pairs.iter().all(|&small| small == 0) {
            return;
        }
        for tile in 0..self.pairs.len() {
            let either = self.pairs[tile] | from_next(&self.pairs, tile);
            self.pairs[tile] = either & self.open_pairs[tile];
        }
        self.before.clear();
        self.before.extend_from_slice(intervals);
        let straight = 0.5 * (self.rays - 1) as f32;
        let slope = (ray as f32 - straight) / straight;
        let [own, diagonal] = self.exchanged;
        let part = f32x16::splat(simd, own + diagonal * slope * slope);
        let mut last = 0;
        for (tile, &with_next) in self.pairs.iter().enumerate() {
            let with_last = with_next << 1 | last >> (TILE - 1);
            last = with_next;
            for v in
                (0..TILE / LANES).filter(|v| (with_last | with_next) >> (v * LANES) & 0xffff != 0)
            {
                let at = PAD + tile * TILE + v * LANES;
                let [low, own, high] = [at - 1, at, at + 1]
                    .map(|at| RowIntervals::<S, K>::load(simd, &self.before, stride, at));
                let zero = f32x16::splat(simd, 0.0);
                let to_low = mask(simd, with_last, v).select(part, zero);
                let to_high = mask(simd, with_next, v).select(part, zero);
                let mut spread = own;
                for c in 0..3 {
                    let here = own.light[c];
                    let gained = (low.light[c] - here) * to_low;
                    spread.light[c] = here + (high.light[c] - here).mul_add(to_high, gained);
                }
                spread.store(intervals, stride, at);
            }
        }
    }
}

/// Returns the bits of the row after each row of a tile.
#[inline(always)]
fn from_next(bits: &[u64], tile: usize) -> u64 {
    bits[tile] >> 1 | bits.get(tile + 1).map_or(0, |next| next << (TILE - 1))
}
