//! `holographic`: long rays composed of shorter rays, without noise (Freeman, Sannikov and Margel
//! 2025).
//!
//! The light of a quarter of the circle, within 45° of an axis, is found in three steps:
//!
//! 1. **Extend** ([`extend`]): intervals, the radiance and transmittance of rays from plane to plane.
//!    The shortest are traced ([`trace`]), each longer level is composed of the one before.
//! 2. **Merge** ([`merge`]): light through cones, from the far end of the grid to the near end.
//! 3. **Final gather** ([`gather`]): pixels trace the few px to the next plane themselves.
//!
//! Four quadrants make the mean radiance: `J = Σ ∫ L dω / 2π`. On every face of a wall the same rays
//! make the irradiance `½ ∫ L cosθ dω`, shaded by the steps of the wall itself ([`faces`]).
//!
//! Differences from the published method ([`paper`], which `variant = "paper"` runs): dense directions
//! instead of even ones, which also remove the checkerboard; bundles instead of single rays; cones that
//! overlap, which removes bricks; planes of even index taken over exactly; and the final gather, which
//! removes the stars around small lights.
//!
//! If `lattice_spacing` is 2 or 4, planes and their points lie that many px apart. Rays still cross every cell, and a point
//! stands for open rows side by side ([`point_rows`]), so no wall lets light through. Between the points of a plane pixels
//! read the same curve ([`fine_rows`]).
//!
//! A bounce solves the quadrants for the surfaces only, with the radiance that they reflected the time
//! before. With feedback the quadrants are solved once, with the radiance that surfaces reflected in the
//! frame before.
//!
//! All of it is one sweep over the planes from the far end of the grid to the near one, so that no
//! level is ever held whole.
//!
//! Settings: [`crate::settings::Holographic`].
//!
//! Cost: about N² log N for an N×N grid, less where space is empty; memory some hundred bytes per
//! cell.
//!
//! Known failures: up to 5 % of error at the worst angle of a ring around a light; a ripple of half a
//! percent far from small lights, more on the diagonals; where a plane of the lattice cuts a light, its
//! two halves together look up to a third of a px too wide.

mod axis_sweep;
mod border;
mod debug_view;
mod extend;
mod faces;
mod fine_rows;
mod gather;
mod interval;
pub mod lattice;
mod merge;
pub mod paper;
mod point_rows;
mod prefilter;
mod published;
mod row_bits;
mod slabs;
mod trace;

pub use border::{border_view, is_shared};
pub use faces::REACH;
pub use merge::WEIGHT_EPSILON;
pub use prefilter::exchanged;
pub use slabs::{EMISSIVE, MATTER, MEDIUM, PRIMARY, SMALL};

use crate::clock::Clock;
use crate::settings::{self, Bounces, Variant};
use crate::stages::bounce::{FrameBounces, Surfaces, Wall, mean_over_faces, solve_bounces};
use crate::stages::direct::DirectLight;
use crate::stages::faces::Faces;
use crate::{Cells, Light, Moment, Rgb};
use axis_sweep::{AxisSweep, SweepInput, Wanted};
use faces::{Receivers, cell_in_front};
use fearless_simd::Level;
use published::Published;
use rayon::prelude::*;
use slabs::Axis;
use std::f32::consts::TAU;

/// The method with its buffers.
#[derive(Debug)]
pub struct Holographic {
    level: Level,
    surfaces: Surfaces,
    /// Those of the frame before, for feedback.
    before: Surfaces,
    receivers: Receivers,
    sweeps: [AxisSweep; 2],
    /// The light at surfaces: irradiance of the faces of walls, mean radiance in media.
    wall_light: Vec<Faces>,
    medium_light: Vec<Rgb>,
    published: Published,
}

impl Default for Holographic {
    fn default() -> Self {
        Self::on(Level::new())
    }
}

impl Holographic {
    /// Returns the surfaces of the last frame, with the light that they send on.
    pub(crate) fn surfaces(&self) -> &Surfaces {
        &self.surfaces
    }

    /// Creates the method for a vector unit. Units differ in time, not in light.
    fn on(level: Level) -> Self {
        Self {
            level,
            surfaces: Surfaces::default(),
            before: Surfaces::default(),
            receivers: Receivers::default(),
            sweeps: [Axis::X, Axis::Y].map(AxisSweep::new),
            wall_light: Vec::new(),
            medium_light: Vec::new(),
            published: Published::default(),
        }
    }

