//! Light through cones, merged down from the far end of the grid.
//!
//! `R_n(p, i)` is the light that reaches p through cone i of level n, between the rays i and i + 1:
//! an integral of radiance over the angle `A_n(i)`. Level by level, down from the sky (Freeman,
//! Sannikov and Margel 2025), with s ∈ {0, 1}, j = 2i + s, k = i + s:
//!
//! * planes of odd index: `R_n(p, i) = Σ_s A_{n+1}(j)·r(T_n(p, k)) + t(T_n(p, k))·R_{n+1}(p + v_n(k), j)`;
//! * planes of even index are planes of the level above: `R_n(p, i) = Σ_s R_{n+1}(p, j)`, exactly.
//!   (The paper takes the mean of this and of a path over the next plane, which blurs.)
//!
//! The first level m, which pixels gather from, has cones half as wide, those of the level above.
//! Otherwise the light of a whole cone would come from one place of the plane, and distant edges would
//! jump by the width of a cone across the final gather. There
//! `R_m(p, j) = Σ_κ w_κ [A_{m+1}(j)·r(T_m(p, κ)) + t(T_m(p, κ))·R_{m+1}(p + v_m(κ), j)]`, κ the two
//! rays on both sides of cone j and w ¾ and ¼, as its middle lies at a quarter between them.
//!
//! Pixels are lit from the far end to the near one, so one plane per level is held at any time.

use super::extend::IntervalLevels;
use super::interval::{LANES, PAD, RowIntervals, words};
use super::lattice::{angle, planes, slope};
use super::trace::{TILE, TileLight, VECTORS, any_in_vector, mask};
use crate::Rgb;
use crate::simd::dispatch_wide;
use fearless_simd::{Level, f32x16, prelude::*, u32x16};
use std::ops::Range;

/// The light of one plane of a level.
#[derive(Debug, Default)]
struct PlaneLight {
    /// Cone by cone, channel by channel, all rows.
    rows: Vec<f32>,
    /// Index of the plane; none if it is the sky.
    plane: Option<usize>,
    /// Light of the sky by cone.
    sky: Vec<Rgb>,
    angles: Vec<f32>,
}

impl PlaneLight {
    /// Returns the light of a cone.
    #[inline(always)]
    fn cone(&self, cone: usize, stride: usize) -> ConeLight<'_> {
        match self.plane {
            Some(_) => {
                let (red, rest) = self.rows(cone, stride).split_at(stride);
                let (green, blue) = rest.split_at(stride);
                ConeLight::Rows([red, green, blue])
            }
            None => ConeLight::Sky(self.sky[cone]),
        }
    }

    /// Returns all rows of a cone, channel by channel; none for the sky.
    #[inline(always)]
    fn rows(&self, cone: usize, stride: usize) -> &[f32] {
        let size = 3 * stride;
        if self.rows.is_empty() { &[] } else { &self.rows[cone * size..][..size] }
    }
}

/// The light of the planes that are held, one per level.
#[derive(Debug, Default)]
pub struct MergedLight {
    depth: usize,
    rows: usize,
    first: u32,
    /// Rows of sky before and after those of the grid.
    pad: usize,
    stride: usize,
    /// From the first level on; the last is the sky.
    levels: Vec<PlaneLight>,
    /// The level that pixels gather from: the first, or the second.
    shown: usize,
}

