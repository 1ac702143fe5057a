//! Light through cones, merged down from the far end of the grid.
//!
//! `R_n(p, i)` is the light that reaches p through cone i of level n, whose middle lies between the rays
//! i and i + 1: an integral of radiance over the angle, weighted by a quadratic B-spline over slope, three
//! cones wide. So neighbouring cones overlap, and their weights add up to 1 for every direction. If cones
//! ended sharply, the light on both sides of an end would be taken from places of the next plane that lie
//! too far apart or too close, at every level, and a small light would be seen once too often or not at
//! all: bricks.
//!
//! A B-spline is the sum of narrower ones, `b_n,i = ¼·b_{n+1,2i−1} + ¾·b_{n+1,2i} + ¾·b_{n+1,2i+1} +
//! ¼·b_{n+1,2i+2}` (Chaikin 1974). Taken apart into two halves,
//! `H_n(p, j) = ¼·R_n(p, j − 1) + ½·R_n(p, j) + ¼·R_n(p, j + 1)`, each belongs to one ray. Level by level,
//! down from the sky (Freeman, Sannikov and Margel 2025, with their cones in place of our halves), with
//! s ∈ {0, 1}, j = 2i + s, k = i + s:
//!
//! * planes of odd index: `R_n(p, i) = Σ_s A_{n+1}(j)·r(T_n(p, k)) + t(T_n(p, k))·H_{n+1}(p + v_n(k), j)`,
//!   A the angle of the half cone, found like H;
//! * planes of even index are planes of the level above: `R_n(p, i) = Σ_s H_{n+1}(p, j)`, exactly.
//!   (The paper takes the mean of this and of a path over the next plane, which blurs.)
//!
//! On the whole, light of the direction of any half cone arrives, at every level, from the right place
//! with the same blur of about half a px.
//!
//! At the edges of the quadrant cones overlap with one cone beyond, which holds only light from within. The
//! rays beyond the edges are not made; the intervals of the rays at the edges stand for them.
//!
//! The first level m, which pixels gather from, has cones half as wide, those of the level above.
//! Otherwise the light of a whole cone would come from one place of the plane, and distant edges would
//! jump by the width of a cone across the final gather. There
//! `R_m(p, j) = Σ_κ w_κ [A_{m+1}(j)·r(T_m(p, κ)) + t(T_m(p, κ))·R_{m+1}(p + v_m(κ), j)]`, κ the two
//! rays on both sides of cone j and w ¾ and ¼, as its middle lies at a quarter between them.
//!
//! Pixels are lit from the far end to the near one, so one plane per level is held at any time.

use super::border::{BorderLight, Orientation};
use super::extend::IntervalLevels;
use super::fine_rows::FineRows;
use super::interval::{LANES, PAD, RowIntervals, words};
use super::lattice::{
    BEYOND, GatherGeometry, angles, cones, cones_of_halves, edges, halves, planes, points,
};
use super::row_bits::{TILE, VECTORS, any_in_vector, mask};
use super::slabs::Slabs;
use super::trace::TileLight;
use crate::simd::dispatch_wide;
use crate::{Inflow, Rgb};
use fearless_simd::{Level, f32x16, prelude::*, u32x16};
use std::ops::Range;

/// Added to the sum of the weights at a ray's end, each a transmittance times its share of the
/// interpolation: where both cells are opaque, no light comes from behind them, instead of 0 ÷ 0.
pub const WEIGHT_EPSILON: f32 = 1e-6;

/// The number of levels whose planes pixels may gather from.
const SHOWN: usize = 2;

/// Rows beside the end of a cone's middle that its pixels may read: the spline's, one for rays beside it, and one because
/// cones beyond the quadrant are steeper than what they see.
const BESIDE: usize = 3;