    /// Solves one frame into `light`.
    pub(crate) fn solve(
        &mut self,
        cells: &Cells,
        settings: &settings::Holographic,
        FrameBounces { bounces, moved, known }: FrameBounces,
        direct: &DirectLight,
        light: &mut Light,
        clock: &mut Clock,
    ) {
        if settings.variant == Variant::Paper {
            self.published.solve(cells, bounces, direct, &mut light.rgb);
            clock.lap("holographic");
            return;
        }
        if bounces == Bounces::Feedback {
            std::mem::swap(&mut self.surfaces, &mut self.before);
        }
        let Self { surfaces, receivers, .. } = self;
        rayon::join(|| surfaces.collect(cells, 0.0), || receivers.read_open(cells));
        receivers.add_surfaces(cells, surfaces);
        clock.lap("surfaces");
        if let Some(known) = known {
            surfaces.send(known.light);
            if known.bounce {
                self.sweep(cells, settings, true, Wanted::Surfaces);
                self.bounce(cells, direct);
                clock.lap("bounce");
                return;
            }
        }
        let bounces_at_all = bounces != Bounces::Count(0) && surfaces.reflects_or_scatters();
        let feedback = bounces_at_all && bounces == Bounces::Feedback;
        let mut reflected = feedback || known.is_some_and(|known| !known.light.is_empty());
        if feedback {
            surfaces.take_over(&self.before, moved);
        } else if bounces_at_all {
            solve_bounces(bounces, || {
                self.sweep(cells, settings, reflected, Wanted::Surfaces);
                reflected = true;
                self.bounce(cells, direct)
            });
            clock.lap("bounce");
        }
        let wanted = if light.moment.is_some() { Wanted::Moment } else { Wanted::Light };
        self.sweep(cells, settings, reflected, wanted);
        clock.lap("holographic");
        self.write(cells, light);
        clock.lap("gather");
        if feedback {
            self.bounce(cells, direct);
            clock.lap("bounce");
        }
    }

    /// Drops what surfaces reflected in the frame before.
    pub(crate) fn reset(&mut self) {
        self.surfaces.clear();
    }

    /// Finds the light of all four quadrants. `reflected`: with the radiance that surfaces reflect.
    fn sweep(
        &mut self,
        cells: &Cells,
        settings: &settings::Holographic,
        reflected: bool,
        wanted: Wanted,
    ) {
        let input = SweepInput {
            cells,
            surfaces: reflected.then_some(&self.surfaces),
            receivers: &self.receivers,
            wanted,
            settings,
        };
        let [x, y] = &mut self.sweeps;
        let level = self.level;
        rayon::join(|| x.solve(level, input), || y.solve(level, input));
    }

    /// Returns the mean radiance at a cell.
    fn mean_radiance(&self, x: usize, y: usize) -> Rgb {
        let [a, b] = [self.sweeps[0].light(x, y), self.sweeps[1].light(x, y)];
        [a[0] + b[0], a[1] + b[1], a[2] + b[2]].map(|v| v * (1.0 / TAU))
    }

    /// Returns the irradiance of the exposed faces of a wall.
    fn irradiance(&self, wall: usize, exposed: [bool; 4], width: usize) -> Faces {
        std::array::from_fn(|face| {
            if !exposed[face] {
                return [0.0; 3];
            }
            let slot = self.receivers.slot(cell_in_front(wall, face, width));
            let [a, b] = self.sweeps.each_ref().map(|sweep| sweep.face(slot, face));
            std::array::from_fn(|c| 0.5 * (a[c] + b[c]))
        })
    }

