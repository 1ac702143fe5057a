//! From far to near: what a probe sees along a ray, its own interval first and then what the
//! probes of the next cascade have gathered.

use super::interval::{Field, Interval};
use super::ladder::{BRANCHES, Cascade, direction};
use crate::settings::Merge;
use crate::stages::packet::LANES;
use crate::{Rgb, Sky};
use fearless_simd::{f32x16, prelude::*};

/// Light of one probe in one cone; padded, so that it is read at once.
pub type Padded = [f32; 4];

/// What one cascade hands to the next nearer one, within one cone of the nearest.
#[derive(Clone, Copy)]
pub struct Far<'a> {
    /// The cascade that gathered it; the one before the last hands on the sky.
    pub cascade: &'a Cascade,
    /// Cone by cone of the nearer cascade, all its probes: the mean over the cone.
    pub light: &'a [Padded],
    /// Number of the first of these cones.
    pub first: u32,
}

/// What stays the same while one cascade is filled.
#[derive(Clone, Copy)]
pub struct Caster<'a> {
    pub field: Field<'a>,
    pub merge: Merge,
    pub overlap: f32,
    pub cascade: &'a Cascade,
    /// `None` for the last cascade.
    pub far: Option<Far<'a>>,
}

impl Caster<'_> {
    /// Mean radiance that arrives at sixteen probes of a cascade in one cone of the next nearer
    /// one. All rays of that cone start where its own ray ends, so that no path is broken.
    #[inline(always)]
    pub fn mean<S: Simd>(&self, simd: S, probe: [f32x16<S>; 2], cone: u32) -> [f32x16<S>; 3] {
        let ahead = direction(cone, self.cascade.rays / BRANCHES);
        let from = [0, 1].map(|a| probe[a] + ahead[a] * self.cascade.start);
        let mut sum = [f32x16::splat(simd, 0.0); 3];
        for ray in BRANCHES * cone..BRANCHES * (cone + 1) {
            let seen = self.see(simd, probe, from, ray);
            (0..3).for_each(|c| sum[c] += seen[c]);
        }
        sum.map(|v| v * (1.0 / BRANCHES as f32))
    }

    /// Radiance that arrives at sixteen probes along one ray that starts at `from`.
    #[inline(always)]
    pub fn see<S: Simd>(
        &self,
        simd: S,
        probe: [f32x16<S>; 2],
        from: [f32x16<S>; 2],
        ray: u32,
    ) -> [f32x16<S>; 3] {
        let way = direction(ray, self.cascade.rays);
        let Some(far) = self.far else {
            let reach = f32x16::splat(simd, f32::INFINITY);
            let near = self.field.trace(simd, from, way.map(|v| f32x16::splat(simd, v)), reach);
            let sky = sky_in_cone(self.field.optics.sky, ray, self.cascade.rays);
            return std::array::from_fn(|c| near.light[c] + near.through[c] * sky[c]);
        };
        let (start, end) = (self.cascade.start, self.cascade.end);
        let stretch = self.overlap * (end - start);
        let ends = |at: [f32x16<S>; 2]| [0, 1].map(|a| at[a] + way[a] * (end + stretch));
        let around = Around::of(&far, probe, ray);
        let to = ends(probe);
        match self.merge {
            Merge::Plain => {
                let near = self.between(simd, from, to);
                let mut beyond = [f32x16::splat(simd, 0.0); 3];
                for corner in 0..4 {
                    let light = around.light(simd, corner);
                    (0..3).for_each(|c| beyond[c] += around.weight[corner] * light[c]);
                }
                std::array::from_fn(|c| near.light[c] + near.through[c] * beyond[c])
            }
            Merge::BilinearFix => {
                let mut sum = [f32x16::splat(simd, 0.0); 3];
                let reach = [0, 1].map(|a| (to[a] - from[a]).abs());
                let reach = reach[0].max(reach[1]).to_array();
                let reach =
                    reach.into_iter().fold(0.0, f32::max) + 1.5 * far.cascade.lattice.spacing;
                let clear = self.field.is_clear(from, reach);
                for corner in 0..4 {
                    let near = if clear {
                        Interval::clear(simd)
                    } else {
                        self.between(simd, from, ends(around.probe(&far, corner)))
                    };
                    let light = around.light(simd, corner);
                    for c in 0..3 {
                        let seen = near.light[c] + near.through[c] * light[c];
                        sum[c] += around.weight[corner] * seen;
                    }
                }
                sum
            }
        }
    }

    #[inline(always)]
    fn between<S: Simd>(&self, simd: S, from: [f32x16<S>; 2], to: [f32x16<S>; 2]) -> Interval<S> {
        let way = [0, 1].map(|a| to[a] - from[a]);
        let length = (way[0] * way[0] + way[1] * way[1]).sqrt().max(f32::MIN_POSITIVE);
        self.field.trace(simd, from, way.map(|v| v / length), length)
    }
}

/// The four probes of the next cascade around each of sixteen points.
struct Around<'a, S: Simd> {
    light: &'a [Padded],
    first: [i32; LANES],
    columns: usize,
    before: [f32x16<S>; 2],
    weight: [f32x16<S>; 4],
}

impl<'a, S: Simd> Around<'a, S> {
    #[inline(always)]
    fn of(far: &Far<'a>, at: [f32x16<S>; 2], cone: u32) -> Self {
        let lattice = &far.cascade.lattice;
        let ((x, fx), (y, fy)) = (lattice.locate(0, at[0]), lattice.locate(1, at[1]));
        let (gx, gy) = (-fx + 1.0, -fy + 1.0);
        let plane = lattice.len() * (cone - far.first) as usize;
        Self {
            light: &far.light[plane..][..lattice.len()],
            first: lattice.index([x, y]),
            columns: lattice.count[0] as usize,
            before: [x, y],
            weight: [gx * gy, fx * gy, gx * fy, fx * fy],
        }
    }

    /// Where a corner stands.
    #[inline(always)]
    fn probe(&self, far: &Far, corner: usize) -> [f32x16<S>; 2] {
        let step = [(corner & 1) as f32, (corner >> 1) as f32];
        [0, 1].map(|a| far.cascade.lattice.position(a, self.before[a] + step[a]))
    }

    /// What a corner has gathered.
    #[inline(always)]
    fn light(&self, simd: S, corner: usize) -> [f32x16<S>; 3] {
        let step = (corner & 1) + (corner >> 1) * self.columns;
        let light: [Padded; LANES] =
            std::array::from_fn(|l| self.light[self.first[l] as usize + step]);
        std::array::from_fn(|c| f32x16::from_fn(simd, |l| light[l][c]))
    }
}

/// Mean radiance of the sky over a cone.
fn sky_in_cone(sky: Sky, cone: u32, cones: u32) -> Rgb {
    // Cones do not reach over the horizon, on either side of which a gradient is linear in the sine.
    let [from, to] = super::ladder::edges(cone, cones);
    let sine = (from.cos() - to.cos()) / (to - from);
    sky.radiance(sine as f32)
}
