//! Light by cones, merged down from the far end of the grid.
//!
//! `R_n(p, i)` is the light that reaches p through cone i of level n, between the rays i and i + 1:
//! an integral of radiance over the angle `A_n(i)`. Level by level, down from the sky (Freeman,
//! Sannikov and Margel 2025), with s ∈ {0, 1}, j = 2i + s, k = i + s:
//!
//! * planes of odd index: `R_n(p, i) = Σ_s A_{n+1}(j)·r(T_n(p, k)) + t(T_n(p, k))·R_{n+1}(p + v_n(k), j)`;
//! * planes of even index are planes of the level above: `R_n(p, i) = Σ_s R_{n+1}(p, j)`, exactly.
//!   (The paper takes the mean of this and of a way over the next plane, which blurs.)
//!
//! The first level m, which pixels look at, has cones half as wide, those of the level above: else
//! the light of a whole cone would be taken from one place of the plane, and far edges would jump
//! by the spread of a cone over the last hop. There
//! `R_m(p, j) = Σ_κ w_κ [A_{m+1}(j)·r(T_m(p, κ)) + t(T_m(p, κ))·R_{m+1}(p + v_m(κ), j)]`, κ the two
//! rays on both sides of cone j and w ¾ and ¼, as its middle lies at a quarter between them.
//!
//! Pixels are lit from the far end to the near one, so one plane a level is held at any time.

use super::interval::{Interval, LANES, PAD, words};
use super::march::{Light, TILE, VECTORS, mask, of_vector};
use super::pyramid::{Pyramid, planes};
use crate::Rgb;
use fearless_simd::{f32x16, prelude::*, u32x16};
use std::ops::Range;

/// Slope of the lower edge of a cone of a level.
pub fn slope(level: u32, cone: usize) -> f64 {
    cone as f64 / f64::from(1u32 << level) - 1.0
}

/// Angle of a cone of a level.
pub fn angle(level: u32, cone: usize) -> f64 {
    slope(level, cone + 1).atan() - slope(level, cone).atan()
}

/// One plane of a level.
#[derive(Debug, Default)]
struct Level {
    /// Cone by cone, channel by channel, all rows.
    rows: Vec<f32>,
    /// Which plane it holds; none: the sky.
    plane: Option<usize>,
    /// Light of the sky by cone.
    sky: Vec<Rgb>,
    angles: Vec<f32>,
}

impl Level {
    /// Light of a cone at the plane that it holds.
    #[inline(always)]
    fn far(&self, cone: usize, stride: usize) -> Far<'_> {
        match self.plane {
            Some(_) => {
                let (red, rest) = self.rows(cone, stride).split_at(stride);
                let (green, blue) = rest.split_at(stride);
                Far::Rows([red, green, blue])
            }
            None => Far::Sky(self.sky[cone]),
        }
    }

    /// All rows of a cone, channel by channel; none in the sky.
    #[inline(always)]
    fn rows(&self, cone: usize, stride: usize) -> &[f32] {
        let size = 3 * stride;
        if self.rows.is_empty() { &[] } else { &self.rows[cone * size..][..size] }
    }
}

/// The held planes.
#[derive(Debug, Default)]
pub struct Cones {
    depth: usize,
    rows: usize,
    first: u32,
    /// Rows of sky at both ends of a row.
    pad: usize,
    stride: usize,
    /// From the first on; the last is the sky.
    levels: Vec<Level>,
    /// The level that pixels look at: the first, or the second.
    shown: usize,
}

/// Light of a cone at the rows of a plane.
#[derive(Clone, Copy)]
pub enum Far<'a> {
    /// Row by row, by channel.
    Rows([&'a [f32]; 3]),
    /// The same everywhere.
    Sky(Rgb),
}

impl Far<'_> {
    /// Sixteen rows from `at` on, counted with the pad.
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

    /// Adds shares of the light of a tile of rows from `at` on, and of those one row on, in the
    /// vectors of which `lit` has bits.
    #[inline(always)]
    pub fn add<S: Simd>(
        &self,
        simd: S,
        at: usize,
        shares: &[f32; 2],
        lit: u64,
        light: &mut Light<S>,
    ) {
        for v in 0..VECTORS {
            if !of_vector(lit, v * LANES) {
                continue;
            }
            let near = self.load(simd, at + v * LANES);
            let next = self.load(simd, at + v * LANES + 1);
            for c in 0..3 {
                light[c][v] = near[c].mul_add(shares[0], light[c][v]);
                light[c][v] = next[c].mul_add(shares[1], light[c][v]);
            }
        }
    }

    /// The same where rows are open: `open` has bits for the one row and for the other. Where only
    /// one of them is, it counts for both; all of it counts a `share`.
    #[inline(always)]
    pub fn add_where<S: Simd>(
        &self,
        simd: S,
        at: usize,
        shares: &[f32; 2],
        open: [u64; 2],
        share: f32,
        light: &mut Light<S>,
    ) {
        let both = open[0] & open[1];
        for v in 0..VECTORS {
            if !of_vector(open[0] | open[1], v * LANES) {
                continue;
            }
            for (i, &part) in shares.iter().enumerate() {
                let part = mask(simd, both, v)
                    .select(f32x16::splat(simd, part * share), f32x16::splat(simd, share));
                let part = mask(simd, open[i], v).select(part, f32x16::splat(simd, 0.0));
                let row = self.load(simd, at + v * LANES + i);
                for c in 0..3 {
                    light[c][v] = row[c].mul_add(part, light[c][v]);
                }
            }
        }
    }
}

