//! Level upon level of intervals, each twice as long as those before.
//!
//! Planes of level n lie 2ⁿ slabs apart; from each row of a plane rays `v_n(k) = (2ⁿ, k − 2ⁿ)`,
//! k = 0 … 2ⁿ⁺¹ ("dense" directions: the far ends are 1 px apart), lead to the next plane. The first
//! level is traced: each ray is a beam, the mean of parallel rays spread over the px across it.
//! The others are made from the level before (Freeman, Sannikov and Margel 2025):
//! `T_{n+1}(p, 2k) = T_n(p, k) ⊕ T_n(p + v_n(k), k)`, and the rays between are the mean of the two
//! bent ways, `T_n(p, k) ⊕ T_n(p + v_n(k), k+1)` and `T_n(p, k+1) ⊕ T_n(p + v_n(k+1), k)`.
//!
//! Merging reads planes of odd index only, so only they are kept; one even plane a level is held
//! until the level above has taken it. About 1 interval a cell and level.

use super::interval::{Interval, LANES, PAD, empty, words};
use super::march::{march, meet};
use super::slabs::Slabs;
use super::stencil::{Step, stencil};
use fearless_simd::{f32x16, prelude::*};

/// Keeps the rays of a beam off the corners of cells.
const OFF_CORNERS: f64 = 0.999;

/// A ray of the first level: parallel rays, and all cells that any of them crosses.
#[derive(Debug)]
struct Beam {
    rays: Vec<Vec<Step>>,
    cells: Vec<isize>,
}

/// The kept intervals.
#[derive(Debug, Default)]
pub struct Pyramid {
    /// Level that is traced, and the first that is not made.
    pub first: u32,
    pub end: u32,
    depth: usize,
    rows: usize,
    channels: usize,
    /// From one word to the next in a row of intervals.
    pub stride: usize,
    /// The rays of the first level, and what they were made for.
    beams: Vec<Beam>,
    made_for: (u32, u32, isize),
    odd: Vec<Vec<u32>>,
    even: Vec<Vec<u32>>,
}

/// Planes of a level in a grid `depth` slabs deep.
pub fn planes(depth: usize, level: u32) -> usize {
    depth.div_ceil(1 << level)
}

/// Rays from each row of a plane of a level.
pub const fn rays(level: u32) -> usize {
    (2 << level) + 1
}

/// Levels until one ray spans the grid.
pub fn levels(depth: usize, first: u32) -> u32 {
    depth.next_power_of_two().trailing_zeros().max(first + 1)
}

impl Pyramid {
    /// Makes room for the intervals of a grid from level `first` on.
    pub fn prepare(&mut self, slabs: &Slabs, first: u32) {
        let end = levels(slabs.depth, first);
        let now = (first, end, slabs.depth, slabs.rows, slabs.channels);
        let before = (self.first, self.end, self.depth, self.rows, self.channels);
        self.first = first;
        if now == before {
            return;
        }
        (_, self.end, self.depth, self.rows, self.channels) = now;
        self.stride = slabs.rows.next_multiple_of(LANES) + 2 * PAD;
        let count = (end - first) as usize;
        self.odd.resize_with(count, Vec::new);
        self.even.resize_with(count, Vec::new);
        for level in first..end {
            let (size, at) = (self.plane_size(level), (level - first) as usize);
            let planes = planes(slabs.depth, level);
            self.fill(level, at, planes / 2 * size, |s| &mut s.odd);
            // The last level has no level above that would read its even planes.
            let holds = planes > 2 && level + 1 < end;
            self.fill(level, at, if holds { size } else { 0 }, |s| &mut s.even);
        }
    }

