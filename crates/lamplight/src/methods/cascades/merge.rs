//! From far to near: what a probe sees along a ray, its own interval first and then what the
//! probes of the next cascade have gathered.

use super::interval::{Field, Interval};
use super::ladder::{BRANCHES, Cascade, Path, mean_sine};
use crate::Rgb;
use crate::settings::Merge;
use crate::stages::packet::LANES;
use fearless_simd::{f32x16, prelude::*};

/// Values after the last probe of a [`Far`]: packets are read whole.
pub const PADDING: usize = 2 * LANES;

/// What one cascade hands to the next nearer one, within one cone of the nearest.
#[derive(Clone, Copy)]
pub struct Far<'a> {
    /// The cascade that gathered it.
    pub cascade: &'a Cascade,
    /// Cone by cone of the nearer cascade, channel by channel, all its probes: the mean over the
    /// cone; then [`PADDING`].
    pub light: &'a [f32],
    /// Number of the first of these cones.
    pub first: u32,
}

/// Sixteen points that light is gathered at.
#[derive(Clone, Copy)]
pub struct Points<S: Simd> {
    pub at: [f32x16<S>; 2],
    /// Whether they lie in a row, half as far apart as the probes of the next cascade.
    pub in_row: bool,
    /// Where they lie on a face, its normal: with the bilinear fix, rays that would run into the
    /// face itself are left out.
    pub normal: Option<[f32; 2]>,
}

/// What stays the same while one cascade is filled.
#[derive(Clone, Copy)]
pub struct Caster<'a> {
    pub field: Field<'a>,
    pub merge: Merge,
    pub overlap: f32,
    pub cascade: &'a Cascade,
    /// `None` for the last cascade, behind which there is the sky.
    pub far: Option<Far<'a>>,
}

/// One ray of each probe.
#[derive(Clone, Copy)]
pub struct Ray {
    path: Path,
    /// The most px that it goes along an axis.
    reach: f32,
    /// Where what lies beyond is kept, or the sky.
    plane: usize,
    sky: Rgb,
}

impl Caster<'_> {
    /// The rays in one cone of the next nearer cascade.
    pub fn rays(&self, cone: u32) -> [Ray; BRANCHES as usize] {
        std::array::from_fn(|i| self.ray(BRANCHES * cone + i as u32))
    }

    /// One ray.
    pub fn ray(&self, number: u32) -> Ray {
        let path = self.cascade.path(number, self.overlap);
        let Some(beyond) = self.far else {
            let sky = self.field.optics.sky.radiance(mean_sine(number, self.cascade.rays));
            return Ray { path, reach: f32::INFINITY, plane: 0, sky };
        };
        let step = [path.end[0] - path.start[0], path.end[1] - path.start[1]];
        let reach = step[0].abs().max(step[1].abs());
        let reach = match self.merge {
            Merge::Plain => reach,
            Merge::BilinearFix => reach + beyond.cascade.lattice.spacing,
        };
        let plane = (number - beyond.first) as usize * 3 * beyond.cascade.lattice.len();
        Ray { path, reach, plane, sky: Rgb::default() }
    }

    /// Radiance that arrives at sixteen points, the mean over some rays.
    #[inline(always)]
    pub fn see<S: Simd>(&self, simd: S, points: Points<S>, rays: &[Ray]) -> [f32x16<S>; 3] {
        let mut sum = [f32x16::splat(simd, 0.0); 3];
        // Closures are not always compiled for the vector unit at hand: none here and below.
        #[expect(clippy::manual_map, reason = "a closure is slower")]
        let around = match self.far {
            Some(far) => Some(Around::of(far, points)),
            None => None,
        };
        for ray in rays {
            let [x, y] = ray.path.start;
            let start = [points.at[0] + x, points.at[1] + y];
            match &around {
                None => {
                    let near = self.along(simd, start, ray);
                    for c in 0..3 {
                        sum[c] += near.light[c] + near.through[c] * ray.sky[c];
                    }
                }
                Some(around) => {
                    let seen = self.merged(simd, points, start, ray, around);
                    for c in 0..3 {
                        sum[c] += seen[c];
                    }
                }
            }
        }
        let share = 1.0 / rays.len() as f32;
        [sum[0] * share, sum[1] * share, sum[2] * share]
    }

    #[inline(always)]
    fn merged<S: Simd>(
        &self,
        simd: S,
        points: Points<S>,
        start: [f32x16<S>; 2],
        ray: &Ray,
        around: &Around<S>,
    ) -> [f32x16<S>; 3] {
        let mut seen = [f32x16::splat(simd, 0.0); 3];
        let clear = self.field.is_clear(start, ray.reach);
        if clear || self.merge == Merge::Plain {
            for corner in 0..4 {
                let light = around.light(simd, ray.plane, corner);
                for c in 0..3 {
                    seen[c] += around.weight[corner] * light[c];
                }
            }
            if !clear {
                let near = self.along(simd, start, ray);
                for c in 0..3 {
                    seen[c] = near.light[c] + near.through[c] * seen[c];
                }
            }
            return seen;
        }
        let mut whole = f32x16::splat(simd, 0.0);
        for corner in 0..4 {
            let shift = around.shift(points.at, corner);
            let Path { start: from, end: to, .. } = ray.path;
            let step = [shift[0] + (to[0] - from[0]), shift[1] + (to[1] - from[1])];
            let length = (step[0] * step[0] + step[1] * step[1]).sqrt();
            let length = length.max(f32::MIN_POSITIVE);
            let mut weight = around.weight[corner];
            if let Some([x, y]) = points.normal {
                let before = (step[0] * x + step[1] * y).simd_gt(0.0);
                weight = before.select(weight, f32x16::splat(simd, 0.0));
            }
            whole += weight;
            let near = self.field.trace(simd, start, [step[0] / length, step[1] / length], length);
            let light = around.light(simd, ray.plane, corner);
            for c in 0..3 {
                let sum = near.light[c] + near.through[c] * light[c];
                seen[c] += weight * sum;
            }
        }
        if points.normal.is_some() {
            // Of the four probes some stand in the direction of the ray or beside it.
            for c in 0..3 {
                seen[c] /= whole;
            }
        }
        seen
    }

    /// The ray itself.
    #[inline(always)]
    fn along<S: Simd>(&self, simd: S, start: [f32x16<S>; 2], ray: &Ray) -> Interval<S> {
        let Path { way, length, .. } = ray.path;
        let way = [f32x16::splat(simd, way[0]), f32x16::splat(simd, way[1])];
        self.field.trace(simd, start, way, f32x16::splat(simd, length))
    }
}

