//! `raymarch`: Monte Carlo rays from every pixel (Bigos 2020; Unity port 2023).
//!
//! Every open cell casts `rays` rays round the circle from its center; its light is the mean radiance
//! over them, `J = Σ L / rays`. By default a ray ends exactly at the edge of a solid cell, and media on
//! the way absorb by Beer–Lambert, so the result converges to the truth as rays are added. The error of
//! one frame is noise of about 1/rays to 1/√rays.
//!
//! Bounces gather over the surfaces ([`crate::stages::bounce`]) in the same way, either all in one
//! frame or one more per frame.
//!
//! Settings: `rays` and `steps` (quality), `hit` (exact, or by the distance field as in the sources),
//! `noise` and `spacing` (the look of the noise), `attenuation` and `emission_*` (Bigos' fading),
//! `threshold`.
//!
//! Cost: cells × rays × steps of a ray. Known failures: most rays miss lamps that are small and far
//! away (noise, no bias); with `hit = "distance"` corners are round and media end rays.

mod gather;
mod march;
pub mod window;

use crate::clock::Clock;
use crate::filters::estimate::Estimate;
use crate::grid::class::CellClass;
use crate::grid::medium_grid::{MediumGrid, Reading};
use crate::grid::packet::LANES;
use crate::settings::{Bounces, Hit, Raymarch};
use crate::stages::bounce::{FrameBounces, Surfaces, solve_bounces};
use crate::stages::direct::DirectLight;
use crate::stages::faces::Faces;
use crate::{Cells, moment};
use fearless_simd::Level;
use gather::{Directions, Gather, Mean};
pub use gather::{GOLDEN_RATIO, SECTOR, directions, stride};
use march::RayScene;
use rayon::prelude::*;

/// The settings of a frame, and the fields that rays march through.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    pub settings: &'a Raymarch,
    pub bounces: FrameBounces<'a>,
    /// The seed of the noise.
    pub seed: u64,
    /// The grid, lamps drawn in.
    pub cells: &'a Cells,
    /// The light of lamps that are not drawn.
    pub direct: &'a DirectLight,
    /// Distance to the nearest occupied cell, px; may be empty unless `hit = "distance"`.
    pub distance: &'a [f32],
    /// The nearest occupied cell; may be empty unless `hit = "distance"`.
    pub nearest: &'a [u32],
    /// Cells that changed since the frame before; empty without history.
    pub changed: &'a [bool],
    /// The number of the frame: each has its own noise.
    pub frame: u32,
}

/// The method with its buffers.
#[derive(Debug)]
pub struct RaymarchSolver {
    level: Level,
    directions: Directions,
    grid: MediumGrid,
    /// Cells whose matter, or for media what they see, changed since the frame before.
    changed: Vec<bool>,
    surfaces: Surfaces,
    before: Surfaces,
    irradiance: Irradiance,
}

/// The irradiance of walls and the mean radiance in media, from one gather.
#[derive(Debug, Default)]
struct Irradiance {
    /// Irradiance ÷ 2 per face, and whether anything that the face sees changed.
    walls: Vec<(Faces, [bool; 4])>,
    /// Mean radiance in media.
    media: Vec<Mean>,
}

impl Default for RaymarchSolver {
    fn default() -> Self {
        Self::on(Level::new())
    }
}

impl RaymarchSolver {
    /// Returns the surfaces of the last frame, with the light that they send on.
    pub(crate) fn surfaces(&self) -> &Surfaces {
        &self.surfaces
    }

    /// Runs at the given SIMD level. The result is identical at every level.
    fn on(level: Level) -> Self {
        Self {
            level,
            directions: Directions::default(),
            grid: MediumGrid::default(),
            changed: Vec::new(),
            surfaces: Surfaces::default(),
            before: Surfaces::default(),
            irradiance: Irradiance::default(),
        }
    }

    /// Drops what surfaces reflected in the frame before.
    pub(crate) fn reset(&mut self) {
        self.surfaces.clear();
    }

