//! Intervals level by level, each twice as long as those of the level before.
//!
//! The rays of the first level are traced ([`super::trace`]), each as a bundle: the mean of parallel
//! rays, spread over the px across it. The others are composed of two of the level before (Freeman,
//! Sannikov and Margel 2025): `T_{n+1}(p, 2k) = T_n(p, k) ⊕ T_n(p + v_n(k), k)`, and the rays between
//! are the mean of two bent paths, `T_n(p, k) ⊕ T_n(p + v_n(k), k+1)` and
//! `T_n(p, k+1) ⊕ T_n(p + v_n(k+1), k)`.
//!
//! So odd rays see a small light half a point wider than even ones, which shows as ripple around it. From intervals of
//! 16 px on, even rays are as wide: ¾ of the straight path and ⅛ of each of two bent ones, over the rays
//! k − 1 and k + 1. Those at the edges of the quadrant, which have one neighbour, stay straight, and so do those
//! along the borders of the grid: bent ones would leave it and come back, around walls that end there.
//!
//! Everything is made plane by plane from the far end of the grid to the near one, in the direction
//! of the light, so that [`super::merge`] uses each interval as soon as it exists. Merging reads planes
//! of odd index only, so each level holds no more than the odd plane made last and the even one in
//! front of it, from which the level above is made. Memory is about that of four planes of the topmost
//! level, and the lower levels never leave the caches. (The paper makes all levels first and keeps
//! them: N² log N intervals.)

use super::interval::{LANES, PAD, RowIntervals, empty, words};
use super::lattice::{GatherGeometry, bent, bundle, levels, planes, points, rays};
use super::prefilter::Prefilter;
use super::row_bits::{TILE, bit, mask};
use super::slabs::Slabs;
use super::trace::{BundleRays, BundleSet, CellBits, TracedPlane, trace_tile};
use crate::simd::dispatch_wide;
use fearless_simd::{Level, prelude::*};

/// The dimensions for which the buffers are allocated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Extent {
    depth: usize,
    rows: usize,
    channels: usize,
}

/// The intervals that are held.
#[derive(Debug, Default)]
pub struct IntervalLevels {
    /// The level that is traced, and the first that is not made.
    pub first: u32,
    pub end: u32,
    /// Points of the lattice lie `2^spacing_level` px apart, along both axes.
    spacing_level: u32,
    /// In points of the lattice.
    extent: Extent,
    /// From one word to the next in a row of intervals.
    pub stride: usize,
    /// The bundles of the first level, for slabs in order and in reverse; level, width and stride that
    /// they were made for.
    bundles: [BundleSet; 2],
    bundles_for: ([u32; 2], u32, isize),
    /// The cells that the bundles of a tile cross.
    cells: Vec<CellBits>,
    prefilter: Prefilter,
    /// By level, the plane of odd index made last, and that of even index.
    odd: Vec<Vec<u32>>,
    even: Vec<Vec<u32>>,
}

impl IntervalLevels {
    /// Allocates the intervals of a grid, from the level whose planes pixels gather from.
    pub fn prepare(&mut self, slabs: &Slabs, geometry: GatherGeometry) {
        let GatherGeometry { spacing_level, .. } = geometry;
        let first = geometry.first();
        let [depth, rows] = [slabs.depth, slabs.rows].map(|side| points(side, spacing_level));
        let end = levels(depth, first);
        let extent = Extent { depth, rows, channels: slabs.channels };
        if (self.first, self.end, self.spacing_level, self.extent)
            == (first, end, spacing_level, extent)
        {
            return;
        }
        (self.first, self.end, self.spacing_level, self.extent) =
            (first, end, spacing_level, extent);
        self.stride = rows.next_multiple_of(LANES) + 2 * PAD;
        let count = (end - first) as usize;
        self.odd.resize_with(count, Vec::new);
        self.even.resize_with(count, Vec::new);
        let (stride, empty) = (self.stride, empty(extent.channels));
        for level in first..end {
            let (size, at) = (self.plane_size(level), (level - first) as usize);
            let planes = planes(depth, level);
            fill(&mut self.odd[at], if planes > 1 { size } else { 0 }, stride, empty);
            fill(&mut self.even[at], if planes > 2 { size } else { 0 }, stride, empty);
        }
    }

    /// Returns the number of channels of transmittance.
    pub fn channels(&self) -> usize {
        self.extent.channels
    }

