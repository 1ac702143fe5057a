//! Means over rays: the mean radiance at a cell's center, and the irradiance of the faces of a wall.

use super::march::{RayScene, Seen};
use crate::grid::packet::{LANES, Lanes};
use crate::grid::traverse::Ray;
use crate::math::noise;
use crate::moment;
use crate::settings::{Raymarch, Spacing};
use crate::simd::dispatch;
use crate::srgb::luminance;
use crate::stages::bounce::Wall;
use crate::stages::faces::{Faces, NORMALS};
use crate::{Moment, Rgb};
use fearless_simd::{Level, f32x16, prelude::*};
use std::f32::consts::TAU;

/// The golden angle as Bigos (2020) writes it, radians.
const GOLDEN_ANGLE: f32 = std::f32::consts::PI * 0.763_932_02;
/// The fraction of the golden ratio: spreads ray origins along a face.
pub const GOLDEN_RATIO: f32 = 0.618_034;

/// The number of rays whose noise is estimated together; even, so that light from the whole sector
/// cancels. Of 2 to 16, and all rays at once, the one with the least error over the example scenes at
/// 32 rays (2 is as good there and worse at 128).
pub const SECTOR: u32 = 4;

/// Returns the range of a pixel's rotation, radians: the angular stride from ray to ray if rays are
/// evenly spaced, else the whole circle.
pub fn stride(settings: &Raymarch) -> f32 {
    match settings.spacing {
        Spacing::Even => TAU / settings.rays as f32,
        Spacing::Golden => TAU,
    }
}

/// Returns the directions of a pixel's rays before its rotation, unit vectors.
pub fn directions(settings: &Raymarch) -> impl Iterator<Item = [f32; 2]> {
    let between = match settings.spacing {
        Spacing::Even => TAU / settings.rays as f32,
        Spacing::Golden => GOLDEN_ANGLE,
    };
    (0..settings.rays).map(move |i| {
        let angle = (f64::from(between) * f64::from(i)) as f32 % TAU;
        [angle.cos(), angle.sin()]
    })
}

/// [`directions`], kept from frame to frame.
#[derive(Debug, Default)]
pub struct Directions(Vec<[f32; 2]>);

impl Directions {
    /// Fills the table for these settings.
    pub fn prepare(&mut self, settings: &Raymarch) {
        self.0.clear();
        self.0.extend(directions(settings));
    }
}

/// The constants of one gather.
#[derive(Clone, Copy)]
pub struct Gather<'a> {
    pub scene: RayScene<'a>,
    pub directions: &'a Directions,
    pub frame: u32,
    pub seed: u64,
    /// True if the first moment of the light is found too.
    pub moment: bool,
    pub level: Level,
}

