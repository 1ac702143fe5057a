//! What rays meet on their way, and what they bring back.
//!
//! With `hit = "edge"` a ray goes from clear square to clear square ([`packet`]) and from
//! cell edge to cell edge through fog and glass (Amanatides and Woo 1987): lengths are exact, it
//! ends exactly at the face of a wall, and no cell is ever stepped over. A ray through the exact
//! corner of four cells goes by way of one of the two cells beside it; where both are solid it ends
//! there, so walls of diagonally touching cells hold light back.
//!
//! With `hit = "distance"` it is sphere traced (Hart 1996) through the distance field, as in the
//! seeds. What it meets is then the face of the nearest cell that looks its way: a wall never shows
//! the light of its other side.

use crate::Rgb;
use crate::settings::{Hit, Raymarch};
use crate::stages::bounce::Surfaces;
use crate::stages::clearance::{quadrant, side};
use crate::stages::distance::MARGIN;
use crate::stages::optics::{Kind, Optics};
use crate::stages::packet::{self, LANES, Lanes, NEVER, Ray, Why};
use crate::stages::seed::{NONE, unpack};
use crate::stages::transmittance::{OPAQUE, exp_negative};
use fearless_simd::{Simd, f32x16};

/// What a ray brings back.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    pub light: Rgb,
    /// Whether it met matter that changed since the frame before, or a surface that sees some.
    pub changed: bool,
}

/// Everything that rays read during one gather.
#[derive(Clone, Copy)]
pub struct Field<'a> {
    pub settings: &'a Raymarch,
    pub optics: &'a Optics,
    pub surfaces: &'a Surfaces,
    /// Distance field and nearest surfaces; may be empty unless `hit = "distance"`.
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
    #[inline(always)]
    fn add(&mut self, radiance: Rgb) {
        for c in 0..3 {
            self.seen.light[c] += self.through[c] * radiance[c];
        }
    }
}