/// The light of one plane of a level.
#[derive(Debug, Default)]
struct PlaneLight {
    /// True if it is the light of half cones of the level below, otherwise that of cones.
    halves: bool,
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
    /// Points of the lattice along both sides, and the distance between them, as a power of two px.
    depth: usize,
    rows: usize,
    spacing_level: u32,
    first: u32,
    /// Slabs that the longest rays of pixels cross, or paths from a plane to the next of the second level.
    reach: usize,
    /// Rows of sky before and after those of the grid.
    pad: usize,
    stride: usize,
    /// From the first level on; the last is the sky.
    levels: Vec<PlaneLight>,
    /// The level that pixels gather from: the first, or the second.
    shown: usize,
    /// Light of the sky in the cones of the last level.
    sky: Vec<Rgb>,
    /// The light at the border of a grid with inflow, for either orientation; and which of these is in use, none under a
    /// plain sky.
    borders: [BorderLight; 2],
    entering: Option<usize>,
    /// One channel of the sky, on its way down.
    channel: Vec<f64>,
    /// The light of three consecutive cones, in turns.
    latest: [Vec<f32>; 3],
    /// The mean radiance at the ends of two consecutive paths, by the row of their start, where they end beyond the border.
    beyond: [Vec<f32>; 2],
    /// That of the plane that pixels gather from at the rows of cells, if points lie farther apart.
    fine: FineRows,
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

    /// Adds the weighted light at the rows before, at and after those of a tile from `at` on, in the
    /// vectors of which `lit` has bits. The weights add up to 1.
    #[inline(always)]
    pub fn add<S: Simd>(
        &self,
        simd: S,
        at: usize,
        weights: &[f32; 3],
        lit: u64,
        light: &mut TileLight<S>,
    ) {
        for c in 0..3 {
            match self {
                Self::Rows(rows) => {
                    let rows = &rows[c][at - 1..][..TILE + 2];
                    for v in 0..VECTORS {
                        if any_in_vector(lit, v * LANES) {
                            for (row, weight) in weights.iter().enumerate() {
                                let row =
                                    f32x16::from_slice(simd, &rows[v * LANES + row..][..LANES]);
                                light[c][v] = row.mul_add(*weight, light[c][v]);
                            }
                        }
                    }
                }
                Self::Sky(sky) => {
                    for v in 0..VECTORS {
                        if any_in_vector(lit, v * LANES) {
                            light[c][v] += sky[c];
                        }
                    }
                }
            }
        }
    }

    /// Like [`Self::add`], for rows that are open only in part, `open` by row: the others do not count.
    /// The sum is scaled by `weight`.
    #[inline(always)]
    pub fn add_open<S: Simd>(
        &self,
        simd: S,
        at: usize,
        weights: &[f32; 3],
        open: [u64; 3],
        weight: f32,
        light: &mut TileLight<S>,
    ) {
        let zero = f32x16::splat(simd, 0.0);
        for v in 0..VECTORS {
            if !any_in_vector(open[0] | open[1] | open[2], v * LANES) {
                continue;
            }
            let mut norm = f32x16::splat(simd, WEIGHT_EPSILON);
            let mut sum = [zero; 3];
            for (i, &part) in weights.iter().enumerate() {
                let part = mask(simd, open[i], v).select(f32x16::splat(simd, part), zero);
                let row = self.load(simd, at + v * LANES + i - 1);
                for c in 0..3 {
                    sum[c] = row[c].mul_add(part, sum[c]);
                }
                norm += part;
            }
            let norm = f32x16::splat(simd, weight) / norm;
            for c in 0..3 {
                light[c][v] = sum[c].mul_add(norm, light[c][v]);
            }
        }
    }
}