    /// Returns the number of words of one ray of a plane: all rows.
    #[inline(always)]
    fn ray_size(&self) -> usize {
        words(self.extent.channels) * self.stride
    }

    fn plane_size(&self, level: u32) -> usize {
        rays(level) * self.ray_size()
    }

    /// Returns a ray of the plane of odd index of a level that [`Self::make`] made last.
    #[inline(always)]
    pub fn ray(&self, level: u32, ray: usize) -> &[u32] {
        let size = self.ray_size();
        &self.odd[(level - self.first) as usize][ray * size..][..size]
    }

    /// Returns a ray of the plane of a level that [`Self::make`] made last.
    pub fn ray_of_plane(&self, level: u32, plane: usize, ray: usize) -> &[u32] {
        if !plane.is_multiple_of(2) {
            return self.ray(level, ray);
        }
        let size = self.ray_size();
        &self.even[(level - self.first) as usize][ray * size..][..size]
    }

    /// Prepares the bundles, each of `width` rays, for both orders of the slabs.
    pub fn prepare_bundles(&mut self, slabs: &Slabs, width: u32) {
        let (level, stride) = ([self.first, self.spacing_level], slabs.stride as isize);
        if self.bundles_for != (level, width, stride) {
            self.bundles_for = (level, width, stride);
            // The rows of cells that share a point share the rays of its bundles.
            let width = width.div_ceil(1 << self.spacing_level);
            let rays_of =
                |ray| BundleRays { footprints: bundle(level, ray, width), others: Vec::new() };
            let bundles: Vec<_> = (0..rays(self.first)).map(rays_of).collect();
            self.bundles = [stride, -stride].map(|stride| BundleSet::new(&bundles, stride));
            self.cells.resize(self.bundles[0].cells.len(), CellBits::default());
        }
    }

    /// Makes the intervals of all levels that begin at a plane of the first. Planes come in descending
    /// order.
    pub fn make(&mut self, unit: Level, slabs: &Slabs, plane: usize) {
        match self.channels() {
            1 => dispatch_wide!(unit, simd => self.make_on::<_, 1>(simd, slabs, plane)),
            _ => dispatch_wide!(unit, simd => self.make_on::<_, 3>(simd, slabs, plane)),
        }
    }

    #[inline(always)]
    fn make_on<S: Simd, const K: usize>(&mut self, simd: S, slabs: &Slabs, plane: usize) {
        let made = if plane.is_multiple_of(2) { &mut self.even[0] } else { &mut self.odd[0] };
        let set = &self.bundles[slabs.reversed as usize];
        let ray_size = words(K) * self.stride;
        let (spacing_level, rows) = (self.spacing_level, self.extent.rows);
        let slab = plane << (self.first + spacing_level);
        let prefilter = &mut self.prefilter;
        let levels = [self.first, spacing_level];
        prefilter.begin(rows, levels);
        for row in (0..slabs.rows).step_by(TILE) {
            let small = prefilter.small_sources(row / (TILE << spacing_level));
            let to = TracedPlane { intervals: &mut *made, stride: self.stride, small, levels };
            trace_tile::<S, K>(simd, slabs, [slab, row], set, &mut self.cells, to);
        }
        prefilter.filter::<S, K>(simd, slabs, slab, made, self.stride);
        for to in made.chunks_exact_mut(ray_size) {
            empty_tail::<K>(to, self.stride, rows);
        }
        let (mut level, mut plane) = (self.first, plane);
        while plane.is_multiple_of(2) {
            self.extend::<S, K>(simd, level, plane);
            (level, plane) = (level + 1, plane / 2);
        }
    }