/// The light of a cone at the rows of a plane.
#[derive(Clone, Copy)]
pub enum ConeLight<'a> {
    /// By channel, row by row.
    Rows([&'a [f32]; 3]),
    /// Equal at every row.
    Sky(Rgb),
}

impl ConeLight<'_> {
    /// Returns the light at sixteen rows from `at` on, counted with the pad.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S, at: usize) -> [f32x16<S>; 3] {
        let mut light = [f32x16::splat(simd, 0.0); 3];
        match self {
            Self::Rows(rows) => {
                for c in 0..3 {
                    light[c] = f32x16::from_slice(simd, &rows[c][at..][..LANES]);
                }
            }
            Self::Sky(sky) => {
                for c in 0..3 {
                    light[c] = f32x16::splat(simd, sky[c]);
                }
            }
        }
        light
    }

    /// Adds the weighted light at the rows of a tile from `at` on and at the rows one further on, in
    /// the vectors of which `lit` has bits.
    #[inline(always)]
    pub fn add<S: Simd>(
        &self,
        simd: S,
        at: usize,
        weights: &[f32; 2],
        lit: u64,
        light: &mut TileLight<S>,
    ) {
        for v in 0..VECTORS {
            if !any_in_vector(lit, v * LANES) {
                continue;
            }
            let near = self.load(simd, at + v * LANES);
            let next = self.load(simd, at + v * LANES + 1);
            for c in 0..3 {
                light[c][v] = near[c].mul_add(weights[0], light[c][v]);
                light[c][v] = next[c].mul_add(weights[1], light[c][v]);
            }
        }
    }

    /// Like [`Self::add`], for rows that are open only in part: `open` has the bits of either row. If
    /// only one of them is open, it counts for both. The sum is scaled by `weight`.
    #[inline(always)]
    pub fn add_open<S: Simd>(
        &self,
        simd: S,
        at: usize,
        weights: &[f32; 2],
        open: [u64; 2],
        weight: f32,
        light: &mut TileLight<S>,
    ) {
        let both = open[0] & open[1];
        for v in 0..VECTORS {
            if !any_in_vector(open[0] | open[1], v * LANES) {
                continue;
            }
            for (i, &part) in weights.iter().enumerate() {
                let part = mask(simd, both, v)
                    .select(f32x16::splat(simd, part * weight), f32x16::splat(simd, weight));
                let part = mask(simd, open[i], v).select(part, f32x16::splat(simd, 0.0));
                let row = self.load(simd, at + v * LANES + i);
                for c in 0..3 {
                    light[c][v] = row[c].mul_add(part, light[c][v]);
                }
            }
        }
    }
}

impl MergedLight {
    /// Allocates the light of a grid, for rays of the final gather that rise by up to `reach` rows.
    pub fn prepare(&mut self, depth: usize, rows: usize, intervals: &IntervalLevels, reach: usize) {
        let pad = TILE + (reach + 1).next_multiple_of(LANES);
        let now = (depth, rows, intervals.first, pad);
        if now == (self.depth, self.rows, self.first, self.pad) {
            return;
        }
        (self.depth, self.rows, self.first, self.pad) = now;
        self.stride = rows.next_multiple_of(LANES) + 2 * pad;
        self.levels.clear();
        for level in self.first..=intervals.end {
            let width = if level == self.first { level + 1 } else { level };
            let cones = 2 << width;
            // The topmost is the sky, which has no rows.
            let held = if level < intervals.end { cones * 3 * self.stride } else { 0 };
            self.levels.push(PlaneLight {
                rows: vec![0.0; held],
                plane: None,
                sky: vec![[0.0; 3]; cones],
                angles: (0..cones).map(|cone| angle(width, cone) as f32).collect(),
            });
        }
    }

    /// Starts at the far end of the grid. `sky` returns the radiance of the sky by angle, 0 straight
    /// ahead.
    pub fn begin(&mut self, sky: impl Fn(f64) -> Rgb) {
        let top = self.levels.len() - 1;
        let level = self.first + top as u32;
        let mut changed = false;
        for (cone, held) in self.levels[top].sky.iter_mut().enumerate() {
            let [from, to] = [cone, cone + 1].map(|cone| slope(level, cone).atan());
            let light = sky(0.5 * (from + to)).map(|v| v * (to - from) as f32);
            changed |= std::mem::replace(held, light) != light;
        }
        for at in (0..=top).rev() {
            let (below, above) = self.levels.split_at_mut(at + 1);
            let Some(PlaneLight { rows, plane, sky, .. }) = below.last_mut() else { return };
            *plane = None;
            if let (true, Some(above)) = (changed, above.first()) {
                let parts = above.sky.len() / sky.len();
                for (sky, above) in sky.iter_mut().zip(above.sky.chunks_exact(parts)) {
                    *sky = [0, 1, 2].map(|c| above.iter().map(|part| part[c]).sum());
                }
                for (rows, sky) in rows.chunks_exact_mut(3 * self.stride).zip(sky) {
                    sky_rows(rows, self.stride, 0..self.pad, sky);
                    sky_rows(rows, self.stride, self.pad + self.rows..self.stride, sky);
                }
            }
        }
    }