impl MergedLight {
    /// Allocates the light of a grid.
    pub fn prepare(&mut self, slabs: &Slabs, intervals: &IntervalLevels, geometry: GatherGeometry) {
        let GatherGeometry { spacing_level, .. } = geometry;
        // Rays of the final gather rise by up to two rows more than their length; whole vectors leave room for these.
        let pad = TILE + (geometry.max_length() + 1).next_multiple_of(2 * LANES);
        self.reach = (geometry.max_length() >> spacing_level) + 1;
        let [depth, rows] = [slabs.depth, slabs.rows].map(|side| points(side, spacing_level));
        self.fine.prepare(slabs.rows, pad, spacing_level);
        let now = (depth, rows, spacing_level, intervals.first, pad);
        if now == (self.depth, self.rows, self.spacing_level, self.first, self.pad) {
            return;
        }
        (self.depth, self.rows, self.spacing_level, self.first, self.pad) = now;
        self.stride = rows.next_multiple_of(LANES) + 2 * pad;
        for rows in self.latest.iter_mut().chain(&mut self.beyond) {
            *rows = vec![0.0; 3 * self.stride];
        }
        self.sky = vec![[0.0; 3]; cones(intervals.end)];
        // What they hold is by level.
        self.borders = Default::default();
        self.levels.clear();
        for level in self.first..=intervals.end {
            let cones = cones(level.max(self.first + 1));
            self.levels.push(PlaneLight {
                halves: level > self.first + 1,
                sky: vec![[0.0; 3]; cones],
                ..PlaneLight::default()
            });
        }
        self.descend(&mut angles(intervals.end), |level, angles| {
            level.angles = angles.iter().map(|&angle| angle as f32).collect();
        });
        // The topmost is the sky, which has rows only where pixels may gather from it.
        let (held, stride) = ((self.levels.len() - 1).max(SHOWN), self.stride);
        for level in &mut self.levels[..held] {
            level.rows = vec![0.0; level.sky.len() * 3 * stride];
        }
    }

    /// Starts at the far end of a grid with inflow.
    pub fn begin_with_inflow(&mut self, inflow: &Inflow, orientation: Orientation) {
        let Self { levels, borders, entering, first, depth, rows, spacing_level, .. } = self;
        let cones = levels.iter().enumerate().map(|(at, level)| {
            let level_of_cones = (*first + at as u32).max(*first + 1);
            (level_of_cones, level.halves)
        });
        let index = usize::from(orientation.reversed);
        *entering = Some(index);
        borders[index].read(inflow, orientation, [*depth, *rows, 1 << *spacing_level], cones);
        for level in levels {
            level.plane = None;
        }
    }

    /// Starts at the far end of the grid. `sky` returns the mean radiance of the sky between two angles, 0
    /// straight ahead.
    pub fn begin(&mut self, sky: impl Fn([f64; 2]) -> Rgb) {
        let end = self.first + self.levels.len() as u32 - 1;
        let mut changed = false;
        for (cone, held) in self.sky.iter_mut().enumerate() {
            let [from, to] = edges(end, cone);
            // Those beyond the quadrant have no angle.
            let angle = (to - from) as f32;
            let light = if angle > 0.0 { sky([from, to]).map(|v| v * angle) } else { [0.0; 3] };
            changed |= std::mem::replace(held, light) != light;
        }
        for level in &mut self.levels {
            level.plane = None;
        }
        let had_border = self.entering.take().is_some();
        if had_border {
            self.borders = Default::default();
        }
        if !changed && !had_border {
            return;
        }
        let mut light = std::mem::take(&mut self.channel);
        for c in 0..3 {
            light.clear();
            light.extend(self.sky.iter().map(|sky| f64::from(sky[c])));
            self.descend(&mut light, |level, light| {
                for (sky, &light) in level.sky.iter_mut().zip(light) {
                    sky[c] = light as f32;
                }
            });
        }
        self.channel = light;
        let (stride, held) = (self.stride, self.pad..self.pad + self.rows);
        for PlaneLight { rows, sky, .. } in &mut self.levels {
            for (rows, sky) in rows.chunks_exact_mut(3 * stride).zip(sky) {
                sky_rows(rows, stride, 0..held.start, sky);
                sky_rows(rows, stride, held.end..stride, sky);
            }
        }
    }

    /// Calls `set` for each level, from the sky down, with what `of_sky` is in its cones or halves.
    fn descend(&mut self, of_sky: &mut Vec<f64>, mut set: impl FnMut(&mut PlaneLight, &[f64])) {
        for level in self.levels.iter_mut().rev() {
            if level.halves {
                halves(of_sky);
                set(level, of_sky);
                cones_of_halves(of_sky);
            } else {
                set(level, of_sky);
            }
        }
    }