    /// Makes a plane of the level above from the plane of even index that begins there and the
    /// one behind it.
    #[inline(always)]
    fn extend<S: Simd, const K: usize>(&mut self, simd: S, level: u32, plane: usize) {
        let at = (level - self.first) as usize;
        let ray_size = self.ray_size();
        let (stride, rows) = (self.stride, self.extent.rows);
        let whole = plane + 1 < planes(self.extent.depth, level);
        let [odd, odd_above] = &mut self.odd[at..at + 2] else { return };
        let [even, even_above] = &mut self.even[at..at + 2] else { return };
        let to = if (plane / 2).is_multiple_of(2) { even_above } else { odd_above };
        let far = if whole { &odd[..] } else { &[] };
        let planes =
            PlanePair::<S, K> { simd, near: even, far, stride, ray_size, round: stride - 2 * PAD };
        for (made, to) in to.chunks_exact_mut(ray_size).enumerate() {
            let ray = made / 2;
            let rise = ray as isize - (1 << level);
            if made % 2 == 1 {
                for y in (0..rows).step_by(LANES) {
                    let one = planes.compose(y, [ray, ray + 1], rise);
                    let other = planes.compose(y, [ray + 1, ray], rise + 1);
                    one.mean(other).store(to, stride, PAD + y);
                }
            } else if level < bent(self.spacing_level) || ray == 0 || ray + 1 == rays(level) {
                for y in (0..rows).step_by(LANES) {
                    planes.compose(y, [ray, ray], rise).store(to, stride, PAD + y);
                }
            } else {
                for y in (0..rows).step_by(LANES) {
                    let straight = planes.compose(y, [ray, ray], rise);
                    let one = planes.compose(y, [ray - 1, ray + 1], rise - 1);
                    let other = planes.compose(y, [ray + 1, ray - 1], rise + 1);
                    let mut made = straight.mean(straight.mean(one.mean(other)));
                    if rise == 0 {
                        let at_border = bit(-(y as isize)) | bit(rows as isize - 1 - y as isize);
                        made = made.or(straight, mask(simd, at_border, 0));
                    }
                    made.store(to, stride, PAD + y);
                }
            }
            empty_tail::<K>(to, stride, rows);
        }
    }
}

/// Sizes the buffer of a plane and fills it, margins included, with empty intervals.
fn fill(buffer: &mut Vec<u32>, size: usize, stride: usize, empty: &[u32]) {
    buffer.clear();
    buffer.resize(size, 0);
    for (i, word) in buffer.chunks_exact_mut(stride).enumerate() {
        word.fill(empty[i % empty.len()]);
    }
}

/// Two consecutive planes of a level.
struct PlanePair<'a, S: Simd, const K: usize> {
    simd: S,
    near: &'a [u32],
    /// Nothing past the last plane.
    far: &'a [u32],
    stride: usize,
    ray_size: usize,
    /// Rows in whole vectors.
    round: usize,
}

impl<S: Simd, const K: usize> PlanePair<'_, S, K> {
    /// Returns the intervals of one ray of the first plane and then one of the second, from where the
    /// first ends `rise` rows on.
    #[inline(always)]
    fn compose(&self, y: usize, rays: [usize; 2], rise: isize) -> RowIntervals<S, K> {
        let [first, second] = rays;
        let near = &self.near[first * self.ray_size..][..self.ray_size];
        let near = RowIntervals::<S, K>::load(self.simd, near, self.stride, PAD + y);
        let from = y as isize + rise;
        if self.far.is_empty() || from < -(PAD as isize) || from > self.round as isize {
            return near;
        }
        let far = &self.far[second * self.ray_size..][..self.ray_size];
        near.then(RowIntervals::load(self.simd, far, self.stride, PAD.wrapping_add_signed(from)))
    }
}

/// Empties the rows that only complete a vector.
#[inline(always)]
fn empty_tail<const K: usize>(to: &mut [u32], stride: usize, rows: usize) {
    for (word, &empty) in to.chunks_exact_mut(stride).zip(empty(K)) {
        word[PAD + rows..].fill(empty);
    }
}

#[cfg(test)]
mod tests {
    use super::super::lattice::BUNDLE_WIDTH;
    use super::super::prefilter::exchanged;
    use super::super::slabs::Axis;
    use super::*;
    use crate::simd::dispatch;
    use crate::{Cells, Matter};

    /// Rays per bundle.
    const WIDTH: u32 = 4;
    /// 8 bits of light and 15 of transmittance, rounded at each of up to five levels.
    const ROUNDING: f64 = 0.012;

    /// Random solids, emissive media and tinted glass.
    fn cells(tint: bool) -> Cells {
        let mut cells = Cells::new(37, 21).unwrap();
        let seed = 5;
        println!("seed {seed}");
        let mut random = fastrand::Rng::with_seed(seed);
        for i in 0..cells.len() {
            let matter = match random.f32() {
                v if v < 0.05 => {
                    Matter { emission: [2.0, 1.0, 0.5], opacity: 1.0, ..Matter::EMPTY }
                }
                v if v < 0.2 => {
                    Matter { emission: [0.3; 3], opacity: random.f32(), ..Matter::EMPTY }
                }
                v if v < 0.25 && tint => Matter { tint: [0.9, 0.5, 0.1], ..Matter::EMPTY },
                _ => Matter::EMPTY,
            };
            cells.set_matter(i, matter);
        }
        cells
    }