    /// Returns the number of rows before those of the grid.
    pub fn pad(&self) -> usize {
        self.pad
    }

    /// Returns the light of a cone at the plane that [`Self::merge_down`] made last.
    #[inline(always)]
    pub fn cone(&self, cone: usize) -> ConeLight<'_> {
        self.levels[self.shown].cone(cone, self.stride)
    }

    /// Makes the light of the first level at a plane whose intervals were just made. Planes come in
    /// descending order.
    pub fn merge_down(&mut self, unit: Level, intervals: &IntervalLevels, plane: usize) {
        // Of even index it is a plane of the level above, which has the same cones.
        self.shown = usize::from(plane.is_multiple_of(2));
        // A plane is made from the next one of the level above that is not before it.
        let mut missing = self.shown;
        while self.levels[missing].plane != self.required(missing, plane) {
            missing += 1;
        }
        for at in (self.shown..missing).rev() {
            let plane = plane.div_ceil(1 << at);
            match intervals.channels() {
                1 => dispatch_wide!(unit, simd => self.merge::<_, 1>(simd, intervals, at, plane)),
                _ => dispatch_wide!(unit, simd => self.merge::<_, 3>(simd, intervals, at, plane)),
            }
        }
    }

    /// Returns the plane of a level that light passes on its way to one of the first; none if it comes
    /// from the sky.
    fn required(&self, at: usize, plane: usize) -> Option<usize> {
        let plane = plane.div_ceil(1 << at);
        (plane < planes(self.depth, self.first + at as u32)).then_some(plane)
    }

    /// Makes a plane of a level from the one that the level above holds.
    #[inline(always)]
    fn merge<S: Simd, const K: usize>(
        &mut self,
        simd: S,
        intervals: &IntervalLevels,
        at: usize,
        plane: usize,
    ) {
        let level = self.first + at as u32;
        let (stride, pad, count) = (self.stride, self.pad, self.rows);
        let [made, above, ..] = &mut self.levels[at..] else { return };
        made.plane = Some(plane);
        let PlaneLight { rows, sky, .. } = made;
        let parts = above.sky.len() / sky.len();
        let end = count.next_multiple_of(LANES);
        for (cone, (rows, sky)) in rows.chunks_exact_mut(3 * stride).zip(sky).enumerate() {
            if plane.is_multiple_of(2) {
                let (first, last) = (parts * cone, parts * cone + parts - 1);
                if above.plane.is_some() {
                    let (first, last) = (above.rows(first, stride), above.rows(last, stride));
                    for at in [pad, stride + pad, 2 * stride + pad] {
                        let (first, last) = (&first[at..][..end], &last[at..][..end]);
                        let to = &mut rows[at..][..end];
                        for y in (0..end).step_by(LANES) {
                            let first = f32x16::from_slice(simd, &first[y..][..LANES]);
                            let last = f32x16::from_slice(simd, &last[y..][..LANES]);
                            (first + last).store_slice(&mut to[y..][..LANES]);
                        }
                    }
                } else {
                    sky_rows(rows, stride, pad..pad + end, sky);
                }
            } else {
                let (ray, part, weights) = match parts {
                    1 if cone.is_multiple_of(2) => (cone / 2, [cone; 2], [0.75, 0.25]),
                    1 => (cone / 2, [cone; 2], [0.25, 0.75]),
                    _ => (cone, [2 * cone, 2 * cone + 1], [1.0; 2]),
                };
                let mut paths = [MergePath::default(); 2];
                for (i, path) in paths.iter_mut().enumerate() {
                    *path = MergePath {
                        near: intervals.ray(level, ray + i),
                        rise: (ray + i) as isize - (1 << level),
                        angle: above.angles[part[i]] * weights[i],
                        weight: weights[i],
                        far: above.rows(part[i], stride),
                        sky: above.sky[part[i]],
                    };
                }
                // Rows from which both paths end on held rows, pads included.
                let mut range = 0..0;
                if above.plane.is_some() {
                    let last = (stride - LANES) as isize - pad as isize;
                    let from = (-(pad as isize) - paths[0].rise).clamp(0, end as isize) as usize;
                    range.start = from.next_multiple_of(LANES);
                    let to = (last - paths[1].rise).clamp(0, end as isize) as usize;
                    range.end = (to / LANES * LANES).max(range.start);
                }
                let layout = RowLayout { interval_stride: intervals.stride, stride, pad };
                add_paths::<S, K, true>(simd, &paths, rows, layout, range.clone());
                for range in [0..range.start, range.end..end] {
                    add_paths::<S, K, false>(simd, &paths, rows, layout, range);
                }
            }
            // Whole vectors reach past the last row.
            sky_rows(rows, stride, pad + count..(pad + count + LANES).min(stride), sky);
        }
    }
}