/// The four probes of the next cascade around each of sixteen points.
struct Around<'a, S: Simd> {
    far: Far<'a>,
    first: First,
    before: [f32x16<S>; 2],
    weight: [f32x16<S>; 4],
}

/// Which probe is the first of the four.
enum First {
    /// That of the even points on from `even`, that of the odd ones on from `odd`.
    Row { even: usize, odd: usize },
    /// Each its own.
    Scattered([i32; LANES]),
}

impl<'a, S: Simd> Around<'a, S> {
    #[inline(always)]
    fn of(far: Far<'a>, points: Points<S>) -> Self {
        let lattice = &far.cascade.lattice;
        let (x, fx) = lattice.locate(0, points.at[0]);
        let (y, fy) = lattice.locate(1, points.at[1]);
        let first = lattice.index([x, y]);
        let (gx, gy) = (-fx + 1.0, -fy + 1.0);
        Self {
            far,
            first: match points.in_row {
                true => First::Row { even: first[0] as usize, odd: first[1] as usize },
                false => First::Scattered(first),
            },
            before: [x, y],
            weight: [gx * gy, fx * gy, gx * fy, fx * fy],
        }
    }

    /// From the points to a corner.
    #[inline(always)]
    fn shift(&self, at: [f32x16<S>; 2], corner: usize) -> [f32x16<S>; 2] {
        let lattice = &self.far.cascade.lattice;
        let [x, y] = [(corner & 1) as f32, (corner >> 1) as f32];
        [
            lattice.position(0, self.before[0] + x) - at[0],
            lattice.position(1, self.before[1] + y) - at[1],
        ]
    }

    /// What a corner has gathered.
    #[inline(always)]
    fn light(&self, simd: S, plane: usize, corner: usize) -> [f32x16<S>; 3] {
        let lattice = &self.far.cascade.lattice;
        let step = (corner & 1) + (corner >> 1) * lattice.count[0] as usize;
        let mut light = [f32x16::splat(simd, 0.0); 3];
        for c in 0..3 {
            let light_of = &self.far.light[plane + c * lattice.len() + step..];
            light[c] = match &self.first {
                First::Row { even, odd } => {
                    let even = f32x16::from_slice(simd, &light_of[*even..][..LANES]);
                    let odd = f32x16::from_slice(simd, &light_of[*odd..][..LANES]);
                    even.zip_low(odd)
                }
                First::Scattered(first) => f32x16::from_fn(simd, |l| light_of[first[l] as usize]),
            };
        }
        light
    }
}
