//! Merging, from far to near: the radiance that a probe receives along a ray, from its own interval
//! first and then from the probes of the next cascade.

use super::interval::{PacketIntervals, TracedScene};
use super::ladder::{BRANCHES, Cascade, RaySegment, edges};
use crate::Rgb;
use crate::grid::packet::LANES;
use crate::settings::Merge;
use fearless_simd::{f32x16, prelude::*};

/// Values of light per probe or point: red, green, blue.
pub const LIGHT: usize = 3;
/// Values of light with its first moment: then those of its x component and of its y component.
pub const WITH_MOMENT: usize = 9;

/// Values after the last probe of a [`FartherCascade`]: packets are read whole.
pub const PADDING: usize = 2 * LANES;

/// The light of a cascade as the next nearer one reads it, within one cone of the nearest.
#[derive(Clone, Copy)]
pub struct FartherCascade<'a> {
    /// The cascade that gathered the light.
    pub cascade: &'a Cascade,
    /// Cone by cone of the nearer cascade, value by value ([`LIGHT`] or [`WITH_MOMENT`]), the mean over the
    /// cone at all its probes; then [`PADDING`].
    pub light: &'a [f32],
    /// Index of the first of these cones.
    pub first: u32,
    /// Values per probe.
    pub values: usize,
}

/// Sixteen points at which light is gathered.
#[derive(Clone, Copy)]
pub struct ReceiverPoints<S: Simd> {
    pub at: [f32x16<S>; 2],
    /// True if they lie in a row, with half the spacing of the probes of the next cascade.
    pub in_row: bool,
    /// The normal of the face on which they lie, if any: with the bilinear fix, rays that would run
    /// into the face itself are left out.
    pub normal: Option<[f32; 2]>,
}

/// The constants of one cascade's gather.
#[derive(Clone, Copy)]
pub struct ProbeTracer<'a> {
    pub scene: TracedScene<'a>,
    pub merge: Merge,
    pub overlap: f32,
    pub cascade: &'a Cascade,
    /// None for the last cascade, behind which lies the sky.
    pub farther: Option<FartherCascade<'a>>,
}

/// One ray of each probe.
#[derive(Clone, Copy)]
pub struct ProbeRay {
    segment: RaySegment,
    /// Its maximum extent along an axis, px.
    reach: f32,
    /// The angles that it stands for.
    edges: [f64; 2],
    /// Offset of the light beyond it in [`FartherCascade::light`], or the sky.
    plane: usize,
    sky: Rgb,
}

impl ProbeTracer<'_> {
    /// Returns the rays in one cone of the next nearer cascade.
    pub fn rays(&self, cone: u32) -> [ProbeRay; BRANCHES as usize] {
        std::array::from_fn(|i| self.ray(BRANCHES * cone + i as u32))
    }

    /// Returns a ray by its number.
    pub fn ray(&self, number: u32) -> ProbeRay {
        let segment = self.cascade.segment(number, self.overlap);
        let edges = edges(number, self.cascade.rays);
        let Some(beyond) = self.farther else {
            let sky = self.scene.grid.sky_mean(edges);
            return ProbeRay { segment, reach: f32::INFINITY, edges, plane: 0, sky };
        };
        let RaySegment { start, end, .. } = segment;
        let step = [end[0] - start[0], end[1] - start[1]];
        let reach = step[0].abs().max(step[1].abs());
        let reach = match self.merge {
            Merge::Plain => reach,
            Merge::BilinearFix => reach + beyond.cascade.lattice.spacing,
        };
        let plane = (number - beyond.first) as usize * beyond.values * beyond.cascade.lattice.len();
        ProbeRay { segment, reach, edges, plane, sky: Rgb::default() }
    }

    /// Returns the radiance that arrives at sixteen points, the mean over `rays`, in as many values as the farther
    /// cascade has.
    pub fn radiance<S: Simd, const N: usize>(
        &self,
        simd: S,
        points: ReceiverPoints<S>,
        rays: &[ProbeRay],
    ) -> [f32x16<S>; N] {
        // Not inlined, so that it is compiled once per vector unit, not once per caller.
        simd.vectorize(
            #[inline(always)]
            || self.mean_over(simd, points, rays),
        )
    }

    #[inline(always)]
    fn mean_over<S: Simd, const N: usize>(
        &self,
        simd: S,
        points: ReceiverPoints<S>,
        rays: &[ProbeRay],
    ) -> [f32x16<S>; N] {
        let mut sum = [f32x16::splat(simd, 0.0); N];
        // Closures are not always compiled for the vector unit: none here and below.
        #[expect(clippy::manual_map, reason = "a closure is slower")]
        let corners = match self.farther {
            Some(farther) => Some(ProbeCorners::around(farther, points)),
            None => None,
        };
        for ray in rays {
            let [x, y] = ray.segment.start;
            let start = [points.at[0] + x, points.at[1] + y];
            match &corners {
                None => {
                    let near = self.interval(simd, start, ray);
                    for v in 0..N {
                        let arriving =
                            near.light[v % 3] + near.transmittance[v % 3] * ray.sky[v % 3];
                        sum[v] += match v / 3 {
                            0 => arriving,
                            axis => arriving * ray.segment.direction[axis - 1],
                        };
                    }
                }
                Some(corners) => {
                    let merged: [_; N] = self.merged(simd, points, start, ray, corners);
                    for v in 0..N {
                        sum[v] += merged[v];
                    }
                }
            }
        }
        let weight = 1.0 / rays.len() as f32;
        for v in 0..N {
            sum[v] *= weight;
        }
        sum
    }

    /// Returns the radiance along one ray of sixteen points, with the light of the next cascade.
    #[inline(always)]
    fn merged<S: Simd, const N: usize>(
        &self,
        simd: S,
        points: ReceiverPoints<S>,
        start: [f32x16<S>; 2],
        ray: &ProbeRay,
        corners: &ProbeCorners<S>,
    ) -> [f32x16<S>; N] {
        let mut sum = [f32x16::splat(simd, 0.0); N];
        let empty = self.scene.is_empty_around(start, ray.reach);
        if empty || self.merge == Merge::Plain {
            for corner in 0..4 {
                let light = corners.light::<N>(simd, ray.plane, corner);
                for v in 0..N {
                    sum[v] += corners.weight[corner] * light[v];
                }
            }
            if !empty {
                let near = self.interval(simd, start, ray);
                for v in 0..N {
                    let light = match v / 3 {
                        0 => near.light[v],
                        axis => near.light[v % 3] * ray.segment.direction[axis - 1],
                    };
                    sum[v] = light + near.transmittance[v % 3] * sum[v];
                }
            }
            return sum;
        }
        let mut whole = f32x16::splat(simd, 0.0);
        for corner in 0..4 {
            let shift = corners.shift(points.at, corner);
            let RaySegment { start: from, end: to, .. } = ray.segment;
            let step = [shift[0] + (to[0] - from[0]), shift[1] + (to[1] - from[1])];
            let length = (step[0] * step[0] + step[1] * step[1]).sqrt();
            let length = length.max(f32::MIN_POSITIVE);
            let mut weight = corners.weight[corner];
            if let Some([x, y]) = points.normal {
                let in_front = (step[0] * x + step[1] * y).simd_gt(0.0);
                weight = in_front.select(weight, f32x16::splat(simd, 0.0));
            }
            whole += weight;
            let direction = [step[0] / length, step[1] / length];
            let near = self.scene.trace(simd, start, direction, length, ray.edges);
            let light = corners.light::<N>(simd, ray.plane, corner);
            for v in 0..N {
                let near_light = match v / 3 {
                    0 => near.light[v],
                    axis => near.light[v % 3] * direction[axis - 1],
                };
                let arriving = near_light + near.transmittance[v % 3] * light[v];
                sum[v] += weight * arriving;
            }
        }
        if points.normal.is_some() {
            // Some of the four probes lie in the direction of the ray or beside it.
            for v in 0..N {
                sum[v] /= whole;
            }
        }
        sum
    }

    /// Returns the intervals of the ray itself.
    #[inline(always)]
    fn interval<S: Simd>(
        &self,
        simd: S,
        start: [f32x16<S>; 2],
        ray: &ProbeRay,
    ) -> PacketIntervals<S> {
        let RaySegment { direction, length, .. } = ray.segment;
        let direction = [f32x16::splat(simd, direction[0]), f32x16::splat(simd, direction[1])];
        self.scene.trace(simd, start, direction, f32x16::splat(simd, length), ray.edges)
    }
}

