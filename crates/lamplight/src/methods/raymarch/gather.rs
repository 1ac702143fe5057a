//! Means over rays: the fluence at a cell's centre, and what the faces of a wall receive.

use super::march::{Field, Seen};
use crate::Rgb;
use crate::settings::{Raymarch, Spacing};
use crate::srgb::luminance;
use crate::stages::bounce::{Faces, NORMALS, Wall};
use crate::stages::noise;
use crate::stages::packet::{LANES, Lanes, Ray};
use fearless_simd::{Level, dispatch, f32x16, prelude::*};
use std::f32::consts::TAU;

/// The golden angle as seed 1 writes it, radians.
const GOLDEN_ANGLE: f32 = std::f32::consts::PI * 0.763_932_02;
/// The golden ratio's fraction: spreads ray origins along a face.
pub const GOLDEN_RATIO: f32 = 0.618_034;

/// Rays whose noise is taken together; even, so that what is seen all over a sector cancels. Of 2 to
/// 16, and all rays at once, the one with the least error over the example scenes at 32 rays (2 is
/// as good there and worse at 128).
pub const SECTOR: u32 = 4;

/// Radians by which a pixel's rays may be turned before they are the same again: a gap between two
/// where they are evenly spaced.
pub fn gap(settings: &Raymarch) -> f32 {
    match settings.spacing {
        Spacing::Even => TAU / settings.rays as f32,
        Spacing::Golden => TAU,
    }
}

/// Directions of a pixel's rays before each pixel's own turn, unit vectors.
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

/// What stays the same during one gather.
#[derive(Clone, Copy)]
pub struct Gather<'a> {
    pub field: Field<'a>,
    pub directions: &'a Directions,
    pub frame: u32,
    pub seed: u64,
    pub level: Level,
}

impl Gather<'_> {
    /// Fluence at the centres of up to sixteen cells, the mean radiance over all directions; cells
    /// that lie side by side are faster.
    #[inline]
    pub fn fluence(&self, cells: &[u32]) -> Lanes<Mean> {
        dispatch!(self.level, simd => self.over_circle(simd, cells))
    }

    /// Light that each exposed face of a wall receives; and whether anything it sees changed.
    pub fn faces(&self, wall: &Wall) -> (Faces, [bool; 4]) {
        let mut received = Faces::default();
        let mut changed = [false; 4];
        for (face, exposed) in wall.exposed.into_iter().enumerate() {
            if exposed {
                let seen = dispatch!(self.level, simd => self.over_face(simd, wall.cell, face));
                received[face] = seen.light;
                changed[face] = seen.changed;
            }
        }
        (received, changed)
    }

    #[inline(always)]
    fn over_circle<S: Simd>(&self, simd: S, cells: &[u32]) -> Lanes<Mean> {
        let settings = self.field.settings;
        let place = |l: usize| self.place(cells[l.min(cells.len() - 1)]);
        let corner = |a: usize| f32x16::from_fn(simd, |l| place(l)[a] as f32);
        let cell = [corner(0), corner(1)];
        let gap = gap(settings);
        let turn: Lanes<f32> = std::array::from_fn(|l| {
            let [x, y] = place(l);
            self.start(x, y) * gap
        });
        let cos = f32x16::from_fn(simd, |l| turn[l].cos());
        let sin = f32x16::from_fn(simd, |l| turn[l].sin());
        let from = cell.map(|c| c + 0.5);
        let mut sums = [Sum::default(); LANES];
        for (ray, &[x, y]) in self.directions.0.iter().enumerate() {
            let direction = [cos * x - sin * y, sin * x + cos * y];
            let seen = self.field.march(simd, Ray { from, cell, direction }, false);
            for (sum, seen) in sums.iter_mut().zip(&seen) {
                sum.add(ray as u32, seen);
            }
        }
        sums.map(|sum| sum.mean(settings.rays))
    }

    /// `B = ½∫L cosθ dθ` on a face: the mean over rays that start evenly along the face and leave
    /// with a density of ½cosθ.
    #[inline(always)]
    fn over_face<S: Simd>(&self, simd: S, cell: u32, face: usize) -> Mean {
        let rays = self.field.settings.rays;
        let [x, y] = self.place(cell);
        let turn = self.start(x, y);
        // Another place of the pattern for where the rays start.
        let shift = self.start(x + 17 * (face as u32 + 1), y + 29);
        let normal = NORMALS[face].map(|n| n as f32);
        let tangent = [-normal[1], normal[0]];
        let center = [x as f32 + 0.5 + 0.5 * normal[0], y as f32 + 0.5 + 0.5 * normal[1]];
        let open = [x as f32 + normal[0], y as f32 + normal[1]].map(|c| f32x16::splat(simd, c));
        let lane = f32x16::from_fn(simd, |l| l as f32);
        let mut sum = Sum::default();
        for first in (0..rays).step_by(LANES) {
            let i = (lane + first as f32).min((rays - 1) as f32);
            let sin = (i + turn) * (2.0 / rays as f32) - 1.0;
            let cos = (-(sin * sin) + 1.0).max(0.0).sqrt();
            let along = (i * GOLDEN_RATIO + shift).fract() - 0.5;
            let ray = Ray {
                from: std::array::from_fn(|a| along * tangent[a] + center[a]),
                cell: open,
                direction: std::array::from_fn(|a| cos * normal[a] + sin * tangent[a]),
            };
            let count = LANES.min((rays - first) as usize);
            let seen = self.field.march(simd, ray, true);
            for (ray, seen) in (first..).zip(&seen[..count]) {
                sum.add(ray, seen);
            }
        }
        sum.mean(rays)
    }

    #[inline(always)]
    fn place(&self, cell: u32) -> [u32; 2] {
        let w = self.field.optics.width as u32;
        [cell % w, cell / w]
    }

    #[inline(always)]
    fn start(&self, x: u32, y: u32) -> f32 {
        noise::first_angle(self.field.settings.noise, x, y, self.frame, self.seed)
    }
}

/// The mean over rays.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mean {
    pub light: Rgb,
    /// Variance of the luminance's noise: `Σ (A − B)² / rays²` over sectors of [`SECTOR`] rays, with
    /// A and B the sums over every other ray. Over the whole circle at once, two lights would cancel
    /// wherever an even ray meets one and an odd ray the other.
    pub variance: f32,
    /// Whether any ray met matter that changed since the frame before.
    pub changed: bool,
}

/// Rays added up.
#[derive(Clone, Copy, Default)]
struct Sum {
    light: Rgb,
    /// Luminance of even rays less that of odd ones, over the sector at hand.
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
        let share = 1.0 / rays as f32;
        Mean {
            light: self.light.map(|v| v * share),
            variance: (self.squares + self.alternating * self.alternating) * share * share,
            changed: self.changed,
        }
    }
}
