//! Means over rays: the fluence at a cell's centre, and what the faces of a wall receive.

use super::march::{Field, Ray, Seen};
use crate::settings::{Noise, Raymarch, Spacing};
use crate::stages::bounce::{Faces, NORMALS, Wall};
use crate::stages::noise;
use std::f32::consts::TAU;

/// The golden angle as seed 1 writes it, radians.
const GOLDEN_ANGLE: f32 = std::f32::consts::PI * 0.763_932_02;
/// The golden ratio's fraction: spreads ray origins along a face.
const GOLDEN_RATIO: f32 = 0.618_034;

/// Directions of a pixel's rays before each pixel's own turn, unit vectors.
#[derive(Debug, Default)]
pub struct Directions(Vec<[f32; 2]>);

impl Directions {
    /// Fills the table for these settings.
    pub fn prepare(&mut self, settings: &Raymarch) {
        let between = match settings.spacing {
            Spacing::Even => TAU / settings.rays as f32,
            Spacing::Golden => GOLDEN_ANGLE,
        };
        self.0.clear();
        self.0.extend((0..settings.rays).map(|i| {
            let angle = (f64::from(between) * f64::from(i)) as f32 % TAU;
            [angle.cos(), angle.sin()]
        }));
    }
}

/// What stays the same during one gather.
#[derive(Clone, Copy)]
pub struct Gather<'a> {
    pub field: Field<'a>,
    pub directions: &'a Directions,
    pub frame: u32,
    pub seed: u64,
}

impl Gather<'_> {
    /// Fluence at the centre of cell (x, y): the mean radiance over all directions.
    #[inline]
    pub fn fluence(&self, x: u32, y: u32) -> Seen {
        let settings = self.field.settings;
        let turn = self.start(settings.noise, x, y);
        // Evenly spaced rays repeat after one gap, so that is how far they need to be turned.
        let turn = match settings.spacing {
            Spacing::Even => turn * TAU / settings.rays as f32,
            Spacing::Golden => turn * TAU,
        };
        let (sin, cos) = turn.sin_cos();
        let from = [x as f32 + 0.5, y as f32 + 0.5];
        let cell = [x as i32, y as i32];
        self.mean(self.directions.0.iter().map(|d| Ray {
            from,
            cell,
            direction: [d[0] * cos - d[1] * sin, d[0] * sin + d[1] * cos],
        }))
    }

    /// Light that each exposed face of a wall receives: `B = ½∫L cosθ dθ`, the mean over rays
    /// that start evenly along the face and leave with a density of ½cosθ.
    pub fn faces(&self, wall: &Wall) -> (Faces, bool) {
        let w = self.field.optics.width;
        let (x, y) = (wall.cell as i32 % w, wall.cell as i32 / w);
        let mut received = Faces::default();
        let mut changed = false;
        for (face, normal) in NORMALS.into_iter().enumerate() {
            if wall.exposed[face] {
                let seen = self.face(x, y, face, normal);
                received[face] = seen.light;
                changed |= seen.changed;
            }
        }
        (received, changed)
    }

    fn face(&self, x: i32, y: i32, face: usize, normal: [i32; 2]) -> Seen {
        let noise = self.field.settings.noise;
        let (px, py) = (x as u32, y as u32);
        let turn = self.start(noise, px, py);
        // Another place of the pattern for where the rays start.
        let shift = self.start(noise, px + 17 * (face as u32 + 1), py + 29);
        let normal = normal.map(|n| n as f32);
        let tangent = [-normal[1], normal[0]];
        let center = [x as f32 + 0.5 + 0.5 * normal[0], y as f32 + 0.5 + 0.5 * normal[1]];
        let cell = [x + normal[0] as i32, y + normal[1] as i32];
        let rays = self.field.settings.rays;
        self.mean((0..rays).map(|i| {
            let sin = 2.0 * (i as f32 + turn) / rays as f32 - 1.0;
            let cos = (1.0 - sin * sin).max(0.0).sqrt();
            let along = (i as f32 * GOLDEN_RATIO + shift).fract() - 0.5;
            Ray {
                from: std::array::from_fn(|a| center[a] + along * tangent[a]),
                cell,
                direction: std::array::from_fn(|a| cos * normal[a] + sin * tangent[a]),
            }
        }))
    }

    #[inline]
    fn start(&self, noise: Noise, x: u32, y: u32) -> f32 {
        noise::first_angle(noise, x, y, self.frame, self.seed)
    }

    #[inline]
    fn mean(&self, rays: impl ExactSizeIterator<Item = Ray>) -> Seen {
        let share = 1.0 / rays.len() as f32;
        let mut sum = Seen::default();
        for ray in rays {
            let seen = self.field.march(ray);
            (0..3).for_each(|c| sum.light[c] += seen.light[c]);
            sum.changed |= seen.changed;
        }
        Seen { light: sum.light.map(|v| v * share), changed: sum.changed }
    }
}
