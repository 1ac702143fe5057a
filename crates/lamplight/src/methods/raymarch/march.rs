//! Radiance along rays: from the point where they end, and from media on the way.
//!
//! With `hit = "edge"` a ray goes from square to square of empty space or of one medium
//! ([`packet`]): lengths are exact, it ends exactly at the face of a wall, and no cell is ever
//! stepped over.
//!
//! With `hit = "distance"` it is sphere traced (Hart 1996) through the distance field, as in the
//! sources. It then ends at the face of the nearest cell that points its way: a wall never shows the
//! light of its other side.

use crate::Rgb;
use crate::grid::class::CellClass;
use crate::grid::medium_grid::MediumGrid;
use crate::grid::packet::{self, LANES, Lanes, Termination};
use crate::grid::traverse::{Ray, traverse};
use crate::math::transmittance::{OPAQUE_TRANSMITTANCE, attenuation};
use crate::settings::{Hit, Raymarch};
use crate::stages::bounce::Surfaces;
use crate::stages::distance::MARGIN;
use crate::stages::seed::{NONE, unpack};
use fearless_simd::{Simd, f32x16};
use std::ops::ControlFlow::{Break, Continue};

/// The result of a ray.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    pub light: Rgb,
    /// True if the ray met matter that changed since the frame before, or a surface that sees some.
    pub changed: bool,
}

/// The inputs of rays during one gather.
#[derive(Clone, Copy)]
pub struct RayScene<'a> {
    pub settings: &'a Raymarch,
    pub grid: &'a MediumGrid,
    /// Cells whose matter, or for media what they see, changed since the frame before; may be
    /// empty.
    pub changed: &'a [bool],
    pub surfaces: &'a Surfaces,
    /// Distance field and nearest surfaces; may be empty unless `hit = "distance"`.
    pub distance: &'a [f32],
    pub nearest: &'a [u32],
}

/// A ray on its way: light gathered so far, and the transmittance.
struct RayState {
    seen: Seen,
    transmittance: Rgb,
    travelled: f32,
}

impl RayState {
    #[inline(always)]
    fn add(&mut self, radiance: Rgb) {
        for c in 0..3 {
            self.seen.light[c] += self.transmittance[c] * radiance[c];
        }
    }
}