impl Field<'_> {
    /// Radiance that arrives along sixteen rays that start inside the grid, at centres of cells or
    /// `from_face`s of walls.
    #[inline(always)]
    pub fn march<S: Simd>(&self, simd: S, rays: Ray<f32x16<S>>, from_face: bool) -> Lanes<Seen> {
        let lane = |v: [f32x16<S>; 2], l: usize| [v[0][l], v[1][l]];
        if self.settings.hit == Hit::Distance {
            return std::array::from_fn(|l| {
                let ray = Ray {
                    from: lane(rays.from, l),
                    cell: lane(rays.cell, l),
                    direction: lane(rays.direction, l),
                };
                self.march_to_distance(ray, from_face)
            });
        }
        let stopped = packet::march(simd, self.optics, rays, self.settings.steps);
        let mut seen = [Seen::default(); LANES];
        for (l, seen) in seen.iter_mut().enumerate() {
            let direction = [stopped.direction[0][l], stopped.direction[1][l]];
            let mut path = Path {
                seen: Seen { light: stopped.light.map(|v| v[l]), changed: false },
                through: stopped.through.map(|v| v[l]),
                travelled: stopped.travelled[l],
            };
            *seen = match stopped.why(l) {
                Why::Left => self.leave(&mut path, direction),
                Why::Tired | Why::Reached => path.seen,
                Why::Closed(axis) => {
                    let cell = [stopped.cell[0][l] as i32, stopped.cell[1][l] as i32];
                    let index = (cell[1] * self.optics.width + cell[0]) as usize;
                    if self.optics.sites[index].kind == Kind::Solid {
                        self.arrive(&mut path, index, face(axis, direction))
                    } else {
                        let at = [stopped.at[0][l], stopped.at[1][l]];
                        self.march_through(path, at, cell, direction)
                    }
                }
            };
        }
        seen
    }

    /// Goes on alone from a closed cell that is no wall: one that changed, or fog where light fades
    /// with distance.
    fn march_through(
        &self,
        mut path: Path,
        mut at: [f32; 2],
        mut cell: [i32; 2],
        direction: [f32; 2],
    ) -> Seen {
        let squares = &self.optics.squares[quadrant(direction) * self.optics.sites.len()..];
        let inverse = direction.map(|d| 1.0 / if d.abs() < NEVER { NEVER } else { d });
        let sign = direction.map(|d| if d < 0.0 { -1 } else { 1 });
        let beyond = direction.map(|d| (d < 0.0) as i32);
        let mut index = (cell[1] * self.optics.width + cell[0]) as usize;
        for _ in 0..self.settings.steps {
            let side = side(squares[index]).max(1);
            let next: [i32; 2] = std::array::from_fn(|a| cell[a] + sign[a] * side);
            let edge: [f32; 2] = std::array::from_fn(|a| (next[a] + beyond[a]) as f32);
            let t: [f32; 2] = std::array::from_fn(|a| (edge[a] - at[a]) * inverse[a]);
            let axis = (t[0] >= t[1]) as usize;
            let length = t[axis].max(0.0);
            let site = self.optics.sites[index];
            path.seen.changed |= site.changed;
            if site.kind == Kind::Medium && self.cross(&mut path, index, length) {
                return path.seen;
            }
            path.travelled += length;
            // Along the other axis the ray stays within the square, whatever rounding says.
            let other = 1 - axis;
            let last = next[other] - sign[other];
            let along = at[other] + direction[other] * length;
            (at[axis], at[other]) = (edge[axis], along);
            let (low, high) = (cell[other].min(last), cell[other].max(last));
            cell[other] = (along.floor() as i32).clamp(low, high);
            cell[axis] = next[axis];
            let Some(next) = self.index(cell) else { return self.leave(&mut path, direction) };
            index = next;
            if self.optics.sites[index].kind == Kind::Solid {
                return self.arrive(&mut path, index, face(axis, direction));
            }
        }
        path.seen
    }

    /// The march of the seeds: steps by the distance field until it falls under `hit_distance`,
    /// which a ray from the face of a wall first has to leave. Far from matter steps are as long as
    /// is known to be clear; near it they go from edge to edge and end at the first occupied cell,
    /// so that none is stepped over.
    fn march_to_distance(&self, ray: Ray<f32>, from_face: bool) -> Seen {
        let Ray { from: mut at, cell, direction } = ray;
        let mut cell = cell.map(|v| v as i32);
        let mut path = Path { seen: Seen::default(), through: [1.0; 3], travelled: 0.0 };
        let mut away = !from_face;
        for _ in 0..self.settings.steps {
            let Some(index) = self.index(cell) else { return self.leave(&mut path, direction) };
            path.seen.changed |= self.optics.sites[index].changed;
            if self.nearest[index] == NONE {
                return self.leave(&mut path, direction);
            }
            let distance = self.distance_at(at);
            let near = distance < self.settings.hit_distance;
            if away && near {
                let [x, y] = unpack(self.nearest[index]).map(|v| v as i32);
                return self.touch(&mut path, [x, y], towards([x - cell[0], y - cell[1]]));
            }
            away |= !near;
            let least = self.settings.least_step;
            let clear = self.distance[index] - MARGIN;
            let advance = if clear >= least { distance.min(clear) } else { distance.max(least) };
            let to = std::array::from_fn(|a| at[a] + direction[a] * advance);
            if advance <= clear {
                cell = to.map(|v| v.floor() as i32);
            } else {
                let (reached, entered) = self.walk(at, cell, direction, advance);
                if let Some(face) = entered {
                    return self.touch(&mut path, reached, face);
                }
                cell = reached;
            }
            path.travelled += advance;
            at = to;
        }
        path.seen
    }

    /// Goes `length` px from edge to edge. Returns the cell it ends in, which rounding does not
    /// decide: `at + direction * length` may lie a hair beyond an edge or a corner. Ends early in an
    /// occupied cell, with the face by which it is entered, or outside the grid.
    fn walk(
        &self,
        at: [f32; 2],
        mut cell: [i32; 2],
        direction: [f32; 2],
        length: f32,
    ) -> ([i32; 2], Option<usize>) {
        let inverse = direction.map(|d| 1.0 / if d.abs() < NEVER { NEVER } else { d });
        loop {
            let t: [f32; 2] = std::array::from_fn(|a| {
                ((cell[a] + (direction[a] >= 0.0) as i32) as f32 - at[a]) * inverse[a]
            });
            let axis = (t[0] >= t[1]) as usize;
            if t[axis] >= length {
                return (cell, None);
            }
            cell[axis] += if direction[axis] < 0.0 { -1 } else { 1 };
            match self.index(cell) {
                Some(index) if self.distance[index] > 0.0 => {}
                Some(_) => return (cell, Some(face(axis, direction))),
                None => return (cell, None),
            }
        }
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

    #[inline(always)]
    fn index(&self, cell: [i32; 2]) -> Option<usize> {
        let inside = (cell[0] as u32) < self.optics.width as u32
            && (cell[1] as u32) < self.optics.height as u32;
        inside.then(|| (cell[1] * self.optics.width + cell[0]) as usize)
    }

    /// Crosses `length` px of fog or glass; true when nothing gets through any more.
    #[inline(always)]
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
    #[inline(always)]
    fn leave(&self, path: &mut Path, direction: [f32; 2]) -> Seen {
        path.add(self.optics.sky.radiance(direction[1]));
        path.seen
    }

    /// At a face of a wall.
    #[inline(always)]
    fn arrive(&self, path: &mut Path, index: usize, face: usize) -> Seen {
        let sent = self.surfaces.slot(index).map(|slot| {
            path.seen.changed |= self.surfaces.wall_changed[slot][face];
            self.surfaces.wall_sent[slot][face]
        });
        self.end(path, index, sent)
    }

    /// Near an occupied cell, by the seeds' rule, on the side of one of its faces.
    fn touch(&self, path: &mut Path, [x, y]: [i32; 2], face: usize) -> Seen {
        let index = (y * self.optics.width + x) as usize;
        match self.optics.sites[index].kind {
            Kind::Solid => self.arrive(path, index, face),
            Kind::Clear | Kind::Medium => self.end(path, index, None),
        }
    }

    #[inline(always)]
    fn end(&self, path: &mut Path, index: usize, sent: Option<Rgb>) -> Seen {
        path.seen.changed |= self.optics.sites[index].changed;
        let (emission, sent) = (self.optics.source[index], sent.unwrap_or_default());
        let radiance = std::array::from_fn(|c| emission[c] + sent[c]);
        path.add(self.attenuate(radiance, path.travelled));
        path.seen
    }

    /// Seed 1's fading of emission with distance, where it is switched on.
    #[inline(always)]
    fn attenuate(&self, radiance: Rgb, travelled: f32) -> Rgb {
        if !self.settings.attenuation {
            return radiance;
        }
        let range = self.settings.emission_range * self.optics.height as f32;
        let share = (1.0 - (travelled / range).powi(2)).max(0.0);
        radiance.map(|v| v * share.powf(self.settings.emission_dropoff))
    }
}

/// The face by which a step along `axis` enters a cell: left, right, top, bottom.
#[inline(always)]
fn face(axis: usize, direction: [f32; 2]) -> usize {
    2 * axis + (direction[axis] < 0.0) as usize
}

/// The face by which the straight line between the centres of two cells enters the second.
fn towards(offset: [i32; 2]) -> usize {
    let axis = (offset[0].abs() < offset[1].abs()) as usize;
    face(axis, offset.map(|v| v as f32))
}
