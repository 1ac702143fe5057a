//! `holographic`: rays made from shorter rays, no noise (Freeman, Sannikov and Margel 2025).
//!
//! The light of a quarter of the circle, within 45° of an axis, is found in three steps:
//!
//! 1. **Intervals** ([`pyramid`]): what rays from plane to plane add to light and let through; the
//!    shortest are traced, each longer level is made from the one before.
//! 2. **Cones** ([`cones`]): light through cones, merged from the far end of the grid to the near.
//! 3. **The last hop** ([`hop`]): pixels trace the few px to the next plane themselves.
//!
//! Four quadrants make the fluence: `φ = Σ ∫ L dω / 2π`. On every face of a wall the same rays give
//! `B = ½ ∫ L cosθ dω`, shaded by the steps of the wall itself ([`onto`]).
//!
//! What is better than published ([`paper`], which `variant = "paper"` runs): dense directions
//! instead of even ones, which also do away with the checkerboard; beams instead of single rays;
//! planes of even index taken over exactly; and the last hop, which takes away the stars round
//! small lights. Lights of 1 to 6 px: 2.5 % of error instead of 15 %.
//!
//! A bounce solves the quadrants for the surfaces only, with what they sent the time before.
//!
//! All of it is one sweep over the planes from the far end of the grid to the near one, so that no
//! level is ever held whole.
//!
//! Cost: about N² log N for an N×N grid, less where space is empty; memory some hundred bytes a
//! cell. Known failures: up to 7 % of error at the worst angle of a ring round a light, faint
//! stripes far from small lights; where a plane of the lattice cuts a light, its two halves together
//! look up to a third of a px too wide.

mod cones;
mod fronts;
mod hop;
mod inside;
mod interval;
mod march;
mod onto;
mod pair;
pub mod paper;
mod published;
mod pyramid;
mod slabs;
mod stencil;
pub mod ways;

pub use cones::{angle, slope};
pub use hop::CLOSED;
pub use onto::REACH;
pub use pyramid::{levels, planes, rays};
pub use slabs::{FRACTION, GLOWING, MATTER};

use crate::clock::Clock;
use crate::settings::{Bounces, Settings, Variant};
use crate::stages::bounce::{CONVERGED, Faces, Surfaces, Wall, mean_over_faces};
use crate::{Cells, Rgb};
use fearless_simd::Level;
use fronts::{Fronts, front};
use pair::{Pair, Scene};
use published::Published;
use rayon::prelude::*;
use slabs::Axis;
use std::f32::consts::TAU;

/// The method with its buffers.
#[derive(Debug)]
pub struct Holographic {
    level: Level,
    surfaces: Surfaces,
    fronts: Fronts,
    pairs: [Pair; 2],
    /// What walls and fog receive.
    received: (Vec<Faces>, Vec<Rgb>),
    published: Published,
}

impl Default for Holographic {
    fn default() -> Self {
        Self::on(Level::new())
    }
}

impl Holographic {
    /// On these vector units; which ones makes no difference but to the time.
    fn on(level: Level) -> Self {
        Self {
            level,
            surfaces: Surfaces::default(),
            fronts: Fronts::default(),
            pairs: [Axis::X, Axis::Y].map(Pair::new),
            received: Default::default(),
            published: Published::default(),
        }
    }

    /// Solves one frame into `light`.
    pub(crate) fn solve(
        &mut self,
        cells: &Cells,
        settings: &Settings,
        light: &mut Vec<Rgb>,
        clock: &mut Clock,
    ) {
        if settings.holographic.variant == Variant::Paper {
            self.published.solve(cells, settings.bounces, light);
            clock.lap("holographic");
            return;
        }
        let Self { surfaces, fronts, .. } = self;
        rayon::join(|| surfaces.collect(cells, 0.0), || fronts.clear(cells));
        fronts.collect(cells, surfaces);
        clock.lap("surfaces");
        let mut sends = false;
        if settings.bounces != Bounces::Count(0) && self.surfaces.reflect() {
            for _ in 0..settings.bounces.limit() {
                self.quadrants(cells, settings, sends, false);
                sends = true;
                let change = self.send_on(cells);
                if settings.bounces == Bounces::Converged && change < CONVERGED {
                    break;
                }
            }
            clock.lap("bounce");
        }
        self.quadrants(cells, settings, sends, true);
        clock.lap("holographic");
        self.gather(cells, light);
        clock.lap("gather");
    }

