//! The cascades of a grid, from near to far: how many rays, how long, from which probes.

use crate::settings;
use crate::stages::bounce::NORMALS;
use fearless_simd::{f32x16, i32x16, prelude::*};
use std::f64::consts::TAU;

/// From one cascade to the next, rays get so many times more and longer.
pub const BRANCHES: u32 = 4;

/// Share of the grid's diagonal that the last but one cascade has to reach. The last one goes on
/// to the sky; in what is left its rays are a third further apart than they would be.
const REACHED: f32 = 0.75;

/// Turn of four rays round the circle, radians: exactly diagonal ones would run through corners of
/// cells, where rounding decides which way round.
const OFF_THE_CORNERS: f64 = 1e-3;

/// One cascade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cascade {
    /// Where its probes stand; those of the nearest are cells and faces instead.
    pub lattice: Lattice,
    /// Rays of a probe all round.
    pub rays: u32,
    /// px from the probe at which its rays start.
    pub start: f32,
    /// And where they end, which is where those of the next cascade start; the last one's don't.
    pub end: f32,
}

/// Where a ray leads, as seen from its probe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Path {
    /// Where it starts.
    pub start: [f32; 2],
    /// Where it ends; of an endless one, some px along it.
    pub end: [f32; 2],
    /// The unit direction from the one to the other.
    pub way: [f32; 2],
    /// px from the one to the other, infinite in the last cascade.
    pub length: f32,
}

impl Cascade {
    /// Ray `number` of a probe. The four rays in one cone of the next nearer cascade start where the
    /// ray of that cone ends, so that no path is broken; their ends reach into the next interval by
    /// `overlap`, a share of their own.
    pub fn path(&self, number: u32, overlap: f32) -> Path {
        let way = direction(number, self.rays);
        let start = match self.start {
            0.0 => [0.0; 2],
            start => direction(number / BRANCHES, self.rays / BRANCHES).map(|v| v * start),
        };
        if self.end.is_infinite() {
            let end = [start[0] + way[0], start[1] + way[1]];
            return Path { start, end, way, length: f32::INFINITY };
        }
        let end = way.map(|v| v * (self.end + overlap * (self.end - self.start)));
        let step = [end[0] - start[0], end[1] - start[1]];
        let length = step[0].hypot(step[1]);
        Path { start, end, way: step.map(|v| v / length), length }
    }
}

/// Fills `cascades`, the nearest first, for a grid of this size.
pub fn cascades(size: [u32; 2], settings: &settings::Cascades, cascades: &mut Vec<Cascade>) {
    cascades.clear();
    let diagonal = (size[0] as f32).hypot(size[1] as f32);
    let (mut start, mut length, mut rays) =
        (0.0, settings.nearest_interval(), settings.nearest_rays());
    let mut lattice = Lattice::over(size.map(|v| v as f32), size.map(|v| v as f32), 1.0);
    loop {
        let end = start + length;
        let last = end >= REACHED * diagonal;
        let reach = if last { f32::INFINITY } else { end };
        cascades.push(Cascade { lattice, rays, start, end: reach });
        if last {
            return;
        }
        let far = (1u32 << cascades.len()) as f32;
        let covered = if cascades.len() == 1 { lattice.around } else { lattice.extent() };
        lattice = Lattice::over(lattice.around, covered, settings.spacing * far);
        (start, length, rays) = (end, length * BRANCHES as f32, rays * BRANCHES);
    }
}

/// Probes in rows and columns, an even number of each, in the middle of the grid: so a grid that
/// is turned has its probes turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Size of the grid.
    around: [f32; 2],
    /// Columns and rows.
    pub count: [u32; 2],
    /// px from one probe to the next.
    pub spacing: f32,
}

impl Lattice {
    /// The smallest lattice that has `covered` px in the middle of a grid between its probes.
    fn over(around: [f32; 2], covered: [f32; 2], spacing: f32) -> Self {
        let count = covered.map(|side| 2 * (0.5 * side / spacing + 0.5).ceil() as u32);
        Self { around, count, spacing }
    }

