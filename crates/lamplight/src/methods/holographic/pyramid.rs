//! Level upon level of intervals, each twice as long as those before.
//!
//! Planes of level n lie 2ⁿ slabs apart; from each row of a plane rays `v_n(k) = (2ⁿ, k − 2ⁿ)`,
//! k = 0 … 2ⁿ⁺¹ ("dense" directions: the far ends are 1 px apart), lead to the next plane. The first
//! level is traced: each ray is a beam, the mean of parallel rays spread over the px across it.
//! The others are made from the level before (Freeman, Sannikov and Margel 2025):
//! `T_{n+1}(p, 2k) = T_n(p, k) ⊕ T_n(p + v_n(k), k)`, and the rays between are the mean of the two
//! bent ways, `T_n(p, k) ⊕ T_n(p + v_n(k), k+1)` and `T_n(p, k+1) ⊕ T_n(p + v_n(k+1), k)`.
//!
//! All is made plane by plane from the far end of the grid to the near one, which is the way that
//! light comes, so that [`super::cones`] uses each interval as soon as it is made: merging reads
//! planes of odd index only, and of each level no more is held than the odd plane made last and the
//! even one in front of it, from which the level above is made. Memory is about that of four planes
//! of the topmost level, and the lower levels never leave the caches. (The paper makes all levels
//! first and keeps them: N² log N intervals.)

use super::interval::{Interval, LANES, PAD, empty, words};
use super::march::{
    Met, TILE, VECTORS, march, march_solid, mask, meet, meet_solid, solid, whole_vectors,
};
use super::slabs::Slabs;
use super::stencil::{Bundle, Fan, Rays};
use super::ways::beam;
use fearless_simd::{f32x16, prelude::*};