    /// Returns the number of rows before those of the grid.
    pub fn pad(&self) -> usize {
        self.pad
    }

    /// Returns the light of a cone of the final gather at the plane that [`Self::merge_down`] made
    /// last.
    #[inline(always)]
    pub fn cone(&self, cone: usize) -> ConeLight<'_> {
        let shown = &self.levels[self.shown];
        if self.spacing_level > 0 && shown.plane.is_some() {
            ConeLight::Rows(self.fine.cone(cone))
        } else {
            shown.cone(cone, self.stride)
        }
    }

    /// Finds the light of the plane in a slab that [`Self::merge_down`] made last at the rows of cells.
    pub fn spread(&mut self, unit: Level, slabs: &Slabs, slab: usize) {
        let shown = &self.levels[self.shown];
        if self.spacing_level > 0 && shown.plane.is_some() {
            let Self { fine, stride, pad, .. } = self;
            dispatch_wide!(unit, simd => fine.read(simd, slabs, slab, &shown.rows, [*stride, *pad]));
        }
    }

    /// Makes the light of the first level at a plane whose intervals were just made. Planes come in
    /// descending order.
    pub fn merge_down(&mut self, unit: Level, intervals: &IntervalLevels, plane: usize) {
        // Of even index it is a plane of the level above, which has the same cones.
        self.shown = usize::from(plane.is_multiple_of(2));
        // A plane is made from the next one of the level above that is not before it.
        let mut missing = self.shown;
        while self.levels[missing].plane != self.required(missing, plane) {
            if missing < SHOWN && self.is_beyond(missing, plane) {
                self.enter(missing, plane.div_ceil(1 << missing));
                break;
            }
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
    /// from the sky, or from beyond the border and is read there.
    fn required(&self, at: usize, plane: usize) -> Option<usize> {
        let enters = self.entering.is_some() && at < SHOWN;
        let held = enters || !self.is_beyond(at, plane);
        held.then(|| plane.div_ceil(1 << at))
    }

    /// Returns whether the plane of a level that light passes on its way to one of the first lies behind the grid.
    fn is_beyond(&self, at: usize, plane: usize) -> bool {
        plane.div_ceil(1 << at) >= planes(self.depth, self.first + at as u32)
    }

    /// Makes a plane behind the grid that pixels gather from, of the light that enters.
    fn enter(&mut self, at: usize, plane: usize) {
        let Self { borders, entering, levels, stride, pad, first, .. } = self;
        let Some(index) = *entering else { return };
        let border = &borders[index];
        let made = &mut levels[at];
        made.plane = Some(plane);
        let slab = plane << (*first as usize + at);
        let all = -(*pad as isize)..(*stride - *pad) as isize;
        for (cone, rows) in made.rows.chunks_exact_mut(3 * *stride).enumerate() {
            let light = border.cone(at, cone, slab);
            light.store(all.clone(), rows, [*stride, *pad], &made.angles[cone..=cone]);
        }
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
        let (stride, pad) = (self.stride, self.pad);
        let layout = RowLayout { interval_stride: intervals.stride, stride, pad };
        let border = self.entering.map(|index| &self.borders[index]);
        let [made, above, ..] = &mut self.levels[at..] else { return };
        made.plane = Some(plane);
        let PlaneLight { halves, rows, sky, angles, .. } = made;
        let rounded = self.rows.next_multiple_of(LANES);
        let beyond = &mut self.beyond;
        let behind = border.map(|border| (border, at + 1));
        let merge = PlaneMerge { intervals, level, plane, above, behind, layout, rows: rounded };
        let count = sky.len();
        let size = 3 * stride;
        if *halves {
            // Two cones beyond each edge: the outer ones have no light.
            let [a, b, c] = &mut self.latest;
            let (mut before, mut own, mut after) = (a, b, c);
            before.fill(0.0);
            own.fill(0.0);
            for cone in 0..count {
                if cone + BEYOND / 2 < count - 1 {
                    merge.cone::<S, K>(simd, cone + 1, after, beyond);
                } else {
                    after.fill(0.0);
                }
                let to = &mut rows[cone * size..][..size];
                halve(simd, [before, own, after], to, layout, rounded);
                (before, own, after) = (own, after, before);
            }
        } else {
            let inner = 1..count - 1;
            for (cone, to) in inner.clone().zip(rows.chunks_exact_mut(size).skip(inner.start)) {
                merge.cone::<S, K>(simd, cone, to, beyond);
            }
        }
        if let Some(border) = border {
            let slab = plane << level;
            let end = self.rows as isize;
            // Pixels read the rows beside the ends of rays. Paths from the level below are half as long as rays, and steeper
            // than the middle of their half cone by less than a row.
            let (lengths, beside) =
                if at < SHOWN { ([0, self.reach], BESIDE) } else { ([(1 << level) / 2; 2], 1) };
            // Of two along a ray the first has an odd index.
            let shared = usize::from(border.is_shared(at));
            let (outermost, others) = rows.split_at_mut(shared * size);
            let along_rays =
                outermost.chunks_mut(size).chain(others.chunks_mut((1 + shared) * size));
            let mut cone = 0;
            for rows in along_rays {
                let beside = border.rows_beside(at, cone, lengths, beside, pad);
                let [before, after] = beside.map(|rows| rows as isize);
                let light = border.cone(at, cone, slab);
                for beside in [-before..0, end..end + after] {
                    light.store(beside, rows, [stride, pad], &angles[cone..]);
                }
                cone += rows.len() / size;
            }
            return;
        }
        for (rows, sky) in rows.chunks_exact_mut(size).zip(sky) {
            // Whole vectors reach past the last row.
            sky_rows(rows, stride, pad + self.rows..(pad + self.rows + LANES).min(stride), sky);
        }
    }
}

/// The merge of one plane of a level from one of the level above.
struct PlaneMerge<'a> {
    intervals: &'a IntervalLevels,
    level: u32,
    plane: usize,
    above: &'a PlaneLight,
    /// The light beyond the border, if it is not the sky's, and the index of the level above in it.
    behind: Option<(&'a BorderLight, usize)>,
    layout: RowLayout,
    /// Rows of the grid, in whole vectors.
    rows: usize,
}

impl PlaneMerge<'_> {
    /// Stores the light of a cone.
    #[inline(always)]
    fn cone<S: Simd, const K: usize>(
        &self,
        simd: S,
        cone: usize,
        to: &mut [f32],
        beyond: &mut [Vec<f32>; 2],
    ) {
        let Self { intervals, level, plane, above, behind, layout, rows } = *self;
        let RowLayout { stride, pad, .. } = layout;
        let number = cone as isize - BEYOND as isize;
        let (first_ray, parts, weights) = match (above.halves, number.rem_euclid(2)) {
            (true, _) => (number, [2 * cone - 2, 2 * cone - 1], [1.0; 2]),
            (false, 0) => (number.div_euclid(2), [cone; 2], [0.75, 0.25]),
            (false, _) => (number.div_euclid(2), [cone; 2], [0.25, 0.75]),
        };
        if plane.is_multiple_of(2) {
            let [one, other] = parts.map(|part| above.cone(part, stride));
            for y in (pad..pad + rows).step_by(LANES) {
                let [one, other] = [one.load(simd, y), other.load(simd, y)];
                for c in 0..3 {
                    (one[c] + other[c]).store_slice(&mut to[c * stride + y..][..LANES]);
                }
            }
            return;
        }
        let mut paths = [MergePath::default(); 2];
        for (i, path) in paths.iter_mut().enumerate() {
            let ray = (first_ray + i as isize).clamp(0, 2 << level);
            *path = MergePath {
                near: intervals.ray(level, ray as usize),
                rise: ray - (1 << level),
                angle: above.angles[parts[i]] * weights[i],
                weight: weights[i],
                far: above.rows(parts[i], stride),
                sky: above.sky[parts[i]],
                beyond: None,
            };
        }
        if let Some((border, at)) = behind {
            let mut missing = 0;
            if border.is_shared(at) && cone > 1 {
                // The first path is the second of the cone before.
                beyond.swap(0, 1);
                missing = 1;
            }
            for i in missing..2 {
                let light = border.cone(at, parts[i], (plane + 1) << level);
                let rise = paths[i].rise;
                // The cones before and after share it.
                let held = self.held([rise - 1, rise + 1]);
                for y in (0..held.start).chain(held.end..rows).step_by(LANES) {
                    let radiance = light.load(simd, y as isize + rise);
                    for (c, radiance) in radiance.into_iter().enumerate() {
                        radiance.store_slice(&mut beyond[i][c * stride + pad + y..][..LANES]);
                    }
                }
            }
            for (path, beyond) in paths.iter_mut().zip(&*beyond) {
                path.beyond = Some(beyond);
            }
        }
        let range = self.held(paths.map(|path| path.rise));
        add_paths::<S, K, true>(simd, &paths, to, layout, range.clone());
        for range in [0..range.start, range.end..rows] {
            add_paths::<S, K, false>(simd, &paths, to, layout, range);
        }
    }

    /// Returns the rows, in whole vectors, from which paths that rise by no less and no more than this end on held rows, pads
    /// included.
    fn held(&self, [least, most]: [isize; 2]) -> Range<usize> {
        if self.above.plane.is_none() {
            return 0..0;
        }
        let RowLayout { stride, pad, .. } = self.layout;
        let [first, last] = [-(pad as isize), (stride - LANES) as isize - pad as isize];
        let [from, to] =
            [first - least, last - most].map(|row| row.clamp(0, self.rows as isize) as usize);
        let start = from.next_multiple_of(LANES);
        start..(to / LANES * LANES).max(start)
    }
}