impl Gather<'_> {
    /// Returns the mean radiance at the centers of up to sixteen cells; neighbouring cells are faster.
    #[inline]
    pub fn mean_radiance(&self, cells: &[u32]) -> Lanes<Mean> {
        dispatch!(self.level, simd => self.over_circle(simd, cells))
    }

    /// Returns the irradiance, ÷ 2, of each exposed face of a wall, and whether anything that it sees
    /// changed.
    pub fn faces(&self, wall: &Wall) -> (Faces, [bool; 4]) {
        let mut irradiance = Faces::default();
        let mut changed = [false; 4];
        self.each_face(wall, |face, seen| {
            (irradiance[face], changed[face]) = (seen.light, seen.changed);
        });
        (irradiance, changed)
    }

    /// Returns the mean irradiance, ÷ 2, of the exposed faces of a wall.
    pub fn mean_irradiance(&self, wall: &Wall) -> Mean {
        let (mut mean, mut count) = (Mean::default(), 0.0);
        self.each_face(wall, |_, seen| {
            (0..3).for_each(|c| mean.light[c] += seen.light[c]);
            mean.variance += seen.variance;
            mean.changed |= seen.changed;
            count += 1.0;
        });
        Mean {
            light: mean.light.map(|v| v / count),
            variance: mean.variance / (count * count),
            ..mean
        }
    }

    /// Calls `take` with each exposed face of a wall.
    fn each_face(&self, wall: &Wall, mut take: impl FnMut(usize, Mean)) {
        for (face, exposed) in wall.exposed.into_iter().enumerate() {
            if exposed {
                take(face, dispatch!(self.level, simd => self.over_face(simd, wall.cell, face)));
            }
        }
    }

    #[inline(always)]
    fn over_circle<S: Simd>(&self, simd: S, cells: &[u32]) -> Lanes<Mean> {
        let settings = self.scene.settings;
        let place = |l: usize| self.place(cells[l.min(cells.len() - 1)]);
        let corner = |a: usize| f32x16::from_fn(simd, |l| place(l)[a] as f32);
        let cell = [corner(0), corner(1)];
        let stride = stride(settings);
        let rotation: Lanes<f32> = std::array::from_fn(|l| {
            let [x, y] = place(l);
            self.jitter(x, y) * stride
        });
        let cos = f32x16::from_fn(simd, |l| rotation[l].cos());
        let sin = f32x16::from_fn(simd, |l| rotation[l].sin());
        let from = cell.map(|c| c + 0.5);
        let mut sums = [Sum::default(); LANES];
        for (ray, &[x, y]) in self.directions.0.iter().enumerate() {
            let direction = [cos * x - sin * y, sin * x + cos * y];
            let seen = self.scene.march(simd, Ray { from, cell, direction }, false);
            for (sum, seen) in sums.iter_mut().zip(&seen) {
                sum.add(ray as u32, seen);
            }
            if self.moment {
                for (l, (sum, seen)) in sums.iter_mut().zip(&seen).enumerate() {
                    let way = direction.map(|part| part[l]);
                    moment::add(&mut sum.moment, &moment::from_direction(seen.light, way));
                }
            }
        }
        sums.map(|sum| sum.mean(settings.rays))
    }

    /// Returns `E/2 = ½∫L cosθ dθ` of a face: the mean over rays that start evenly along the face and
    /// leave with a density of ½cosθ.
    #[inline(always)]
    fn over_face<S: Simd>(&self, simd: S, cell: u32, face: usize) -> Mean {
        let rays = self.scene.settings.rays;
        let [x, y] = self.place(cell);
        let along = if NORMALS[face][0] == 0 { x } else { y };
        let jitter = noise::jitter_along(along, self.frame, self.seed);
        // The origins take another part of the noise than the directions.
        let shift = self.jitter(x + 17 * (face as u32 + 1), y + 29);
        let normal = NORMALS[face].map(|n| n as f32);
        let tangent = [-normal[1], normal[0]];
        let center = [x as f32 + 0.5 + 0.5 * normal[0], y as f32 + 0.5 + 0.5 * normal[1]];
        let open = [x as f32 + normal[0], y as f32 + normal[1]].map(|c| f32x16::splat(simd, c));
        let lane = f32x16::from_fn(simd, |l| l as f32);
        let mut sum = Sum::default();
        for first in (0..rays).step_by(LANES) {
            let i = (lane + first as f32).min((rays - 1) as f32);
            let sin = (i + jitter) * (2.0 / rays as f32) - 1.0;
            let cos = (-(sin * sin) + 1.0).max(0.0).sqrt();
            let along = (i * GOLDEN_RATIO + shift).fract() - 0.5;
            let ray = Ray {
                from: std::array::from_fn(|a| along * tangent[a] + center[a]),
                cell: open,
                direction: std::array::from_fn(|a| cos * normal[a] + sin * tangent[a]),
            };
            let count = LANES.min((rays - first) as usize);
            let seen = self.scene.march(simd, ray, true);
            for (ray, seen) in (first..).zip(&seen[..count]) {
                sum.add(ray, seen);
            }
        }
        sum.mean(rays)
    }

    #[inline(always)]
    fn place(&self, cell: u32) -> [u32; 2] {
        let w = self.scene.grid.size[0] as u32;
        [cell % w, cell / w]
    }

    #[inline(always)]
    fn jitter(&self, x: u32, y: u32) -> f32 {
        noise::jitter(self.scene.settings.noise, x, y, self.frame, self.seed)
    }
}

/// The mean over rays.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mean {
    pub light: Rgb,
    /// Its first moment; 0 on faces, and if it was not asked for.
    pub moment: Moment,
    /// Variance of the luminance's noise: `Σ (A − B)² / rays²` over sectors of [`SECTOR`] rays, with
    /// A and B the sums over every other ray. Over the whole circle at once, two lights would cancel
    /// wherever an even ray meets one and an odd ray the other.
    pub variance: f32,
    /// True if any ray met matter that changed since the frame before.
    pub changed: bool,
}

/// Rays added up.
#[derive(Clone, Copy, Default)]
struct Sum {
    light: Rgb,
    moment: Moment,
    /// Luminance of even rays minus that of odd ones, over the current sector.
    alternating: f32,
    /// Sum of its squares over the sectors before.
    squares: f32,
    changed: bool,
}

impl Sum {
    #[inline(always)]
    fn add(&mut self, ray: u32, seen: &Seen) {
        (0..3).for_each(|c| self.light[c] += seen.light[c]);
        if ray.is_multiple_of(SECTOR) {
            self.squares += self.alternating * self.alternating;
            self.alternating = 0.0;
        }
        let sign = if ray.is_multiple_of(2) { 1.0 } else { -1.0 };
        self.alternating += sign * luminance(seen.light);
        self.changed |= seen.changed;
    }

    #[inline(always)]
    fn mean(self, rays: u32) -> Mean {
        let weight = 1.0 / rays as f32;
        Mean {
            light: self.light.map(|v| v * weight),
            moment: self.moment.map(|part| part.map(|v| v * weight)),
            variance: (self.squares + self.alternating * self.alternating) * weight * weight,
            changed: self.changed,
        }
    }
}
