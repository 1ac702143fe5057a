//! The cascades of a grid, from near to far: their probes, and the number and length of their rays.

use crate::settings;
use crate::simd::floor;
use crate::stages::faces::NORMALS;
use fearless_simd::{f32x16, i32x16, prelude::*};
use std::f64::consts::TAU;

/// Factor by which the number and the length of rays grow from one cascade to the next.
pub const BRANCHES: u32 = 4;

/// Fraction of the grid's diagonal that the last but one cascade has to reach. The last one continues
/// to the sky; its rays are a third further apart than those of one more cascade would be.
const REACHED: f32 = 0.75;

/// Rotation of four rays around the circle, radians: exactly diagonal ones would pass through corners
/// of cells, where rounding decides between two paths.
const CORNER_ROTATION: f64 = 1e-3;

/// One cascade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cascade {
    /// The places of its probes; those of the nearest are cells and faces instead.
    pub lattice: Lattice,
    /// Rays per probe, over the full circle.
    pub rays: u32,
    /// Distance from the probe at which its rays start, px.
    pub start: f32,
    /// The distance at which they end and those of the next cascade start; infinite for the last.
    pub end: f32,
}

/// The segment that a ray covers, relative to its probe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RaySegment {
    /// Its start.
    pub start: [f32; 2],
    /// Its end; in the last cascade, a point along the ray.
    pub end: [f32; 2],
    /// The unit direction from start to end.
    pub direction: [f32; 2],
    /// Length, px; infinite in the last cascade.
    pub length: f32,
}

impl Cascade {
    /// Returns the segment of ray `number` of a probe. The four rays in one cone of the next nearer
    /// cascade start where the ray of that cone ends, so that no path is broken. Their ends reach into
    /// the next interval by `overlap`, a fraction of their own length.
    pub fn segment(&self, number: u32, overlap: f32) -> RaySegment {
        let direction = ray_direction(number, self.rays);
        let start = match self.start {
            0.0 => [0.0; 2],
            start => ray_direction(number / BRANCHES, self.rays / BRANCHES).map(|v| v * start),
        };
        if self.end.is_infinite() {
            let end = [start[0] + direction[0], start[1] + direction[1]];
            return RaySegment { start, end, direction, length: f32::INFINITY };
        }
        let end = direction.map(|v| v * (self.end + overlap * (self.end - self.start)));
        let step = [end[0] - start[0], end[1] - start[1]];
        let length = step[0].hypot(step[1]);
        RaySegment { start, end, direction: step.map(|v| v / length), length }
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

/// Probes in rows and columns, an even number of each, centred on the grid: the probes of a rotated
/// grid are the rotated probes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Size of the grid.
    around: [f32; 2],
    /// Columns and rows.
    pub count: [u32; 2],
    /// Distance from one probe to the next, px.
    pub spacing: f32,
}

impl Lattice {
    /// Returns the smallest lattice whose probes enclose `covered` px in the middle of a grid.
    fn over(around: [f32; 2], covered: [f32; 2], spacing: f32) -> Self {
        let count = covered.map(|side| 2 * (0.5 * side / spacing + 0.5).ceil() as u32);
        Self { around, count, spacing }
    }

    /// Returns the distance from the first probe to the last, px.
    fn extent(&self) -> [f32; 2] {
        self.count.map(|count| (count - 1) as f32 * self.spacing)
    }

    /// Returns the number of probes.
    pub fn len(&self) -> usize {
        self.count[0] as usize * self.count[1] as usize
    }

    /// Returns the positions of columns or rows of probes.
    #[inline(always)]
    pub(super) fn position<S: Simd>(&self, axis: usize, index: f32x16<S>) -> f32x16<S> {
        let middle = 0.5 * self.around[axis];
        (index - 0.5 * (self.count[axis] - 1) as f32) * self.spacing + middle
    }

    /// Returns the probe before each point along an axis, and the weight of the one after it.
    #[inline(always)]
    pub(super) fn locate<S: Simd>(&self, axis: usize, at: f32x16<S>) -> (f32x16<S>, f32x16<S>) {
        let middle = 0.5 * self.around[axis];
        let last = (self.count[axis] - 1) as f32;
        let place = (at - middle) * (1.0 / self.spacing) + 0.5 * last;
        let before = floor(place).max(0.0).min(last - 1.0);
        (before, place - before)
    }

    /// Returns the indices of probes.
    #[inline(always)]
    pub(super) fn index<S: Simd>(&self, [x, y]: [f32x16<S>; 2]) -> [i32; 16] {
        // Exact: there are at most four times as many probes as cells of the largest grid.
        let row = y.to_int::<i32x16<S>>() * self.count[0] as i32;
        (row + x.to_int::<i32x16<S>>()).to_array()
    }
}

/// Returns the unit direction in the middle of cone `k` of `rays` around the circle, at
/// `2π(k + ½)/rays`. Rotated or mirrored cones have the same numbers, rotated or mirrored.
fn ray_direction(k: u32, rays: u32) -> [f32; 2] {
    let quarter = rays / 4;
    let (turns, k) = (k / quarter, k % quarter);
    let angle = |k: u32| TAU * (f64::from(k) + 0.5) / f64::from(rays);
    let [x, y] = if quarter == 1 {
        unit(angle(k) + CORNER_ROTATION)
    } else if k < quarter / 2 {
        unit(angle(k))
    } else {
        let [x, y] = unit(angle(quarter - 1 - k));
        [y, x]
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

/// Returns the mean of the sine over cone `k` of `rays`, at which a gradient, linear in the sine on either
/// side of the horizon, has its mean radiance. No cone crosses the horizon.
pub fn mean_sine(k: u32, rays: u32) -> f32 {
    let [from, to] = edges(k, rays);
    ((from.cos() - to.cos()) / (to - from)) as f32
}

/// Returns `½∫cosθ dθ` over cone `k` of `rays`, with θ from the normal of a face in the order of
/// `NORMALS`; negative behind it. No cone is on both sides.
pub fn cosine(face: usize, k: u32, rays: u32) -> f32 {
    let ([x, y], [from, to]) = (NORMALS[face].map(f64::from), edges(k, rays));
    let weight = 0.5 * (x * (to.sin() - from.sin()) - y * (to.cos() - from.cos()));
    // Rounding must not give weight to a cone parallel to the face.
    if weight.abs() < 1e-9 { 0.0 } else { weight as f32 }
}

/// Returns the edges of cone `k` of `rays`, radians.
pub fn edges(k: u32, rays: u32) -> [f64; 2] {
    [k, k + 1].map(|k| TAU * f64::from(k) / f64::from(rays))
}