/// Stores the light of a half cone, from that of the cones before, at and after it.
#[inline(always)]
fn halve<S: Simd>(
    simd: S,
    [before, own, after]: [&[f32]; 3],
    to: &mut [f32],
    layout: RowLayout,
    rows: usize,
) {
    let count = rows / LANES;
    for channel in 0..3 {
        let at = channel * layout.stride + layout.pad;
        let [before, own, after] = [before, own, after].map(|rows| vectors(rows, at, count));
        for (i, to) in vectors_mut(to, at, count).iter_mut().enumerate() {
            let beside = f32x16::from_slice(simd, &before[i]) + f32x16::from_slice(simd, &after[i]);
            let own = f32x16::from_slice(simd, &own[i]);
            own.mul_add(0.5, beside * 0.25).store_slice(to);
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
    /// In place of the sky's, the mean radiance there by channel and row of the start.
    beyond: Option<&'a [f32]>,
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

/// The light at the ends of a path, by channel, and its weight.
#[derive(Clone, Copy)]
struct FarRows<'a> {
    light: [&'a [[f32; LANES]]; 3],
    weight: f32,
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
    let (mut near, mut far) = ([[&[][..]; 3]; 2], [None; 2]);
    for (p, path) in paths.iter().enumerate() {
        let start = pad + range.start;
        let (rows, at, weight) = match path.beyond {
            _ if HELD => (Some(path.far), start.wrapping_add_signed(path.rise), path.weight),
            beyond => (beyond, start, path.angle),
        };
        far[p] = rows.map(|rows| FarRows {
            light: [0, 1, 2].map(|c| vectors(rows, c * stride + at, count)),
            weight,
        });
        for i in 0..3 {
            let word = i.min(words(K) - 1);
            near[p][i] = vectors(path.near, word * interval_stride + PAD + range.start, count);
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
            let (far, weight) = match far[p] {
                Some(FarRows { light, weight }) => {
                    (light.map(|channel| f32x16::from_slice(simd, &channel[i])), weight)
                }
                None => (path.sky.map(|sky| f32x16::splat(simd, sky)), path.weight),
            };
            for c in 0..3 {
                sum[c] = near.light[c].mul_add(path.angle, sum[c]);
                sum[c] = (near.transmittance[c % K] * weight).mul_add(far[c], sum[c]);
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
