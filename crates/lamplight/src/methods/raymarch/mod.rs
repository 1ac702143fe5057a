//! `raymarch`: jump flood → distance field → rays from every pixel (Bigos 2020; Unity port 2023).
//!
//! Every open cell sends `rays` rays round the circle from its centre and takes the mean of what
//! they meet: `φ = Σ L / rays`. By default a ray ends exactly at the edge of a solid cell, with fog
//! and glass on the way by Beer–Lambert, so the result converges to the truth as rays are added;
//! the error of one frame is noise of about 1/rays to 1/√rays.
//!
//! Bounces gather over the surfaces ([`crate::stages::bounce`]) in the same way, either all inside
//! one frame or one more each frame.
//!
//! Cost: cells × rays × steps of a ray. Known failures: lamps far away and small are missed by most
//! rays (noise, no bias); with `hit = "distance"` corners are round and fog ends rays.

mod gather;
mod march;

use crate::Cells;
use crate::clock::Clock;
use crate::settings::{BounceBy, Bounces, Hit, Settings};
use crate::stages::bounce::{CONVERGED, Faces, Surfaces, mean_over_faces};
use crate::stages::optics::{Optics, Reading};
use crate::stages::packet::LANES;
pub use crate::stages::packet::NEVER;
use crate::stages::traced::Traced;
use fearless_simd::Level;
use gather::{Directions, Gather, Mean};
pub use gather::{GOLDEN_RATIO, SECTOR, directions, gap};
use march::Field;
use rayon::prelude::*;

/// The fields that rays march through, from the stages before.
#[derive(Clone, Copy)]
pub struct Input<'a> {
    /// The grid, lamps drawn in.
    pub cells: &'a Cells,
    /// px to the nearest occupied cell; may be empty unless `hit = "distance"`.
    pub distance: &'a [f32],
    /// The nearest occupied cell; may be empty unless `hit = "distance"`.
    pub nearest: &'a [u32],
    /// Cells that changed since the frame before; empty when nobody asks.
    pub changed: &'a [bool],
    /// Number of the frame: each has its own noise.
    pub frame: u32,
}

/// The method with its buffers.
#[derive(Debug)]
pub struct Raymarch {
    level: Level,
    directions: Directions,
    optics: Optics,
    surfaces: Surfaces,
    before: Surfaces,
    received: Received,
}

/// What surfaces receive in one gather.
#[derive(Debug, Default)]
struct Received {
    walls: Vec<(Faces, [bool; 4])>,
    fog: Vec<Mean>,
}

impl Default for Raymarch {
    fn default() -> Self {
        Self::on(Level::new())
    }
}

impl Raymarch {
    /// On these vector units; which ones makes no difference but to the time.
    fn on(level: Level) -> Self {
        Self {
            level,
            directions: Directions::default(),
            optics: Optics::default(),
            surfaces: Surfaces::default(),
            before: Surfaces::default(),
            received: Received::default(),
        }
    }

    /// Solves one frame into `traced`.
    pub(crate) fn solve(
        &mut self,
        input: Input,
        settings: &Settings,
        traced: &mut Traced,
        clock: &mut Clock,
    ) {
        let Input { cells, changed, .. } = input;
        self.directions.prepare(&settings.raymarch);
        self.optics.prepare(cells, reading(settings), changed);
        std::mem::swap(&mut self.surfaces, &mut self.before);
        self.surfaces.collect(cells, settings.raymarch.threshold);
        clock.lap("clearance");

        if settings.bounces != Bounces::Count(0) && self.surfaces.reflect() {
            self.bounce(input, settings);
            clock.lap("bounce");
        }

        self.gather(input, settings, traced);
        // Leaps by the distance field pass over cells that changed and are empty now.
        if settings.raymarch.hit == Hit::Distance && changed.contains(&true) {
            traced.stale.fill(true);
        }
        clock.lap("raymarch");
    }

    /// Lets light bounce between the surfaces.
    fn bounce(&mut self, input: Input, settings: &Settings) {
        let rounds = match settings.raymarch.bounce {
            BounceBy::Frame => settings.bounces.limit(),
            BounceBy::Feedback => {
                self.surfaces.take_over(&self.before);
                self.optics.light_fog(input.cells, reading(settings), &self.surfaces);
                1
            }
        };
        for _ in 0..rounds {
            self.receive(input, settings);
            let change = self.send_on(input.cells, settings);
            if settings.bounces == Bounces::Converged && change < CONVERGED {
                break;
            }
        }
    }