    /// Solves one frame into `estimate`.
    pub(crate) fn solve(&mut self, input: Input, estimate: &mut Estimate, clock: &mut Clock) {
        let Input { settings, cells, changed, .. } = input;
        self.directions.prepare(settings);
        let Raymarch { threshold, emission_multiplier, .. } = *settings;
        self.grid.read(cells, Reading { threshold, ..Reading::default() });
        self.grid.read_emission(cells, emission_multiplier);
        self.changed.clear();
        self.changed.extend_from_slice(changed);
        self.measure_empty_space(settings);
        std::mem::swap(&mut self.surfaces, &mut self.before);
        self.surfaces.collect(cells, threshold);
        clock.lap("clearance");

        if let Some(known) = input.bounces.known {
            self.surfaces.send(known.light);
            self.scatter(cells, settings);
            if known.bounce {
                self.receive(input);
                self.reflect_and_scatter(input);
                clock.lap("bounce");
                return;
            }
        }
        if input.bounces.bounces != Bounces::Count(0) && self.surfaces.reflects_or_scatters() {
            self.bounce(input);
            clock.lap("bounce");
        }

        self.gather(input, estimate);
        // Steps by the distance field skip cells that changed and are empty now.
        if settings.hit == Hit::Distance && changed.contains(&true) {
            estimate.invalidated.fill(true);
        }
        clock.lap("raymarch");
    }

    /// Lets light bounce between the surfaces.
    fn bounce(&mut self, input: Input) {
        let FrameBounces { bounces, moved, .. } = input.bounces;
        if bounces == Bounces::Feedback {
            self.surfaces.take_over(&self.before, moved);
            self.scatter(input.cells, input.settings);
        }
        solve_bounces(bounces, || {
            self.receive(input);
            self.reflect_and_scatter(input)
        });
    }

    /// Gathers the irradiance of walls and the mean radiance in media.
    fn receive(&mut self, input: Input) {
        let mut irradiance = std::mem::take(&mut self.irradiance);
        let Surfaces { walls, media, .. } = &self.surfaces;
        let gather = self.gatherer(input);
        irradiance.walls.resize(walls.len(), Default::default());
        irradiance.media.resize(media.len(), Default::default());
        irradiance.walls.par_iter_mut().zip(walls).for_each(|(received, wall)| {
            if wall.reflects {
                *received = gather.faces(wall);
            }
        });
        irradiance.media.par_chunks_mut(LANES).zip(media.par_chunks(LANES)).for_each(
            |(received, cells)| {
                received.copy_from_slice(&gather.mean_radiance(cells)[..cells.len()]);
            },
        );
        self.irradiance = irradiance;
    }

    /// Turns irradiance into the radiance that walls reflect and media scatter. Returns the largest change
    /// relative to the mean.
    fn reflect_and_scatter(&mut self, input: Input) -> f32 {
        let Input { cells, direct, settings, .. } = input;
        let Irradiance { walls, media } = &self.irradiance;
        let change = self.surfaces.reflect_and_scatter(
            cells,
            direct,
            walls.iter().map(|(faces, _)| faces),
            media.iter().map(|mean| &mean.light),
        );
        let Surfaces { walls: surfaces, wall_changed, .. } = &mut self.surfaces;
        for ((wall, (_, changed)), before) in surfaces.iter().zip(walls).zip(wall_changed) {
            if wall.reflects {
                // Face by face: one side of a wall sees nothing of the other.
                (0..4).for_each(|face| before[face] |= changed[face]);
            }
        }
        for (&i, _) in self.surfaces.media.iter().zip(media).filter(|(_, mean)| mean.changed) {
            if let Some(changed) = self.changed.get_mut(i as usize) {
                *changed = true;
            }
        }
        self.scatter(cells, settings);
        change
    }

