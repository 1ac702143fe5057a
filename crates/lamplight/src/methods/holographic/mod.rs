//! `holographic`: rays made from shorter rays, no noise (Freeman, Sannikov and Margel 2025).

mod cones;
mod fronts;
mod hop;
mod interval;
mod march;
mod pair;
mod pyramid;
mod slabs;
mod stencil;

use crate::clock::Clock;
use crate::settings::{Bounces, Settings};
use crate::stages::bounce::{Faces, Surfaces, mean_over_faces};
use crate::{Cells, Rgb};
use fearless_simd::Level;
use fronts::{Fronts, front};
use pair::{Pair, Scene};
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
        self.surfaces.collect(cells);
        self.fronts.collect(cells, &self.surfaces);
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
            for from in (0..w).step_by(BLOCK) {
                for (row, light) in light.chunks_exact_mut(w).enumerate() {
                    let y = block * BLOCK + row;
                    for x in from..w.min(from + BLOCK) {
                        light[x] = self.fluence(x, y);
                    }
                }
            }
        });
        for (i, light) in light.iter_mut().enumerate().filter(|(i, _)| cells.is_solid(*i)) {
            *light = match self.surfaces.slot(i) {
                Some(slot) => {
                    let wall = &self.surfaces.walls[slot];
                    mean_over_faces(wall, &self.faces(i, wall.exposed, w))
                }
                None => [0.0; 3],
            };
        }
    }

    /// Turns what surfaces receive into what they send out; returns the largest change relative to
    /// the mean.
    fn send_on(&mut self, cells: &Cells) -> f32 {
        let w = cells.width() as usize;
        let mut surfaces = std::mem::take(&mut self.surfaces);
        let Surfaces { walls, fog, wall_sent, fog_sent, .. } = &mut surfaces;
        let (mut largest, mut sum, mut count) = (0.0f32, 0.0f64, 0u32);
        let mut update = |old: &mut Rgb, albedo: Rgb, received: Rgb| {
            for c in 0..3 {
                let new = albedo[c] * received[c];
                largest = largest.max((new - old[c]).abs());
                sum += f64::from(new);
                count += 1;
                old[c] = new;
            }
        };
        for (wall, sent) in walls.iter().zip(wall_sent).filter(|(wall, _)| wall.reflects) {
            let i = wall.cell as usize;
            let faces = self.faces(i, wall.exposed, w);
            for face in (0..4).filter(|&face| wall.exposed[face]) {
                update(&mut sent[face], cells.albedo()[i], faces[face]);
            }
        }
        for (&i, sent) in fog.iter().zip(fog_sent) {
            let i = i as usize;
            update(sent, cells.albedo()[i], self.fluence(i % w, i / w));
        }
        self.surfaces = surfaces;
        let mean = (sum / f64::from(count.max(1))) as f32;
        if largest == 0.0 { 0.0 } else { largest / mean }
    }
}

/// Change of what surfaces receive, relative to the mean, at which bounces have converged.
const CONVERGED: f32 = 1e-3;

/// Side of the blocks in which light is gathered, px: a few lines of the cache.
const BLOCK: usize = 16;
