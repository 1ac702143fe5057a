//! The march of one ray.
//!
//! Far from matter a ray leaps by the distance field (sphere tracing, Hart 1996); within about a
//! px of it, it goes from cell edge to cell edge (Amanatides and Woo 1987), so that lengths in fog
//! and ends at walls are exact and no solid cell is ever stepped over.
//!
//! A ray through the exact corner of four cells goes from one to the diagonally opposite one; where
//! both cells beside the corner are solid it ends there, so that walls of diagonally touching cells
//! hold light back.

use super::optics::{Kind, Optics, exp_negative};
use crate::Rgb;
use crate::settings::{Hit, Raymarch};
use crate::stages::bounce::{Surfaces, mean_over_faces};
use crate::stages::seed::{NONE, unpack};

/// Least clearance in px that makes a leap worth its cost.
const LEAP: f32 = 1.0;
/// Clearance at which a ray that goes cell by cell leaps again: higher than [`LEAP`], as coming
/// back to cells costs.
const LEAP_AGAIN: f32 = 2.0;
/// Transmittance under which what lies behind no longer counts.
const OPAQUE: f32 = 1e-5;

/// Where a ray starts, in which cell, and its unit direction.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub from: [f32; 2],
    pub cell: [i32; 2],
    pub direction: [f32; 2],
}

/// What a ray brings back.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    pub light: Rgb,
    /// Whether it met matter that changed since the frame before.
    pub changed: bool,
}

/// Everything that rays read during one gather.
#[derive(Clone, Copy)]
pub struct Field<'a> {
    pub settings: &'a Raymarch,
    pub optics: &'a Optics,
    pub surfaces: &'a Surfaces,
    pub distance: &'a [f32],
    pub nearest: &'a [u32],
}

/// A ray on its way: what it has gathered and what still gets through.
struct Path {
    seen: Seen,
    through: Rgb,
    travelled: f32,
}

impl Path {
    fn start() -> Self {
        Self { seen: Seen::default(), through: [1.0; 3], travelled: 0.0 }
    }

    #[inline]
    fn add(&mut self, radiance: Rgb) {
        for c in 0..3 {
            self.seen.light[c] += self.through[c] * radiance[c];
        }
    }
}

/// Steps from cell edge to cell edge along a ray.
struct Walk {
    step: [i32; 2],
    /// px along the ray between two edges of an axis.
    stride: [f32; 2],
    inverse: [f32; 2],
}

impl Walk {
    #[inline]
    fn new(direction: [f32; 2]) -> Self {
        // An axis along which the ray does not move is never crossed.
        let inverse = direction.map(|d| if d.abs() < 1e-12 { 1e12 } else { 1.0 / d });
        let step = direction.map(|d| if d < 0.0 { -1 } else { 1 });
        Self { step, stride: inverse.map(f32::abs), inverse }
    }

    /// px along the ray from `at` in `cell` to the next edge of each axis.
    #[inline]
    fn edges(&self, at: [f32; 2], cell: [i32; 2]) -> [f32; 2] {
        std::array::from_fn(|a| {
            let edge = (cell[a] + (self.step[a] > 0) as i32) as f32;
            ((edge - at[a]) * self.inverse[a]).abs()
        })
    }

    /// The face by which a step along `axis` enters a cell: left, right, top, bottom.
    #[inline]
    fn face(&self, axis: usize) -> usize {
        2 * axis + (self.step[axis] < 0) as usize
    }
}