    /// Sizes a buffer of planes and fills it, margins and all, with empty intervals.
    fn fill(
        &mut self,
        level: u32,
        at: usize,
        size: usize,
        buffer: impl Fn(&mut Self) -> &mut Vec<Vec<u32>>,
    ) {
        let (stride, empty) = (self.stride, empty(self.channels));
        debug_assert!(size.is_multiple_of(self.plane_size(level)));
        let buffer = &mut buffer(self)[at];
        buffer.clear();
        buffer.resize(size, 0);
        for (i, word) in buffer.chunks_exact_mut(stride).enumerate() {
            word.fill(empty[i % empty.len()]);
        }
    }

    /// Words of one ray of a plane: all rows.
    #[inline(always)]
    pub fn ray_size(&self) -> usize {
        words(self.channels) * self.stride
    }

    fn plane_size(&self, level: u32) -> usize {
        rays(level) * self.ray_size()
    }

    /// The intervals of a plane of odd index.
    #[inline(always)]
    pub fn plane(&self, level: u32, plane: usize) -> &[u32] {
        let size = self.plane_size(level);
        &self.odd[(level - self.first) as usize][plane / 2 * size..][..size]
    }

    /// Aims the beams, each of `width` rays, the way that the slabs go.
    pub fn aim(&mut self, slabs: &Slabs, width: u32) {
        let now = (self.first, width, slabs.step());
        if self.made_for != now {
            self.made_for = now;
            self.beams = (0..rays(self.first)).map(|k| beam(self.first, k, width, now.2)).collect();
        }
    }

    /// Traces the first level and makes the others from it.
    #[inline(always)]
    pub fn build<S: Simd, const K: usize>(&mut self, simd: S, slabs: &Slabs) {
        for plane in 1..planes(self.depth, self.first) {
            let size = self.plane_size(self.first);
            let held = if plane % 2 == 1 { &mut self.odd[0] } else { &mut self.even[0] };
            if held.is_empty() {
                continue;
            }
            let from = if plane % 2 == 1 { plane / 2 * size } else { 0 };
            let to = &mut held[from..][..size];
            let ray_size = words(K) * self.stride;
            for (beam, to) in self.beams.iter().zip(to.chunks_exact_mut(ray_size)) {
                trace::<S, K>(simd, slabs, plane << self.first, beam, self.stride, to);
            }
            self.ascend::<S, K>(simd, plane);
        }
    }

    /// Makes the planes of higher levels that the one just made completes.
    #[inline(always)]
    fn ascend<S: Simd, const K: usize>(&mut self, simd: S, mut plane: usize) {
        for level in self.first..self.end - 1 {
            let last = plane + 1 == planes(self.depth, level);
            if plane == 1 || (plane.is_multiple_of(2) && !last) {
                return;
            }
            let parent = plane / 2;
            self.extend::<S, K>(simd, level, parent, plane % 2 == 1);
            plane = parent;
        }
    }

    /// Makes a plane of the level above `level`; `whole`: whether there is a second plane to it.
    #[inline(always)]
    fn extend<S: Simd, const K: usize>(&mut self, simd: S, level: u32, parent: usize, whole: bool) {
        let at = (level - self.first) as usize;
        let (sizes, ray_size) = ([level, level + 1].map(|l| self.plane_size(l)), self.ray_size());
        let (stride, rows, round) = (self.stride, self.rows, self.stride - 2 * PAD);
        let [odd, odd_above] = &mut self.odd[at..at + 2] else { return };
        let [even, even_above] = &mut self.even[at..at + 2] else { return };
        let to = match parent % 2 {
            1 => &mut odd_above[parent / 2 * sizes[1]..][..sizes[1]],
            _ if even_above.is_empty() => return,
            _ => &mut even_above[..],
        };
        let far = if whole { &odd[parent * sizes[0]..][..sizes[0]] } else { &[] };
        let ways = Ways::<S, K> { simd, near: even, far, stride, ray_size, round };
        for (made, to) in to.chunks_exact_mut(ray_size).enumerate() {
            let ray = made / 2;
            let shift = ray as isize - (1 << level);
            if made % 2 == 0 {
                for y in (0..rows).step_by(LANES) {
                    ways.way(y, [ray, ray], shift).store(to, stride, PAD + y);
                }
            } else {
                for y in (0..rows).step_by(LANES) {
                    let one = ways.way(y, [ray, ray + 1], shift);
                    let other = ways.way(y, [ray + 1, ray], shift + 1);
                    one.mean(other).store(to, stride, PAD + y);
                }
            }
            empty_tail::<K>(to, stride, rows);
        }
    }
}