/// The held intervals.
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
    /// The rays of the first level, ahead and, for reversed slabs, back; what they were made for.
    beams: [Fan; 2],
    made_for: (u32, u32, isize),
    /// Where the cells of a beam are solid.
    solid: Vec<[u64; 2]>,
    /// By level, the plane of odd index made last, and that of even index.
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
            self.fill(at, if planes > 1 { size } else { 0 }, |s| &mut s.odd);
            self.fill(at, if planes > 2 { size } else { 0 }, |s| &mut s.even);
        }
    }

    /// Sizes the buffer of a plane and fills it, margins and all, with empty intervals.
    fn fill(&mut self, at: usize, size: usize, buffer: impl Fn(&mut Self) -> &mut Vec<Vec<u32>>) {
        let (stride, empty) = (self.stride, empty(self.channels));
        let buffer = &mut buffer(self)[at];
        buffer.clear();
        buffer.resize(size, 0);
        for (i, word) in buffer.chunks_exact_mut(stride).enumerate() {
            word.fill(empty[i % empty.len()]);
        }
    }

    /// Words of one ray of a plane: all rows.
    #[inline(always)]
    fn ray_size(&self) -> usize {
        words(self.channels) * self.stride
    }

    fn plane_size(&self, level: u32) -> usize {
        rays(level) * self.ray_size()
    }

    /// A ray of the plane of odd index of a level that [`Self::make`] made last.
    #[inline(always)]
    pub fn ray(&self, level: u32, ray: usize) -> &[u32] {
        let size = self.ray_size();
        &self.odd[(level - self.first) as usize][ray * size..][..size]
    }

    /// A ray of the plane of a level that [`Self::make`] made last.
    pub fn held(&self, level: u32, plane: usize, ray: usize) -> &[u32] {
        if !plane.is_multiple_of(2) {
            return self.ray(level, ray);
        }
        let size = self.ray_size();
        &self.even[(level - self.first) as usize][ray * size..][..size]
    }

    /// Aims the beams, each of `width` rays, both ways that the slabs may go.
    pub fn aim(&mut self, slabs: &Slabs, width: u32) {
        let (level, stride) = (self.first, slabs.stride as isize);
        if self.made_for != (level, width, stride) {
            self.made_for = (level, width, stride);
            let beam = |ray| Rays { ways: beam(level, ray, width), others: Vec::new() };
            let beams: Vec<_> = (0..rays(level)).map(beam).collect();
            self.beams = [stride, -stride].map(|stride| Fan::new(&beams, stride));
            self.solid.resize(self.beams[0].cells.len(), [0; 2]);
        }
    }

    /// Makes the intervals of all levels that begin at a plane of the first; planes come in falling
    /// order.
    #[inline(always)]
    pub fn make<S: Simd, const K: usize>(&mut self, simd: S, slabs: &Slabs, plane: usize) {
        let held = if plane.is_multiple_of(2) { &mut self.even[0] } else { &mut self.odd[0] };
        let fan = &self.beams[slabs.reversed as usize];
        let ray_size = words(K) * self.stride;
        for row in (0..slabs.rows).step_by(TILE) {
            let from = (plane << self.first, row, &mut self.solid[..]);
            trace::<S, K>(simd, slabs, from, fan, self.stride, held);
        }
        for to in held.chunks_exact_mut(ray_size) {
            empty_tail::<K>(to, self.stride, slabs.rows);
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
        let (stride, rows, round) = (self.stride, self.rows, self.stride - 2 * PAD);
        let whole = plane + 1 < planes(self.depth, level);
        let [odd, odd_above] = &mut self.odd[at..at + 2] else { return };
        let [even, even_above] = &mut self.even[at..at + 2] else { return };
        let to = if (plane / 2).is_multiple_of(2) { even_above } else { odd_above };
        let far = if whole { &odd[..] } else { &[] };
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

/// Traces all beams from 64 rows of a slab.
#[inline(always)]
fn trace<S: Simd, const K: usize>(
    simd: S,
    slabs: &Slabs,
    (slab, row, bits): (usize, usize, &mut [[u64; 2]]),
    fan: &Fan,
    stride: usize,
    to: &mut [u32],
) {
    let start = slabs.start(slab) + row;
    let near = meet(simd, &slabs.kinds, start, fan.cells.iter().copied());
    if near.matter != 0 {
        solid(simd, &slabs.kinds, start, &fan.cells, bits);
    }
    for (i, to) in to.chunks_exact_mut(words(K) * stride).enumerate() {
        let met = match (near.matter, near.fraction) {
            (0, _) => Met::NOTHING,
            (_, 0) => meet_solid(bits, &fan.bundles[i].cells),
            _ => meet(simd, &slabs.kinds, start, fan.offsets(i)),
        };
        let beam = (&fan.bundles[i], met);
        let to = (to, stride, PAD + row);
        trace_beam::<S, K>(simd, slabs, (start, row, bits), beam, to);
    }
}

/// Traces one beam.
#[inline(always)]
fn trace_beam<S: Simd, const K: usize>(
    simd: S,
    slabs: &Slabs,
    (start, row, bits): (usize, usize, &[[u64; 2]]),
    (beam, met): (&Bundle, Met),
    (to, stride, at): (&mut [u32], usize, usize),
) {
    let share = 1.0 / beam.rays.len() as f32;
    let zero = f32x16::splat(simd, 0.0);
    let mut light = [[zero; VECTORS]; 3];
    let mut through = [[zero; VECTORS]; K];
    if met.fraction == 0 && met.matter != 0 {
        let source = (met.glowing != 0).then_some(share);
        for ray in &beam.rays {
            let open = (whole_vectors(met.matter), source);
            let open = march_solid(simd, slabs, (start, bits), ray, open, &mut light);
            for v in 0..VECTORS {
                let past = mask(simd, open, v).select(f32x16::splat(simd, share), zero);
                for k in 0..K {
                    through[k][v] += past;
                }
            }
        }
    }
    for v in 0..VECTORS.min((slabs.rows - row).div_ceil(LANES)) {
        let first = v * LANES;
        let mut interval = Interval::<S, K>::empty(simd);
        if let Some(kinds) = met.kinds(first) {
            for k in 0..K {
                interval.through[k] = through[k][v];
            }
            for c in 0..3 {
                interval.light[c] = light[c][v];
            }
            if met.fraction != 0 {
                for ray in &beam.rays {
                    let one = march::<S, K>(simd, slabs, start + first, ray, kinds);
                    for c in 0..3 {
                        interval.light[c] = one.light[c].mul_add(share, interval.light[c]);
                    }
                    for k in 0..K {
                        interval.through[k] = one.through[k].mul_add(share, interval.through[k]);
                    }
                }
            }
        }
        interval.store(to, stride, at + first);
    }
}

#[cfg(test)]
mod tests {
    use super::super::slabs::Axis;
    use super::super::ways::OFF_CORNERS;
    use super::*;
    use crate::{Cells, Matter};
    use fearless_simd::{Level, dispatch};

    /// Rays in a beam.
    const BEAM: u32 = 4;
    /// 8 bits of light and 15 of transmittance, rounded at each of up to four levels.
    const ROUNDING: f64 = 0.012;

    /// Walls, fog that glows, and glass, by chance.
    fn cells(tint: bool) -> Cells {
        let mut cells = Cells::new(37, 21).unwrap();
        let mut state = 5u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f32 / (1u32 << 24) as f32
        };
        for i in 0..cells.len() {
            let matter = match random() {
                v if v < 0.05 => {
                    Matter { emission: [2.0, 1.0, 0.5], opacity: 1.0, ..Matter::EMPTY }
                }
                v if v < 0.2 => Matter { emission: [0.3; 3], opacity: random(), ..Matter::EMPTY },
                v if v < 0.25 && tint => Matter { tint: [0.9, 0.5, 0.1], ..Matter::EMPTY },
                _ => Matter::EMPTY,
            };
            cells.set_matter(i, matter);
        }
        cells
    }

    /// Light and transmittance of one channel.
    type Of = (f64, f64);

    fn then(a: Of, b: Of) -> Of {
        (a.0 + a.1 * b.0, a.1 * b.1)
    }

    fn mean(of: &[Of]) -> Of {
        let sum = of.iter().fold((0.0, 0.0), |s, v| (s.0 + v.0, s.1 + v.1));
        (sum.0 / of.len() as f64, sum.1 / of.len() as f64)
    }

    /// A ray by all the grid lines that it crosses, found at once and sorted.
    fn line(cells: &Cells, channel: usize, [x, y]: [f64; 2], length: f64, slope: f64) -> Of {
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
            let through =
                ((1.0 - f64::from(matter.opacity)) * f64::from(matter.tint[channel])).powf(px);
            passed = then(passed, ((1.0 - through) * f64::from(matter.emission[channel]), through));
        }
        passed
    }

    /// `T_level(p, ray)` by the mean over all bent ways that it stands for.
    fn brute(cells: &Cells, channel: usize, level: u32, [x, y]: [i64; 2], ray: i64) -> Of {
        let outside = x >= i64::from(cells.width()) || !(0..i64::from(cells.height())).contains(&y);
        if level > 1 && outside {
            return (0.0, 1.0);
        }
        let length = 1i64 << level;
        if level == 1 {
            let slope = ray as f64 / length as f64 - 1.0;
            let rays: Vec<Of> = (0..BEAM)
                .map(|i| OFF_CORNERS * ((f64::from(i) + 0.5) / f64::from(BEAM) - 0.5))
                .map(|across| [x as f64 + 0.5, y as f64 + 0.5 + across])
                .map(|from| {
                    if outside {
                        (0.0, 1.0)
                    } else {
                        line(cells, channel, from, length as f64, slope)
                    }
                })
                .collect();
            return mean(&rays);
        }
        let half = length / 2;
        let way = |first: i64, second: i64| {
            let near = brute(cells, channel, level - 1, [x, y], first);
            let end = [x + half, y + first - half];
            then(near, brute(cells, channel, level - 1, end, second))
        };
        match ray % 2 {
            0 => way(ray / 2, ray / 2),
            _ => mean(&[way(ray / 2, ray / 2 + 1), way(ray / 2 + 1, ray / 2)]),
        }
    }

    /// The worst difference over all kept intervals from level 1 to 4, from cells that may not be
    /// those that the intervals were made of.
    fn worst<const K: usize>(cells: &Cells, compared: &Cells) -> f64 {
        let mut slabs = Slabs::default();
        slabs.read(cells, Axis::X, 4, None);
        assert_eq!(slabs.channels, K);
        let mut pyramid = Pyramid::default();
        pyramid.prepare(&slabs, 1);
        pyramid.aim(&slabs, BEAM);
        let mut worst = 0.0f64;
        for first in (1..planes(37, 1)).rev() {
            dispatch!(Level::new(), simd => pyramid.make::<_, K>(simd, &slabs, first));
            // The level at which the plane just made is of odd index.
            let level = 1 + first.trailing_zeros();
            for ray in (0..rays(level)).filter(|_| level < 5) {
                let words = pyramid.ray(level, ray);
                for row in (0..21).step_by(3) {
                    let (light, through) = dispatch!(Level::new(), simd => {
                        let read =
                            Interval::<_, K>::load(simd, words, pyramid.stride, PAD + row);
                        (read.light.map(|v| v.to_array()[0]), read.through.map(|v| v.to_array()[0]))
                    });
                    for c in 0..3 {
                        let from = [(first << 1) as i64, row as i64];
                        let want = brute(compared, c, level, from, ray as i64);
                        worst = worst
                            .max((f64::from(light[c]) - want.0).abs() / (1.0 + want.0))
                            .max((f64::from(through[c % K]) - want.1).abs());
                    }
                }
            }
        }
        worst
    }

    #[test]
    fn every_level_is_the_mean_over_the_ways_it_stands_for() {
        let (plain, tinted) = (cells(false), cells(true));
        let found = [worst::<1>(&plain, &plain), worst::<3>(&tinted, &tinted)];
        println!("{found:?}");
        assert!(found.iter().all(|&v| v < ROUNDING), "{found:?}");
        let mut other = plain.clone();
        other.set(20, 10, Matter { emission: [1.0; 3], opacity: 1.0, ..Matter::EMPTY });
        assert!(worst::<1>(&plain, &other) > ROUNDING, "one cell more is not noticed");
    }
}