    /// px from the first probe to the last.
    fn extent(&self) -> [f32; 2] {
        self.count.map(|count| (count - 1) as f32 * self.spacing)
    }

    /// Number of probes.
    #[expect(clippy::len_without_is_empty, reason = "there are always four probes at least")]
    pub fn len(&self) -> usize {
        self.count[0] as usize * self.count[1] as usize
    }

    /// Where a column or row of probes stands.
    #[inline(always)]
    pub(super) fn position<S: Simd>(&self, axis: usize, index: f32x16<S>) -> f32x16<S> {
        let middle = 0.5 * self.around[axis];
        (index - 0.5 * (self.count[axis] - 1) as f32) * self.spacing + middle
    }

    /// The probe before each point along an axis, and the share of the one after it.
    #[inline(always)]
    pub(super) fn locate<S: Simd>(&self, axis: usize, at: f32x16<S>) -> (f32x16<S>, f32x16<S>) {
        let middle = 0.5 * self.around[axis];
        let last = (self.count[axis] - 1) as f32;
        let place = (at - middle) * (1.0 / self.spacing) + 0.5 * last;
        let before = place.floor().max(0.0).min(last - 1.0);
        (before, place - before)
    }

    /// Index of a probe.
    #[inline(always)]
    pub(super) fn index<S: Simd>(&self, [x, y]: [f32x16<S>; 2]) -> [i32; 16] {
        // Exact: there are at most four times as many probes as cells of the largest grid.
        let row = y.to_int::<i32x16<S>>() * self.count[0] as i32;
        (row + x.to_int::<i32x16<S>>()).to_array()
    }
}

/// Unit direction in the middle of cone `k` of `rays` round the circle: `2π(k + ½)/rays`. Cones
/// that are turned or mirrored have the same numbers, turned or mirrored.
fn direction(k: u32, rays: u32) -> [f32; 2] {
    let quarter = rays / 4;
    let (turns, k) = (k / quarter, k % quarter);
    let angle = |k: u32| TAU * (f64::from(k) + 0.5) / f64::from(rays);
    let [x, y] = match () {
        () if quarter == 1 => unit(angle(k) + OFF_THE_CORNERS),
        () if k < quarter / 2 => unit(angle(k)),
        () => {
            let [x, y] = unit(angle(quarter - 1 - k));
            [y, x]
        }
    };
    match turns {
        0 => [x, y],
        1 => [-y, x],
        2 => [-x, -y],
        _ => [y, -x],
    }
}

fn unit(angle: f64) -> [f32; 2] {
    [angle.cos() as f32, angle.sin() as f32]
}

/// The mean of the sine over cone `k` of `rays`: what the sky, linear in the sine on either side of
/// the horizon, is seen by. No cone reaches over the horizon.
pub fn mean_sine(k: u32, rays: u32) -> f32 {
    let [from, to] = edges(k, rays);
    ((from.cos() - to.cos()) / (to - from)) as f32
}

/// `½∫cosθ dθ` over cone `k` of `rays`, θ from the normal of a face in the order of
/// [`NORMALS`]; negative behind it. No cone is on both sides.
pub fn cosine(face: usize, k: u32, rays: u32) -> f32 {
    let ([x, y], [from, to]) = (NORMALS[face].map(f64::from), edges(k, rays));
    let weight = 0.5 * (x * (to.sin() - from.sin()) - y * (to.cos() - from.cos()));
    // Rounding must not have a cone beside the face count.
    if weight.abs() < 1e-9 { 0.0 } else { weight as f32 }
}

/// The edges of cone `k` of `rays`, radians.
fn edges(k: u32, rays: u32) -> [f64; 2] {
    [k, k + 1].map(|k| TAU * f64::from(k) / f64::from(rays))
}