/// One of the paths of light from the next plane.
#[derive(Clone, Copy, Default)]
struct MergePath<'a> {
    /// Intervals of the ray from the start.
    near: &'a [u32],
    /// Rows from the start of that ray to its end.
    rise: isize,
    /// The angle that it stands for, and its weight.
    angle: f32,
    weight: f32,
    /// Light at its end by channel and row, and beyond all rows.
    far: &'a [f32],
    sky: Rgb,
}

/// The layout of stored rows.
#[derive(Clone, Copy)]
struct RowLayout {
    /// From one word of an interval to the next.
    interval_stride: usize,
    /// From one channel of light to the next.
    stride: usize,
    pad: usize,
}

/// Stores the sum of two paths for some rows, in whole vectors. `HELD`: whether they end on held rows.
#[inline(always)]
fn add_paths<S: Simd, const K: usize, const HELD: bool>(
    simd: S,
    paths: &[MergePath; 2],
    rows: &mut [f32],
    layout: RowLayout,
    range: Range<usize>,
) {
    let RowLayout { interval_stride, stride, pad } = layout;
    let count = range.len() / LANES;
    if count == 0 {
        return;
    }
    let (mut near, mut far) = ([[&[][..]; 3]; 2], [[&[][..]; 3]; 2]);
    for (p, path) in paths.iter().enumerate() {
        let end = (pad + range.start).wrapping_add_signed(path.rise);
        for i in 0..3 {
            let word = i.min(words(K) - 1);
            near[p][i] = vectors(path.near, word * interval_stride + PAD + range.start, count);
            if HELD {
                far[p][i] = vectors(path.far, i * stride + end, count);
            }
        }
    }
    let (red, rows) = rows.split_at_mut(stride);
    let (green, blue) = rows.split_at_mut(stride);
    let at = pad + range.start;
    let to =
        [vectors_mut(red, at, count), vectors_mut(green, at, count), vectors_mut(blue, at, count)];
    for i in 0..count {
        let mut sum = [f32x16::splat(simd, 0.0); 3];
        for (p, path) in paths.iter().enumerate() {
            let near = RowIntervals::<S, K>::unpack([
                u32x16::from_slice(simd, &near[p][0][i]),
                u32x16::from_slice(simd, &near[p][1][i]),
                u32x16::from_slice(simd, &near[p][2][i]),
            ]);
            for c in 0..3 {
                let far = if HELD {
                    f32x16::from_slice(simd, &far[p][c][i])
                } else {
                    f32x16::splat(simd, path.sky[c])
                };
                sum[c] = near.light[c].mul_add(path.angle, sum[c]);
                sum[c] = (near.transmittance[c % K] * path.weight).mul_add(far, sum[c]);
            }
        }
        for c in 0..3 {
            sum[c].store_slice(&mut to[c][i]);
        }
    }
}

/// Returns `count` vectors of a row.
#[inline(always)]
fn vectors<T>(row: &[T], at: usize, count: usize) -> &[[T; LANES]] {
    &row[at..].as_chunks().0[..count]
}

/// Like [`vectors`].
#[inline(always)]
fn vectors_mut<T>(row: &mut [T], at: usize, count: usize) -> &mut [[T; LANES]] {
    &mut row[at..].as_chunks_mut().0[..count]
}

/// Fills some rows of a cone with the light of the sky.
#[inline(always)]
fn sky_rows(rows: &mut [f32], stride: usize, range: Range<usize>, sky: &Rgb) {
    for (rows, sky) in rows.chunks_exact_mut(stride).zip(sky) {
        rows[range.clone()].fill(*sky);
    }
}