    /// Writes the light of all cells: mean radiance in open ones, in walls the mean over their faces; and the first
    /// moment in open ones.
    fn write(&self, cells: &Cells, light: &mut Light) {
        let w = cells.width() as usize;
        let [columns, rows] = &self.sweeps;
        light.rgb.resize(cells.len(), [0.0; 3]);
        let sums: Slabwise = [&|c, x| columns.slab(c, x), &|c, y| rows.slab(c, y)];
        write_mean(w, sums, &mut light.rgb, |light, mean| *light = mean);
        if let Some(moment) = &mut light.moment {
            moment.resize(cells.len(), Moment::default());
            for a in 0..2 {
                let sums: Slabwise =
                    [&|c, x| columns.moment_slab(a, c, x), &|c, y| rows.moment_slab(a, c, y)];
                write_mean(w, sums, moment, |moment, mean| moment[a] = mean);
            }
        }
        for wall in &self.surfaces.walls {
            let cell = wall.cell as usize;
            light.rgb[cell] = mean_over_faces(wall, &self.irradiance(cell, wall.exposed, w));
        }
    }

    /// Turns the light at surfaces into the radiance that they reflect or scatter. Returns
    /// the largest change relative to the mean.
    fn bounce(&mut self, cells: &Cells, direct: &DirectLight) -> f32 {
        let w = cells.width() as usize;
        let mut wall_light = std::mem::take(&mut self.wall_light);
        let mut medium_light = std::mem::take(&mut self.medium_light);
        let Surfaces { walls, media, .. } = &self.surfaces;
        let irradiance = |wall: &Wall| self.irradiance(wall.cell as usize, wall.exposed, w);
        let mean_radiance = |&i: &u32| self.mean_radiance(i as usize % w, i as usize / w);
        wall_light.clear();
        wall_light.extend(walls.iter().map(irradiance));
        medium_light.clear();
        medium_light.extend(media.iter().map(mean_radiance));
        let (on_walls, in_media) = (wall_light.iter(), medium_light.iter());
        let change = self.surfaces.reflect_and_scatter(cells, direct, on_walls, in_media);
        (self.wall_light, self.medium_light) = (wall_light, medium_light);
        change
    }
}

/// Integrals that are stored by columns and by rows: by channel, and the number of the column or row.
type Slabwise<'s, 'a> = [&'s (dyn Fn(usize, usize) -> &'a [f32] + Sync); 2];

/// Writes the mean over the circle of integrals.
fn write_mean<'a, T: Send>(
    width: usize,
    [columns, rows]: Slabwise<'_, 'a>,
    to: &mut [T],
    write: impl Fn(&mut T, Rgb) + Sync,
) {
    // Block by block: one sweep holds columns and the other rows.
    to.par_chunks_mut(BLOCK * width).enumerate().for_each(|(block, to)| {
        let top = block * BLOCK;
        for from in (0..width).step_by(BLOCK) {
            let size = BLOCK.min(width - from);
            let mut transposed = [[[0.0; 3]; BLOCK]; BLOCK];
            for c in 0..3 {
                for x in 0..size {
                    let column = &columns(c, from + x)[top..][..BLOCK];
                    for (row, sum) in transposed.iter_mut().zip(column) {
                        row[x][c] = *sum;
                    }
                }
            }
            for (row, to) in to.chunks_exact_mut(width).enumerate() {
                let sums = [0, 1, 2].map(|c| &rows(c, top + row)[from..][..size]);
                let to = &mut to[from..][..size];
                for (x, (to, column)) in to.iter_mut().zip(transposed[row]).enumerate() {
                    let mean = |c: usize| (column[c] + sums[c][x]) * (1.0 / TAU);
                    write(to, [mean(0), mean(1), mean(2)]);
                }
            }
        }
    });
}

/// Side of the blocks in which light is written, px: a few cache lines.
const BLOCK: usize = 16;

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::super::vector_units::{agree, cells};
    use super::*;

    /// Units with a fused multiply-add round once, the others twice.
    const ROUNDING: f32 = 1e-4;

    #[test]
    fn every_vector_unit_gives_the_same_light() {
        let cells = cells().drawn().into_owned();
        for preset in ["default", "fast", "coarse", "high"] {
            let settings = settings::Holographic::preset(preset).unwrap();
            agree(ROUNDING, |level| {
                let mut light = Light::default();
                let (bounces, direct) =
                    (FrameBounces::here(Bounces::Count(1)), DirectLight::default());
                let mut clock = Clock::default();
                Holographic::on(level)
                    .solve(&cells, &settings, bounces, &direct, &mut light, &mut clock);
                light.rgb
            });
        }
    }
}