/// The four probes of the next cascade around each of sixteen points.
struct ProbeCorners<'a, S: Simd> {
    farther: FartherCascade<'a>,
    first: FirstProbe,
    before: [f32x16<S>; 2],
    weight: [f32x16<S>; 4],
}

/// Indices of the first of the four probes.
enum FirstProbe {
    /// Consecutive: from `even` on for the even points, from `odd` on for the odd ones.
    Row { even: usize, odd: usize },
    /// One index per point.
    Scattered([i32; LANES]),
}

impl<'a, S: Simd> ProbeCorners<'a, S> {
    #[inline(always)]
    fn around(farther: FartherCascade<'a>, points: ReceiverPoints<S>) -> Self {
        let lattice = &farther.cascade.lattice;
        let (x, fx) = lattice.locate(0, points.at[0]);
        let (y, fy) = lattice.locate(1, points.at[1]);
        let first = lattice.index([x, y]);
        let (gx, gy) = (-fx + 1.0, -fy + 1.0);
        Self {
            farther,
            first: if points.in_row {
                FirstProbe::Row { even: first[0] as usize, odd: first[1] as usize }
            } else {
                FirstProbe::Scattered(first)
            },
            before: [x, y],
            weight: [gx * gy, fx * gy, gx * fy, fx * fy],
        }
    }

    /// Returns the offsets from the points to a corner.
    #[inline(always)]
    fn shift(&self, at: [f32x16<S>; 2], corner: usize) -> [f32x16<S>; 2] {
        let lattice = &self.farther.cascade.lattice;
        let [x, y] = [(corner & 1) as f32, (corner >> 1) as f32];
        [
            lattice.position(0, self.before[0] + x) - at[0],
            lattice.position(1, self.before[1] + y) - at[1],
        ]
    }

    /// Returns the light that a corner has gathered.
    #[inline(always)]
    fn light<const N: usize>(&self, simd: S, plane: usize, corner: usize) -> [f32x16<S>; N] {
        let lattice = &self.farther.cascade.lattice;
        let step = (corner & 1) + (corner >> 1) * lattice.count[0] as usize;
        let mut light = [f32x16::splat(simd, 0.0); N];
        for (v, light) in light.iter_mut().enumerate() {
            let light_of = &self.farther.light[plane + v * lattice.len() + step..];
            *light = match &self.first {
                FirstProbe::Row { even, odd } => {
                    let even = f32x16::from_slice(simd, &light_of[*even..][..LANES]);
                    let odd = f32x16::from_slice(simd, &light_of[*odd..][..LANES]);
                    even.zip_low(odd)
                }
                FirstProbe::Scattered(first) => {
                    f32x16::from_fn(simd, |l| light_of[first[l] as usize])
                }
            };
        }
        light
    }
}