impl Cones {
    /// Makes room above level `first`, for rays of a last hop that stray up to `reach` rows.
    pub fn prepare(&mut self, depth: usize, rows: usize, pyramid: &Pyramid, reach: usize) {
        let pad = TILE + (reach + 1).next_multiple_of(LANES);
        let now = (depth, rows, pyramid.first, pad);
        if now == (self.depth, self.rows, self.first, self.pad) {
            return;
        }
        (self.depth, self.rows, self.first, self.pad) = now;
        self.stride = rows.next_multiple_of(LANES) + 2 * pad;
        self.levels.clear();
        for level in self.first..=pyramid.end {
            let width = if level == self.first { level + 1 } else { level };
            let cones = 2 << width;
            // The topmost is the sky, which has no rows.
            let held = if level < pyramid.end { cones * 3 * self.stride } else { 0 };
            self.levels.push(Level {
                rows: vec![0.0; held],
                plane: None,
                sky: vec![[0.0; 3]; cones],
                angles: (0..cones).map(|cone| angle(width, cone) as f32).collect(),
            });
        }
    }

    /// Begins at the far end, under the sky whose radiance from an angle (0 straight ahead) is
    /// given.
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
            let Some(Level { rows, plane, sky, .. }) = below.last_mut() else { return };
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

    /// Rows before those of the grid.
    pub fn pad(&self) -> usize {
        self.pad
    }

    /// Light of a cone at the plane last made by [`Self::descend`].
    #[inline(always)]
    pub fn at(&self, cone: usize) -> Far<'_> {
        self.levels[self.shown].far(cone, self.stride)
    }

    /// Makes the light of the first level at a plane whose intervals were just made; planes come in
    /// falling order.
    #[inline(always)]
    pub fn descend<S: Simd, const K: usize>(&mut self, simd: S, pyramid: &Pyramid, plane: usize) {
        // Of even index it is a plane of the level above, which has the same cones.
        self.shown = usize::from(plane.is_multiple_of(2));
        // A plane is made from the next one of the level above that is not before it.
        let mut missing = self.shown;
        while self.levels[missing].plane != self.wanted(missing, plane) {
            missing += 1;
        }
        for at in (self.shown..missing).rev() {
            self.merge::<S, K>(simd, pyramid, at, plane.div_ceil(1 << at));
        }
    }

    /// The plane of a level that light comes through on its way to one of the first; none: it comes
    /// from the sky.
    #[inline(always)]
    fn wanted(&self, at: usize, plane: usize) -> Option<usize> {
        let plane = plane.div_ceil(1 << at);
        (plane < planes(self.depth, self.first + at as u32)).then_some(plane)
    }

    /// Makes a plane of a level from the one that the level above holds.
    #[inline(always)]
    fn merge<S: Simd, const K: usize>(
        &mut self,
        simd: S,
        pyramid: &Pyramid,
        at: usize,
        plane: usize,
    ) {
        let level = self.first + at as u32;
        let (stride, pad, count) = (self.stride, self.pad, self.rows);
        let [made, above, ..] = &mut self.levels[at..] else { return };
        made.plane = Some(plane);
        let Level { rows, sky, .. } = made;
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
                let (ray, part, shares) = match parts {
                    1 if cone.is_multiple_of(2) => (cone / 2, [cone; 2], [0.75, 0.25]),
                    1 => (cone / 2, [cone; 2], [0.25, 0.75]),
                    _ => (cone, [2 * cone, 2 * cone + 1], [1.0; 2]),
                };
                let mut ways = [Way::default(); 2];
                for (i, way) in ways.iter_mut().enumerate() {
                    *way = Way {
                        near: pyramid.ray(level, ray + i),
                        shift: (ray + i) as isize - (1 << level),
                        angle: above.angles[part[i]] * shares[i],
                        share: shares[i],
                        far: above.rows(part[i], stride),
                        sky: above.sky[part[i]],
                    };
                }
                // Rows from which both ways end on held rows, pads and all.
                let mut range = 0..0;
                if above.plane.is_some() {
                    let room = (stride - LANES) as isize - pad as isize;
                    let from = (-(pad as isize) - ways[0].shift).clamp(0, end as isize) as usize;
                    range.start = from.next_multiple_of(LANES);
                    let to = (room - ways[1].shift).clamp(0, end as isize) as usize;
                    range.end = (to / LANES * LANES).max(range.start);
                }
                let strides = [pyramid.stride, stride, pad];
                add_up::<S, K, true>(simd, &ways, rows, strides, range.clone());
                add_up::<S, K, false>(simd, &ways, rows, strides, 0..range.start);
                add_up::<S, K, false>(simd, &ways, rows, strides, range.end..end);
            }
            // Where whole vectors ran over the last row.
            sky_rows(rows, stride, pad + count..(pad + count + LANES).min(stride), sky);
        }
    }
}