    /// Light from all four quadrants; `sends`: with what surfaces send on; `all`: to every pixel.
    fn quadrants(&mut self, cells: &Cells, settings: &Settings, sends: bool, all: bool) {
        let surfaces = sends.then_some(&self.surfaces);
        let scene =
            Scene { cells, surfaces, fronts: &self.fronts, all, settings: &settings.holographic };
        let [x, y] = &mut self.pairs;
        let level = self.level;
        rayon::join(|| x.solve(level, scene), || y.solve(level, scene));
    }

    fn fluence(&self, x: usize, y: usize) -> Rgb {
        let [a, b] = [self.pairs[0].fluence(x, y), self.pairs[1].fluence(x, y)];
        [a[0] + b[0], a[1] + b[1], a[2] + b[2]].map(|v| v * (1.0 / TAU))
    }

    /// Light that the exposed faces of a wall receive.
    fn faces(&self, wall: usize, exposed: [bool; 4], width: usize) -> Faces {
        std::array::from_fn(|face| {
            if !exposed[face] {
                return [0.0; 3];
            }
            let slot = self.fronts.slot(front(wall, face, width));
            let [a, b] = self.pairs.each_ref().map(|pair| pair.onto(slot, face));
            std::array::from_fn(|c| 0.5 * (a[c] + b[c]))
        })
    }

    /// What pixels show: fluence in open cells, on walls the mean over their faces.
    fn gather(&self, cells: &Cells, light: &mut Vec<Rgb>) {
        let w = cells.width() as usize;
        light.resize(cells.len(), [0.0; 3]);
        // Block by block, as one pair of quadrants holds columns and the other rows.
        light.par_chunks_mut(BLOCK * w).enumerate().for_each(|(block, light)| {
            let top = block * BLOCK;
            let [columns, rows] = &self.pairs;
            for from in (0..w).step_by(BLOCK) {
                let size = BLOCK.min(w - from);
                let mut turned = [[[0.0; 3]; BLOCK]; BLOCK];
                for c in 0..3 {
                    for x in 0..size {
                        let fluence = &columns.slab(c, from + x)[top..][..BLOCK];
                        for (row, fluence) in turned.iter_mut().zip(fluence) {
                            row[x][c] = *fluence;
                        }
                    }
                }
                for (row, light) in light.chunks_exact_mut(w).enumerate() {
                    let fluence = [0, 1, 2].map(|c| &rows.slab(c, top + row)[from..][..size]);
                    let light = &mut light[from..][..size];
                    for (x, (light, turned)) in light.iter_mut().zip(turned[row]).enumerate() {
                        for c in 0..3 {
                            light[c] = (turned[c] + fluence[c][x]) * (1.0 / TAU);
                        }
                    }
                }
            }
        });
        for wall in &self.surfaces.walls {
            let cell = wall.cell as usize;
            light[cell] = mean_over_faces(wall, &self.faces(cell, wall.exposed, w));
        }
    }

    /// Turns what surfaces receive into what they send out; returns the largest change relative to
    /// the mean.
    fn send_on(&mut self, cells: &Cells) -> f32 {
        let w = cells.width() as usize;
        let mut received = std::mem::take(&mut self.received);
        let Surfaces { walls, fog, .. } = &self.surfaces;
        let faces = |wall: &Wall| self.faces(wall.cell as usize, wall.exposed, w);
        let fluence = |&i: &u32| self.fluence(i as usize % w, i as usize / w);
        received.0.clear();
        received.0.extend(walls.iter().map(faces));
        received.1.clear();
        received.1.extend(fog.iter().map(fluence));
        let change = self.surfaces.send_on(cells, received.0.iter(), received.1.iter());
        self.received = received;
        change
    }
}

/// Side of the blocks in which light is gathered, px: a few lines of the cache.
const BLOCK: usize = 16;

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::super::vector_units::{agree, cells};
    use super::*;

    /// Some units multiply and add with one rounding, others with two.
    const ROUNDING: f32 = 1e-4;

    #[test]
    fn every_vector_unit_gives_the_same_light() {
        let cells = cells().drawn().into_owned();
        for preset in ["default", "fast", "quality"] {
            let mut settings = Settings { bounces: Bounces::Count(1), ..Settings::default() };
            settings.holographic = crate::settings::Holographic::preset(preset).unwrap();
            agree(ROUNDING, |level| {
                let mut light = Vec::new();
                Holographic::on(level).solve(&cells, &settings, &mut light, &mut Clock::default());
                light
            });
        }
    }
}