impl Field<'_> {
    /// Radiance that arrives along a ray.
    #[inline]
    pub fn march(&self, ray: Ray) -> Seen {
        match self.settings.hit {
            Hit::Edge => self.march_to_edge(ray),
            Hit::Distance => self.march_to_distance(ray),
        }
    }

    #[inline]
    fn index(&self, cell: [i32; 2]) -> Option<usize> {
        let inside = (cell[0] as u32) < self.optics.width as u32
            && (cell[1] as u32) < self.optics.height as u32;
        inside.then(|| (cell[1] * self.optics.width + cell[0]) as usize)
    }

    #[inline]
    fn is_solid(&self, cell: [i32; 2]) -> bool {
        self.index(cell).is_some_and(|i| self.optics.sites[i].kind == Kind::Solid)
    }

    fn march_to_edge(&self, ray: Ray) -> Seen {
        let Ray { from: mut at, mut cell, direction } = ray;
        let mut path = Path::start();
        let mut walk = None;
        let mut steps = self.settings.steps;
        let Some(mut index) = self.index(cell) else { return self.leave(path, direction) };
        loop {
            // Leap while the way is clear.
            let mut site = self.optics.sites[index];
            while site.clearance >= LEAP {
                at[0] += direction[0] * site.clearance;
                at[1] += direction[1] * site.clearance;
                path.travelled += site.clearance;
                // Truncation rounds towards 0, so what is left of or above the grid comes first.
                if at[0] < 0.0 || at[1] < 0.0 {
                    return self.leave(path, direction);
                }
                cell = [at[0] as i32, at[1] as i32];
                let Some(i) = self.index(cell) else { return self.leave(path, direction) };
                index = i;
                site = self.optics.sites[index];
                steps = steps.saturating_sub(1);
            }

            // Go from edge to edge until it is clear again.
            let walk = walk.get_or_insert_with(|| Walk::new(direction));
            let mut edges = walk.edges(at, cell);
            let mut t = 0.0;
            loop {
                let next = edges[0].min(edges[1]);
                path.seen.changed |= site.changed;
                if site.kind == Kind::Medium && self.cross(&mut path, index, next - t) {
                    return path.seen;
                }
                path.travelled += next - t;
                t = next;
                let axis = (edges[1] < edges[0]) as usize;
                if edges[0] == edges[1] {
                    let beside =
                        [[cell[0] + walk.step[0], cell[1]], [cell[0], cell[1] + walk.step[1]]];
                    if self.is_solid(beside[0]) && self.is_solid(beside[1]) {
                        cell = beside[0];
                        return self.arrive(path, cell, walk.face(0));
                    }
                    cell = [beside[0][0], beside[1][1]];
                    edges = [edges[0] + walk.stride[0], edges[1] + walk.stride[1]];
                } else {
                    cell[axis] += walk.step[axis];
                    edges[axis] += walk.stride[axis];
                }
                let Some(i) = self.index(cell) else { return self.leave(path, direction) };
                index = i;
                site = self.optics.sites[index];
                if site.kind == Kind::Solid {
                    return self.arrive(path, cell, walk.face(axis));
                }
                if steps == 0 {
                    return path.seen;
                }
                steps -= 1;
                if site.clearance >= LEAP_AGAIN {
                    at = [at[0] + direction[0] * t, at[1] + direction[1] * t];
                    break;
                }
            }
        }
    }

    /// The march of the seeds: steps by the distance field until it falls under `hit_distance`.
    /// Steps longer than what is known to be clear go from edge to edge and end at the first
    /// occupied cell, so that none is stepped over.
    fn march_to_distance(&self, ray: Ray) -> Seen {
        let Ray { from: mut at, mut cell, direction } = ray;
        let mut path = Path::start();
        let walk = Walk::new(direction);
        for _ in 0..self.settings.steps {
            let Some(index) = self.index(cell) else { return self.leave(path, direction) };
            path.seen.changed |= self.optics.sites[index].changed;
            let distance = self.distance_at(at);
            if distance == f32::INFINITY {
                return self.leave(path, direction);
            }
            if distance < self.settings.hit_distance && self.nearest[index] != NONE {
                return self.touch(path, self.nearest[index]);
            }
            let advance = distance.max(self.settings.least_step);
            path.travelled += advance;
            if advance > self.optics.sites[index].clearance {
                let mut edges = walk.edges(at, cell);
                while edges[0].min(edges[1]) < advance {
                    let axis = (edges[1] < edges[0]) as usize;
                    cell[axis] += walk.step[axis];
                    edges[axis] += walk.stride[axis];
                    let Some(i) = self.index(cell) else { return self.leave(path, direction) };
                    if self.optics.sites[i].kind != Kind::Clear {
                        return self.touch(path, self.nearest[i]);
                    }
                }
            }
            at = [at[0] + direction[0] * advance, at[1] + direction[1] * advance];
            cell = at.map(|v| v.floor() as i32);
        }
        path.seen
    }

    /// The distance field between cell centres, in px.
    fn distance_at(&self, at: [f32; 2]) -> f32 {
        let [x, y] = at.map(|v| v - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (fx, fy) = (x - left, y - top);
        let column = |x: f32| (x as i32).clamp(0, self.optics.width - 1);
        let row = |y: f32| (y as i32).clamp(0, self.optics.height - 1) * self.optics.width;
        let d = |x: f32, y: f32| self.distance[(row(y) + column(x)) as usize];
        let above = d(left, top) * (1.0 - fx) + d(left + 1.0, top) * fx;
        let below = d(left, top + 1.0) * (1.0 - fx) + d(left + 1.0, top + 1.0) * fx;
        above * (1.0 - fy) + below * fy
    }

    /// Crosses `length` px of fog or glass; true when nothing gets through any more.
    #[inline]
    fn cross(&self, path: &mut Path, index: usize, length: f32) -> bool {
        let log = self.optics.log_transmittance[index];
        let first = exp_negative(log[0] * length);
        let t = if log[1] == log[0] && log[2] == log[0] {
            [first; 3]
        } else {
            [first, exp_negative(log[1] * length), exp_negative(log[2] * length)]
        };
        let source = self.attenuate(self.optics.source[index], path.travelled);
        path.add(std::array::from_fn(|c| (1.0 - t[c]) * source[c]));
        (0..3).for_each(|c| path.through[c] *= t[c]);
        path.through[0].max(path.through[1]).max(path.through[2]) < OPAQUE
    }

    /// Out of the grid: the sky.
    #[inline]
    fn leave(&self, mut path: Path, direction: [f32; 2]) -> Seen {
        path.add(self.optics.sky.radiance(direction[1]));
        path.seen
    }

    /// At a face of a wall.
    #[inline]
    fn arrive(&self, path: Path, cell: [i32; 2], face: usize) -> Seen {
        let index = (cell[1] * self.optics.width + cell[0]) as usize;
        let sent = self.surfaces.slot(index).map(|slot| self.surfaces.wall_sent[slot][face]);
        self.end(path, index, sent)
    }

    /// At an occupied cell, by the seeds' rule: whichever side of it.
    fn touch(&self, path: Path, seed: u32) -> Seen {
        let [x, y] = unpack(seed);
        let index = y as usize * self.optics.width as usize + x as usize;
        let solid = self.optics.sites[index].kind == Kind::Solid;
        let sent = self.surfaces.slot(index).filter(|_| solid).map(|slot| {
            mean_over_faces(&self.surfaces.walls[slot], &self.surfaces.wall_sent[slot])
        });
        self.end(path, index, sent)
    }

    #[inline]
    fn end(&self, mut path: Path, index: usize, sent: Option<Rgb>) -> Seen {
        path.seen.changed |= self.optics.sites[index].changed;
        let (emission, sent) = (self.optics.source[index], sent.unwrap_or_default());
        let radiance = std::array::from_fn(|c| emission[c] + sent[c]);
        path.add(self.attenuate(radiance, path.travelled));
        path.seen
    }

    /// Seed 1's fading of emission with distance, where it is switched on.
    #[inline]
    fn attenuate(&self, radiance: Rgb, travelled: f32) -> Rgb {
        if !self.settings.attenuation {
            return radiance;
        }
        let range = self.settings.emission_range * self.optics.height as f32;
        let share = (1.0 - (travelled / range).powi(2)).max(0.0);
        radiance.map(|v| v * share.powf(self.settings.emission_dropoff))
    }
}