    /// Radiance and transmittance of one channel.
    type Pair = (f64, f64);

    fn then(a: Pair, b: Pair) -> Pair {
        (a.0 + a.1 * b.0, a.1 * b.1)
    }

    fn mean(of: &[Pair]) -> Pair {
        let sum = of.iter().fold((0.0, 0.0), |s, v| (s.0 + v.0, s.1 + v.1));
        (sum.0 / of.len() as f64, sum.1 / of.len() as f64)
    }

    /// The interval of a ray by all the grid lines that it crosses, found at once and sorted.
    fn line(cells: &Cells, channel: usize, [x, y]: [f64; 2], length: f64, slope: f64) -> Pair {
        let mut at: Vec<f64> = (0..200)
            .flat_map(|i| [f64::from(i) - x, (f64::from(i) - 60.0 - y) / slope])
            .filter(|t| (0.0..length).contains(t))
            .chain([0.0, length])
            .collect();
        at.sort_by(f64::total_cmp);
        let mut passed = (0.0, 1.0);
        for pair in at.windows(2) {
            let t = 0.5 * (pair[0] + pair[1]);
            let cell = [(x + t).floor(), (y + slope * t).floor()];
            if cell[0] < 0.0 || cell[1] < 0.0 {
                continue;
            }
            let Some(matter) = cells.get(cell[0] as u32, cell[1] as u32) else { continue };
            let px = (pair[1] - pair[0]) * slope.hypot(1.0);
            let transmittance =
                ((1.0 - f64::from(matter.opacity)) * f64::from(matter.tint[channel])).powf(px);
            let light = (1.0 - transmittance) * f64::from(matter.emission[channel]);
            passed = then(passed, (light, transmittance));
        }
        passed
    }

    fn cell(cells: &Cells, [x, y]: [i64; 2]) -> Option<Matter> {
        if x < 0 || y < 0 { None } else { cells.get(x as u32, y as u32) }
    }

    /// Returns whether a bundle of level 1 may meet a small source.
    fn meets_small_source(cells: &Cells, [x, y]: [i64; 2], ray: i64) -> bool {
        let small = |at: [i64; 2]| {
            let Some(matter) = cell(cells, at) else { return false };
            let solid = |by: [i64; 2]| {
                cell(cells, [at[0] + by[0], at[1] + by[1]]).is_some_and(|m| m.opacity >= 1.0)
            };
            let mut around = (0..9).filter(|&i| i != 4).map(|i| [i % 3 - 1, i / 3 - 1]);
            let alone = !around.any(solid);
            let emits = |at| cell(cells, at).is_some_and(|m| m.emission != [0.0; 3]);
            // All cells in a row that emit with one.
            let row = |[x, y]: [i64; 2], along_x: bool| {
                let place = |i| if along_x { [i, y] } else { [x, i] };
                let own = if along_x { x } else { y };
                let first = (0..=own).rev().take_while(|&i| emits(place(i))).last();
                let end = (own..64).find(|&i| !emits(place(i)));
                let (first, end) = (first.unwrap_or(own), end.unwrap_or(64));
                (end - first <= 4).then(|| place((first + end - 1) / 2))
            };
            let is_thin = |x| row(at, x).is_some_and(|middle| row(middle, !x).is_some());
            matter.emission != [0.0; 3] && alone && is_thin(true) && is_thin(false)
        };
        bundle([1, 0], ray as usize, WIDTH)
            .iter()
            .flatten()
            .any(|crossing| small([x + crossing.slab as i64, y + crossing.row as i64]))
    }

    /// A traced bundle, with the light that it exchanges with its neighbours.
    fn filtered(cells: &Cells, channel: usize, at: [i64; 2], ray: i64) -> Pair {
        let inside = |y: i64| (0..i64::from(cells.height())).contains(&y);
        let open = |y: i64| cell(cells, [at[0], y]).is_some_and(|matter| matter.opacity < 1.0);
        let (own, small) =
            (traced(cells, channel, at, ray), |y| meets_small_source(cells, [at[0], y], ray));
        let slope = ray as f32 / 2.0 - 1.0;
        let [straight, diagonal] = exchanged(1);
        let part = straight + diagonal * slope * slope;
        let mut light = own.0;
        for y in [at[1] - 1, at[1] + 1].into_iter().filter(|&y| inside(y)) {
            if open(at[1]) && open(y) && (small(at[1]) || small(y)) {
                let other = traced(cells, channel, [at[0], y], ray);
                light += f64::from(part) * (other.0 - own.0);
            }
        }
        (light, own.1)
    }