/// Two planes one after the other.
struct Ways<'a, S: Simd, const K: usize> {
    simd: S,
    near: &'a [u32],
    /// Empty past the last plane.
    far: &'a [u32],
    stride: usize,
    ray_size: usize,
    /// Rows in whole vectors.
    round: usize,
}

impl<S: Simd, const K: usize> Ways<'_, S, K> {
    /// Along a ray of the first plane, and then one of the second from where it ends, `shift` rows
    /// on.
    #[inline(always)]
    fn way(&self, y: usize, [first, second]: [usize; 2], shift: isize) -> Interval<S, K> {
        let near = &self.near[first * self.ray_size..][..self.ray_size];
        let near = Interval::<S, K>::load(self.simd, near, self.stride, PAD + y);
        let from = y as isize + shift;
        if self.far.is_empty() || from < -(PAD as isize) || from > self.round as isize {
            return near;
        }
        let far = &self.far[second * self.ray_size..][..self.ray_size];
        near.then(Interval::load(self.simd, far, self.stride, PAD.wrapping_add_signed(from)))
    }
}

/// Rows that only fill a vector up stay empty.
#[inline(always)]
fn empty_tail<const K: usize>(to: &mut [u32], stride: usize, rows: usize) {
    for (word, &empty) in to.chunks_exact_mut(stride).zip(empty(K)) {
        word[PAD + rows..].fill(empty);
    }
}

/// A ray of the first level, of `width` parallel rays.
fn beam(level: u32, ray: usize, width: u32, stride: isize) -> Beam {
    let length = 1usize << level;
    let slope = ray as f64 / length as f64 - 1.0;
    let across = |i: u32| OFF_CORNERS * ((f64::from(i) + 0.5) / f64::from(width) - 0.5);
    let steps = |i| stencil(length, slope, across(i)).iter().map(|c| c.place(stride)).collect();
    let rays: Vec<Vec<Step>> = (0..width).map(steps).collect();
    let mut cells: Vec<_> = rays.iter().flatten().map(|step| step.offset).collect();
    cells.sort_unstable();
    cells.dedup();
    Beam { rays, cells }
}

/// Traces one beam from every row of a slab.
#[inline(always)]
fn trace<S: Simd, const K: usize>(
    simd: S,
    slabs: &Slabs,
    slab: usize,
    beam: &Beam,
    stride: usize,
    to: &mut [u32],
) {
    let share = 1.0 / beam.rays.len() as f32;
    for tile in (0..slabs.rows).step_by(64) {
        let start = slabs.start(slab) + tile;
        let met = meet(simd, &slabs.kinds, start, &beam.cells);
        for first in (0..64.min(slabs.rows - tile)).step_by(LANES) {
            let mut interval = Interval::<S, K>::empty(simd);
            if let Some(kinds) = met.kinds(first) {
                interval.through = [f32x16::splat(simd, 0.0); K];
                for ray in &beam.rays {
                    let one = march::<S, K>(simd, slabs, start + first, ray, kinds);
                    for c in 0..3 {
                        interval.light[c] += one.light[c];
                    }
                    for k in 0..K {
                        interval.through[k] += one.through[k];
                    }
                }
                for c in 0..3 {
                    interval.light[c] *= share;
                }
                for k in 0..K {
                    interval.through[k] *= share;
                }
            }
            interval.store(to, stride, PAD + tile + first);
        }
    }
    empty_tail::<K>(to, stride, slabs.rows);
}