impl RayScene<'_> {
    /// Returns the radiance along sixteen rays that start inside the grid, at centers of cells or
    /// `from_face`s of walls.
    #[inline(always)]
    pub fn march<S: Simd>(&self, simd: S, rays: Ray<f32x16<S>>, from_face: bool) -> Lanes<Seen> {
        let lane = |v: [f32x16<S>; 2], l: usize| [v[0][l], v[1][l]];
        if self.settings.hit == Hit::Distance {
            return std::array::from_fn(|l| {
                let ray = Ray {
                    from: lane(rays.from, l),
                    cell: lane(rays.cell, l).map(|v| v as i32),
                    direction: lane(rays.direction, l),
                };
                self.march_to_distance(ray, from_face)
            });
        }
        // Compiled once per vector unit, not once per caller.
        let stopped = simd.vectorize(
            #[inline(always)]
            || packet::march(simd, self.grid, rays, self.settings.steps),
        );
        let mut seen = [Seen::default(); LANES];
        for (l, seen) in seen.iter_mut().enumerate() {
            let direction = [stopped.direction[0][l], stopped.direction[1][l]];
            let mut path = RayState {
                seen: Seen { light: stopped.light.map(|v| v[l]), changed: false },
                transmittance: stopped.transmittance.map(|v| v[l]),
                travelled: stopped.travelled[l],
            };
            *seen = match stopped.termination(l) {
                Termination::Escaped => {
                    let at = [stopped.at[0][l], stopped.at[1][l]];
                    self.leave(&mut path, at, direction)
                }
                Termination::StepLimit | Termination::MaxDistance => path.seen,
                Termination::Hit(axis) => {
                    let cell = [stopped.cell[0][l] as i32, stopped.cell[1][l] as i32];
                    let index = self.grid.index(cell);
                    if self.grid.classes[index] == CellClass::Solid {
                        self.arrive(&mut path, index, face(axis, direction))
                    } else {
                        let from = [stopped.at[0][l], stopped.at[1][l]];
                        self.march_through(path, Ray { from, cell, direction })
                    }
                }
            };
        }
        seen
    }

    /// Continues one ray from a cell that stops packets and is not solid: one that changed, or a
    /// medium if light fades with distance.
    fn march_through(&self, mut path: RayState, ray: Ray<f32, i32>) -> Seen {
        let (end, cell) = packet::march_alone(self.grid, ray, self.settings.steps, |i, length| {
            path.seen.changed |= self.has_changed(i);
            if self.grid.classes[i] == CellClass::Medium && self.cross(&mut path, i, length) {
                return false;
            }
            path.travelled += length;
            true
        });
        match end {
            Termination::Escaped => self.leave(&mut path, ray.from, ray.direction),
            Termination::Hit(axis) => {
                self.arrive(&mut path, self.grid.index(cell), face(axis, ray.direction))
            }
            Termination::StepLimit | Termination::MaxDistance => path.seen,
        }
    }

    /// Marches as the sources do: steps by the distance field until it falls under `hit_distance`; a
    /// ray from the face of a wall has to leave that first. Far from matter, steps are as long as is
    /// certainly empty; near it they go from edge to edge and end at the first occupied cell, so that
    /// none is stepped over.
    fn march_to_distance(&self, ray: Ray<f32, i32>, from_face: bool) -> Seen {
        let Ray { from: mut at, mut cell, direction } = ray;
        let mut path = RayState { seen: Seen::default(), transmittance: [1.0; 3], travelled: 0.0 };
        let mut away = !from_face;
        for _ in 0..self.settings.steps {
            let Some(index) = self.index(cell) else {
                return self.leave(&mut path, at, direction);
            };
            path.seen.changed |= self.has_changed(index);
            if self.nearest[index] == NONE {
                return self.leave(&mut path, at, direction);
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
                let (reached, entered) = self.advance(Ray { from: at, cell, direction }, advance);
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
    /// decide: `from + direction * length` may lie next to an edge or a corner. Ends early in an
    /// occupied cell, with the face by which it is entered, or outside the grid.
    fn advance(&self, ray: Ray<f32, i32>, length: f32) -> ([i32; 2], Option<usize>) {
        let mut last = ray.cell;
        let occupied = |cell| self.index(cell).is_some_and(|i| self.distance[i] <= 0.0);
        let end = traverse(ray, [0.0, length], |step| {
            let face = || Some(face(usize::from(!step.along[0]), ray.direction));
            if let Some(cell) = step.blocked(occupied) {
                return Break((cell, face()));
            }
            last = step.cell;
            if step.is_start() {
                return Continue(());
            }
            match self.index(step.cell) {
                Some(index) if self.distance[index] > 0.0 => Continue(()),
                Some(_) => Break((step.cell, face())),
                None => Break((step.cell, None)),
            }
        });
        end.break_value().unwrap_or((last, None))
    }

    /// Returns the distance field, interpolated between cell centers, px.
    fn distance_at(&self, at: [f32; 2]) -> f32 {
        let [width, height] = self.grid.size;
        let [x, y] = at.map(|v| v - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (fx, fy) = (x - left, y - top);
        let column = |x: f32| (x as i32).clamp(0, width - 1);
        let row = |y: f32| (y as i32).clamp(0, height - 1) * width;
        let d = |x: f32, y: f32| self.distance[(row(y) + column(x)) as usize];
        let above = d(left, top) * (1.0 - fx) + d(left + 1.0, top) * fx;
        let below = d(left, top + 1.0) * (1.0 - fx) + d(left + 1.0, top + 1.0) * fx;
        above * (1.0 - fy) + below * fy
    }

    #[inline(always)]
    fn index(&self, cell: [i32; 2]) -> Option<usize> {
        self.grid.holds(cell).then(|| self.grid.index(cell))
    }

    #[inline(always)]
    fn has_changed(&self, index: usize) -> bool {
        self.changed.get(index).is_some_and(|changed| *changed)
    }

    /// Crosses `length` px of a medium; returns true if its transmittance is negligible.
    #[inline(always)]
    fn cross(&self, path: &mut RayState, index: usize, length: f32) -> bool {
        let extinction = self.grid.extinction[index];
        let first = attenuation(extinction[0] * length);
        let crossed = if extinction[1] == extinction[0] && extinction[2] == extinction[0] {
            [first; 3]
        } else {
            [first, attenuation(extinction[1] * length), attenuation(extinction[2] * length)]
        };
        let source = self.attenuate(self.grid.source[index], path.travelled);
        path.add(std::array::from_fn(|c| crossed[c].1 * source[c]));
        (0..3).for_each(|c| path.transmittance[c] *= crossed[c].0);
        path.transmittance.into_iter().fold(0.0, f32::max) < OPAQUE_TRANSMITTANCE
    }

    /// Ends a ray that passes `at` outside the grid: adds what enters there.
    #[inline(always)]
    fn leave(&self, path: &mut RayState, at: [f32; 2], direction: [f32; 2]) -> Seen {
        path.add(self.grid.entering(at, direction));
        path.seen
    }

    /// Ends a ray at a face of a wall.
    #[inline(always)]
    fn arrive(&self, path: &mut RayState, index: usize, face: usize) -> Seen {
        let reflected = self.surfaces.slot(index).map(|slot| {
            path.seen.changed |= self.surfaces.wall_changed[slot][face];
            self.surfaces.wall_reflected[slot][face]
        });
        self.end(path, index, reflected)
    }

    /// Ends a ray near an occupied cell, on the side of one of its faces.
    fn touch(&self, path: &mut RayState, [x, y]: [i32; 2], face: usize) -> Seen {
        let index = self.grid.index([x, y]);
        if self.grid.classes[index] == CellClass::Solid {
            self.arrive(path, index, face)
        } else {
            self.end(path, index, None)
        }
    }

    #[inline(always)]
    fn end(&self, path: &mut RayState, index: usize, reflected: Option<Rgb>) -> Seen {
        path.seen.changed |= self.has_changed(index);
        let (emission, reflected) = (self.grid.source[index], reflected.unwrap_or_default());
        let radiance = std::array::from_fn(|c| emission[c] + reflected[c]);
        path.add(self.attenuate(radiance, path.travelled));
        path.seen
    }

    /// Fades emission with distance (Bigos 2020), if switched on.
    #[inline(always)]
    fn attenuate(&self, radiance: Rgb, travelled: f32) -> Rgb {
        if !self.settings.attenuation {
            return radiance;
        }
        let range = self.settings.emission_range * self.grid.size[1] as f32;
        let weight = (1.0 - (travelled / range).powi(2)).max(0.0);
        radiance.map(|v| v * weight.powf(self.settings.emission_dropoff))
    }
}

/// Returns the face by which a step along `axis` enters a cell: left, right, top, bottom.
#[inline(always)]
fn face(axis: usize, direction: [f32; 2]) -> usize {
    2 * axis + (direction[axis] < 0.0) as usize
}

/// Returns the face by which the straight line between the centers of two cells enters the second.
fn towards(offset: [i32; 2]) -> usize {
    let axis = (offset[0].abs() < offset[1].abs()) as usize;
    face(axis, offset.map(|v| v as f32))
}