    /// Gives media the light that they scatter.
    fn scatter(&mut self, cells: &Cells, settings: &Raymarch) {
        if self.surfaces.scatter_into(cells, settings.emission_multiplier, &mut self.grid) {
            self.measure_empty_space(settings);
        }
    }

    /// Lets packets of rays stop at solid cells, at cells that changed, and in media if light fades
    /// with distance.
    fn measure_empty_space(&mut self, settings: &Raymarch) {
        let Self { grid, changed, .. } = self;
        let fades = settings.attenuation;
        grid.measure_empty_space(|i, class| {
            changed.get(i) == Some(&true) || (fades && class == CellClass::Medium)
        });
    }

    /// Gathers the light of every cell.
    fn gather(&self, input: Input, estimate: &mut Estimate) {
        let gather = Gather { moment: estimate.moment.is_some(), ..self.gatherer(input) };
        let w = input.cells.width() as usize;
        estimate.resize(input.cells.len());
        let Estimate { light, moment, variance, invalidated } = estimate;
        let rows = light
            .par_chunks_mut(w)
            .zip(invalidated.par_chunks_mut(w))
            .zip(variance.par_chunks_mut(w))
            .zip(moment::chunks(moment.as_deref_mut(), w))
            .enumerate();
        rows.for_each(|(y, (((light, invalidated), variance), mut moment))| {
            let mut put = |i: u32, mean: Mean| {
                let x = i as usize - y * w;
                (light[x], invalidated[x], variance[x]) = (mean.light, mean.changed, mean.variance);
                if let Some(moment) = &mut moment {
                    moment[x] = mean.moment;
                }
            };
            let (mut open, mut count) = ([0; LANES], 0);
            for i in (y * w) as u32..((y + 1) * w) as u32 {
                if input.cells.is_solid(i as usize) {
                    put(i, self.on_wall(&gather, i));
                    continue;
                }
                open[count] = i;
                count += 1;
                if count == LANES {
                    gather.mean_radiance(&open).into_iter().zip(open).for_each(|(s, i)| put(i, s));
                    count = 0;
                }
            }
            if count > 0 {
                let seen = gather.mean_radiance(&open[..count]);
                seen.into_iter().zip(&open[..count]).for_each(|(s, &i)| put(i, s));
            }
        });
    }

    /// Returns the light of a solid cell: the mean over its exposed faces, 0 inside a wall.
    fn on_wall(&self, gather: &Gather, i: u32) -> Mean {
        let slot = self.surfaces.slot(i as usize);
        slot.map_or_else(Mean::default, |slot| gather.mean_irradiance(&self.surfaces.walls[slot]))
    }

    fn gatherer<'a>(&'a self, input: Input<'a>) -> Gather<'a> {
        Gather {
            scene: RayScene {
                settings: input.settings,
                grid: &self.grid,
                changed: &self.changed,
                surfaces: &self.surfaces,
                distance: input.distance,
                nearest: input.nearest,
            },
            directions: &self.directions,
            frame: input.frame,
            seed: input.seed,
            moment: false,
            level: self.level,
        }
    }
}

impl RaymarchSolver {
    /// Returns the empty squares of a quadrant, as the last frame measured them.
    pub(crate) fn squares(&self, quadrant: usize) -> &[u8] {
        self.grid.empty_space.plane(quadrant)
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::super::vector_units::{agree, cells};
    use super::*;

    #[test]
    fn every_vector_unit_gives_the_same_bytes() {
        let cells = cells().drawn().into_owned();
        let input = Input {
            settings: &Raymarch::default(),
            bounces: FrameBounces::here(Bounces::Count(2)),
            seed: 0,
            cells: &cells,
            direct: &DirectLight::default(),
            distance: &[],
            nearest: &[],
            changed: &[],
            frame: 0,
        };
        agree(0.0, |level| {
            let mut estimate = Estimate::default();
            RaymarchSolver::on(level).solve(input, &mut estimate, &mut Clock::default());
            estimate.light
        });
    }
}