/// One of the ways that light takes from the next plane.
#[derive(Clone, Copy, Default)]
struct Way<'a> {
    /// The ray from the start.
    near: &'a [u32],
    /// Rows from the start of the near ray to its end.
    shift: isize,
    /// Angle that it stands for, and share of it.
    angle: f32,
    share: f32,
    /// Light at the end by channel and row, and beyond all rows.
    far: &'a [f32],
    sky: Rgb,
}

/// Adds up two ways at some rows, in whole vectors; `HELD`: whether they end on held rows.
#[inline(always)]
fn add_up<S: Simd, const K: usize, const HELD: bool>(
    simd: S,
    ways: &[Way; 2],
    rows: &mut [f32],
    [near_stride, stride, pad]: [usize; 3],
    range: Range<usize>,
) {
    let count = range.len() / LANES;
    if count == 0 {
        return;
    }
    let (mut near, mut far) = ([[&[][..]; 3]; 2], [[&[][..]; 3]; 2]);
    for (w, way) in ways.iter().enumerate() {
        let end = (pad + range.start).wrapping_add_signed(way.shift);
        for i in 0..3 {
            let word = i.min(words(K) - 1);
            near[w][i] = vectors(way.near, word * near_stride + PAD + range.start, count);
            if HELD {
                far[w][i] = vectors(way.far, i * stride + end, count);
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
        for (w, way) in ways.iter().enumerate() {
            let near = Interval::<S, K>::unpack([
                u32x16::from_slice(simd, &near[w][0][i]),
                u32x16::from_slice(simd, &near[w][1][i]),
                u32x16::from_slice(simd, &near[w][2][i]),
            ]);
            for c in 0..3 {
                let far = match HELD {
                    true => f32x16::from_slice(simd, &far[w][c][i]),
                    false => f32x16::splat(simd, way.sky[c]),
                };
                sum[c] = near.light[c].mul_add(way.angle, sum[c]);
                sum[c] = (near.through[c % K] * way.share).mul_add(far, sum[c]);
            }
        }
        for c in 0..3 {
            sum[c].store_slice(&mut to[c][i]);
        }
    }
}

/// Some vectors of a row.
#[inline(always)]
fn vectors<T>(row: &[T], at: usize, count: usize) -> &[[T; LANES]] {
    &row[at..].as_chunks().0[..count]
}

#[inline(always)]
fn vectors_mut<T>(row: &mut [T], at: usize, count: usize) -> &mut [[T; LANES]] {
    &mut row[at..].as_chunks_mut().0[..count]
}

/// Puts the sky of a cone into some of its rows.
#[inline(always)]
fn sky_rows(rows: &mut [f32], stride: usize, range: Range<usize>, sky: &Rgb) {
    for (rows, sky) in rows.chunks_exact_mut(stride).zip(sky) {
        rows[range.clone()].fill(*sky);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cones_of_a_level_fill_the_quadrant() {
        for level in 0..10 {
            let sum: f64 = (0..2 << level).map(|cone| angle(level, cone)).sum();
            assert!((sum - std::f64::consts::FRAC_PI_2).abs() < 1e-12, "level {level}: {sum}");
        }
    }
}