    /// Gathers what the surfaces that reflect receive.
    fn receive(&mut self, input: Input, settings: &Settings) {
        let mut received = std::mem::take(&mut self.received);
        let Surfaces { walls, fog, .. } = &self.surfaces;
        let gather = self.gatherer(input, settings);
        received.walls.resize(walls.len(), Default::default());
        received.fog.resize(fog.len(), Default::default());
        received.walls.par_iter_mut().zip(walls).for_each(|(received, wall)| {
            if wall.reflects {
                *received = gather.faces(wall);
            }
        });
        received.fog.par_chunks_mut(LANES).zip(fog.par_chunks(LANES)).for_each(
            |(received, cells)| {
                received.copy_from_slice(&gather.fluence(cells)[..cells.len()]);
            },
        );
        self.received = received;
    }

    /// Turns what surfaces received into what they send out; returns the largest change relative
    /// to the mean.
    fn send_on(&mut self, cells: &Cells, settings: &Settings) -> f32 {
        let Received { walls, fog } = &self.received;
        let change = self.surfaces.send_on(
            cells,
            walls.iter().map(|(faces, _)| faces),
            fog.iter().map(|seen| &seen.light),
        );
        let Surfaces { walls: surfaces, wall_changed, .. } = &mut self.surfaces;
        for ((wall, (_, changed)), before) in surfaces.iter().zip(walls).zip(wall_changed) {
            if wall.reflects {
                // Face by face: one side of a wall does not know what the other sees.
                (0..4).for_each(|face| before[face] |= changed[face]);
            }
        }
        for (&i, _) in self.surfaces.fog.iter().zip(fog).filter(|(_, seen)| seen.changed) {
            self.optics.mark_changed(i as usize);
        }
        self.optics.light_fog(cells, reading(settings), &self.surfaces);
        change
    }

    /// The last gather: what every cell receives.
    fn gather(&self, input: Input, settings: &Settings, traced: &mut Traced) {
        let gather = self.gatherer(input, settings);
        let w = input.cells.width() as usize;
        traced.resize(input.cells.len());
        let Traced { light, variance, stale } = traced;
        let rows = light
            .par_chunks_mut(w)
            .zip(stale.par_chunks_mut(w))
            .zip(variance.par_chunks_mut(w))
            .enumerate();
        rows.for_each(|(y, ((light, stale), variance))| {
            let mut put = |i: u32, mean: Mean| {
                let x = i as usize - y * w;
                (light[x], stale[x], variance[x]) = (mean.light, mean.changed, mean.variance);
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
                    gather.fluence(&open).into_iter().zip(open).for_each(|(s, i)| put(i, s));
                    count = 0;
                }
            }
            if count > 0 {
                let seen = gather.fluence(&open[..count]);
                seen.into_iter().zip(&open[..count]).for_each(|(s, &i)| put(i, s));
            }
        });
    }

    /// What a solid cell receives: the mean over its exposed faces, nothing inside a wall.
    fn on_wall(&self, gather: &Gather, i: u32) -> Mean {
        let Some(slot) = self.surfaces.slot(i as usize) else { return Mean::default() };
        let wall = &self.surfaces.walls[slot];
        let (faces, changed) = gather.faces(wall);
        let changed = changed.contains(&true);
        Mean { light: mean_over_faces(wall, &faces), changed, variance: 0.0 }
    }

    fn gatherer<'a>(&'a self, input: Input<'a>, settings: &'a Settings) -> Gather<'a> {
        Gather {
            field: Field {
                settings: &settings.raymarch,
                optics: &self.optics,
                surfaces: &self.surfaces,
                distance: input.distance,
                nearest: input.nearest,
            },
            directions: &self.directions,
            frame: input.frame,
            seed: settings.seed,
            level: self.level,
        }
    }
}

impl Raymarch {
    /// The clear squares of a quadrant, as the last frame measured them.
    pub(crate) fn squares(&self, quadrant: usize) -> &[u8] {
        let count = self.optics.sites.len();
        &self.optics.squares[quadrant * count..][..count]
    }
}

/// How rays read the grid.
fn reading(settings: &Settings) -> Reading {
    let Settings { raymarch, .. } = settings;
    Reading {
        threshold: raymarch.threshold,
        multiplier: raymarch.emission_multiplier,
        fades: raymarch.attenuation,
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::super::vector_units::{agree, cells};
    use super::*;

    #[test]
    fn every_vector_unit_gives_the_same_bytes() {
        let cells = cells().drawn().into_owned();
        let settings = Settings { bounces: Bounces::Count(2), ..Settings::default() };
        agree(0.0, |level| {
            let input =
                Input { cells: &cells, distance: &[], nearest: &[], changed: &[], frame: 0 };
            let mut traced = Traced::default();
            Raymarch::on(level).solve(input, &settings, &mut traced, &mut Clock::default());
            traced.light
        });
    }
}