    /// A bundle of level 1.
    fn traced(cells: &Cells, channel: usize, [x, y]: [i64; 2], ray: i64) -> Pair {
        let rays: Vec<Pair> = (0..WIDTH)
            .map(|i| BUNDLE_WIDTH * ((f64::from(i) + 0.5) / f64::from(WIDTH) - 0.5))
            .map(|across| [x as f64 + 0.5, y as f64 + 0.5 + across])
            .map(|from| line(cells, channel, from, 2.0, ray as f64 / 2.0 - 1.0))
            .collect();
        mean(&rays)
    }

    /// `T_level(p, ray)` by the mean over all bent paths that it stands for.
    fn brute(cells: &Cells, channel: usize, level: u32, [x, y]: [i64; 2], ray: i64) -> Pair {
        let outside = x >= i64::from(cells.width()) || !(0..i64::from(cells.height())).contains(&y);
        if level > 1 && outside {
            return (0.0, 1.0);
        }
        let length = 1i64 << level;
        if level == 1 {
            return if outside { (0.0, 1.0) } else { filtered(cells, channel, [x, y], ray) };
        }
        let half = length / 2;
        let path = |first: i64, second: i64| {
            let near = brute(cells, channel, level - 1, [x, y], first);
            let end = [x + half, y + first - half];
            then(near, brute(cells, channel, level - 1, end, second))
        };
        let k = ray / 2;
        let straight = path(k, k);
        if ray % 2 == 1 {
            mean(&[path(k, k + 1), path(k + 1, k)])
        } else if level <= bent(0)
            || k == 0
            || k == length
            || k == half && (y == 0 || y + 1 == i64::from(cells.height()))
        {
            straight
        } else {
            let bent = [path(k - 1, k + 1), path(k + 1, k - 1)];
            mean(&[straight, straight, straight, mean(&bent)])
        }
    }

    /// The largest difference between the intervals of `cells` and the paths through `compared`, over all odd
    /// planes from level 1 to 4 and some rays of level 5.
    fn worst<const K: usize>(cells: &Cells, compared: &Cells) -> f64 {
        let mut slabs = Slabs::default();
        slabs.read(cells, Axis::X, [4, 1], None);
        assert_eq!(slabs.channels, K);
        let mut levels = IntervalLevels::default();
        levels.prepare(&slabs, GatherGeometry { level: 1, ..GatherGeometry::default() });
        levels.prepare_bundles(&slabs, WIDTH);
        let mut worst = 0.0f64;
        for first in (1..planes(37, 1)).rev() {
            levels.make(Level::new(), &slabs, first);
            // The level at which the plane just made is of odd index.
            let level = 1 + first.trailing_zeros();
            for ray in (0..rays(level)).filter(|ray| level < 5 || level == 5 && ray % 4 == 0) {
                let words = levels.ray(level, ray);
                for row in (0..21).step_by(3) {
                    let (light, transmittance) = dispatch!(Level::new(), simd => {
                        let read =
                            RowIntervals::<_, K>::load(simd, words, levels.stride, PAD + row);
                        let transmittance = read.transmittance.map(|v| v.to_array()[0]);
                        (read.light.map(|v| v.to_array()[0]), transmittance)
                    });
                    for c in 0..3 {
                        let from = [(first << 1) as i64, row as i64];
                        let want = brute(compared, c, level, from, ray as i64);
                        worst = worst
                            .max((f64::from(light[c]) - want.0).abs() / (1.0 + want.0))
                            .max((f64::from(transmittance[c % K]) - want.1).abs());
                    }
                }
            }
        }
        worst
    }

    #[test]
    fn every_level_is_the_mean_over_the_paths_it_stands_for() {
        let (plain, tinted) = (cells(false), cells(true));
        let found = [worst::<1>(&plain, &plain), worst::<3>(&tinted, &tinted)];
        println!("{found:?}");
        assert!(found.iter().all(|&v| v < ROUNDING), "{found:?}");
        let mut other = plain.clone();
        other.set(20, 10, Matter { emission: [1.0; 3], opacity: 1.0, ..Matter::EMPTY });
        assert!(worst::<1>(&plain, &other) > ROUNDING, "one more cell is not noticed");
    }
}
