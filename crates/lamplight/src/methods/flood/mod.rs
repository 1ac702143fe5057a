//! `flood`: rays drawn into a grid of energy, one bounce, many blurs; energy is kept between frames
//! (tmpvar 2019, "Blur Based 2D Realtime Radiosity").
//!
//! Each frame every cell loses a little light (`decay`). Each light draws its rays into the cells that
//! they cross. A ray that meets a wall is reflected as a few more, from the cell before the wall. Then
//! neighbours are mixed, `c ← c + Σ w·(n − c)`, so that light flows between the rays and round corners.
//! The light is not cleared between frames: moving lights leave a fading trail.
//!
//! It is a visual style, not physics: a cell holds the brightest ray through it, not the sum. Three properties
//! hold: light does not cross walls, it never brightens by itself, and it comes to rest on a still
//! scene.
//!
//! Beyond the source: any size, lamps with range, falloff and cone, emissive matter and the sky, and
//! mixing that favours no direction. Reflected rays start before the wall, so that none comes out on
//! its other side.
//!
//! Settings: `rays`, `matter_rays` and `bounce_rays`, `rounds` and `sweeps` of the blur, `decay`,
//! `fade`.
//!
//! Cost: rounds × cells, and rays × lights × px. Known failures: streaks if rays lie farther apart than
//! the blur reaches (about √(2·rounds) px); light weaker than the decay does not last.

mod blur;

use crate::clock::Clock;
use crate::grid::cast::RayHit;
use crate::grid::class::CellClass;
use crate::grid::medium_grid::{MediumGrid, Reading};
use crate::math::circle;
use crate::math::transmittance::{attenuation, transmittance};
use crate::settings::{Fade, Flood, Method, Sweeps};
use crate::stages::faces::NORMALS;
use crate::{Cells, Lamp, Rgb, Sky};
use blur::{Energy, Links};
use fearless_simd::Level;
use rayon::prelude::*;
use std::f32::consts::TAU;
use std::f64::consts::PI;

/// The source's attenuation is `1/(1 + STEEPNESS·D·d²)`, d in grids of D px,
pub const STEEPNESS: f32 = 0.75;
/// and a ray ends where it falls under this.
pub const FAINTEST: f32 = 0.01;

/// Returns the length of rays by the source's rule, px, in a grid whose longer side is `diameter` px:
/// `1/(1 + STEEPNESS·reach²/D) = FAINTEST`.
pub fn reach(diameter: f32) -> f32 {
    ((1.0 / FAINTEST - 1.0) * diameter / STEEPNESS).sqrt()
}

/// The method, its buffers and the energy of the frames before.
#[derive(Debug)]
pub struct FloodSolver {
    level: Level,
    size: [u32; 2],
    grid: MediumGrid,
    links: Links,
    energy: Energy,
    scratch: Energy,
}

impl Default for FloodSolver {
    fn default() -> Self {
        Self::on(Level::new())
    }
}

/// A ray on its way: it leaves colour × energy in the cells that it crosses.
#[derive(Clone, Copy)]
struct LightRay {
    from: [f32; 2],
    direction: [f32; 2],
    color: Rgb,
    energy: f32,
    /// Distance to the next ray in px, per px of length: where rays are farther apart than 1 px, each is as
    /// much brighter, so that the blur spreads it to the right light. 0: not so.
    spacing: f32,
    /// True if it starts in emissive matter: it may leave a wall.
    inside: bool,
}

/// The fading of rays with distance, and their length.
#[derive(Clone, Copy)]
struct Fading<'a> {
    lamp: Option<&'a Lamp>,
    /// The grid's longer side, px.
    diameter: f32,
    reach: f32,
}

impl<'a> Fading<'a> {
    /// Fades by the source's rule.
    fn seed(diameter: f32) -> Self {
        Self { lamp: None, diameter, reach: reach(diameter) }
    }

    /// Fades as the rays of a lamp.
    fn of(lamp: &'a Lamp, fade: Fade, diameter: f32) -> Self {
        let seed = Self::seed(diameter);
        match fade {
            Fade::Lamp => Self { lamp: Some(lamp), reach: lamp.range, ..seed },
            Fade::Seed => Self { reach: lamp.range.min(seed.reach), ..seed },
        }
    }

    #[inline(always)]
    fn at(&self, distance: f32) -> f32 {
        match self.lamp {
            Some(lamp) => lamp.falloff.at(distance, lamp),
            None => 1.0 / (1.0 + STEEPNESS * distance * distance / self.diameter),
        }
    }
}

impl FloodSolver {
    /// Runs at the given SIMD level. The result is identical at every level.
    fn on(level: Level) -> Self {
        Self {
            level,
            size: [0; 2],
            grid: MediumGrid::default(),
            links: Links::default(),
            energy: Energy::default(),
            scratch: Energy::default(),
        }
    }

    /// Drops the energy of the frames before.
    pub(crate) fn reset(&mut self) {
        self.energy.clear(self.links.frame().cells());
    }

    /// Advances by a frame, whose grid has `moved` over the world since the one before; lamps are not drawn into the cells.
    pub(crate) fn solve(
        &mut self,
        cells: &Cells,
        settings: &Flood,
        moved: [i32; 2],
        light: &mut Vec<Rgb>,
        clock: &mut Clock,
    ) {
        let size = [cells.width(), cells.height()];
        self.grid.read(cells, Reading::default());
        self.links.prepare(&self.grid);
        let frame = self.links.frame();
        if self.size != size {
            self.size = size;
            self.energy.clear(frame.cells());
            self.scratch.clear(frame.cells());
        } else if moved != [0; 2] {
            self.scratch.shift(&self.energy, frame, moved);
            std::mem::swap(&mut self.scratch, &mut self.energy);
        }
        self.energy.decay(&self.grid, frame, settings.decay);
        clock.lap("decay");

        self.cast_lamps(cells, settings);
        self.cast_matter(cells, settings);
        self.cast_sky(cells, settings);
        clock.lap("rays");

        for _ in 0..settings.rounds {
            let links = &self.links;
            let mut pass = |vertical, shares| {
                self.scratch.mix(self.level, &self.energy, links, vertical, shares);
                std::mem::swap(&mut self.scratch, &mut self.energy);
            };
            for vertical in [false, true] {
                match settings.sweeps {
                    // The effect of two sweeps of a half each in the open, the same both ways.
                    Sweeps::Even => pass(vertical, [0.25, 0.25]),
                    Sweeps::Seed => {
                        pass(vertical, [0.0, 0.5]);
                        pass(vertical, [0.5, 0.0]);
                    }
                }
            }
        }
        self.write(cells, light);
        clock.lap("flood");
    }

    fn cast_lamps(&mut self, cells: &Cells, settings: &Flood) {
        let by_rule = |lamp: &&Lamp| !lamp.is_off() && !Method::Flood.lights_exactly(lamp);
        for lamp in cells.lamps().iter().filter(by_rule) {
            let fading = Fading::of(lamp, settings.fade, self.diameter());
            let color = lamp.color.map(|c| c * lamp.intensity);
            let spacing = match settings.fade {
                Fade::Lamp => TAU / settings.rays as f32,
                Fade::Seed => 0.0,
            };
            let share = |angle| lamp.cone.map_or(1.0, |cone| cone.share(angle));
            for (angle, direction) in circle(settings.rays) {
                let energy = share(angle);
                if energy > 0.0 {
                    let from = lamp.position;
                    let ray = LightRay { from, direction, color, energy, spacing, inside: false };
                    self.cast(cells, settings, ray, fading);
                }
            }
        }
    }

    /// Casts emissive matter: walls with a face or a corner in the open, media by `1 − T`.
    fn cast_matter(&mut self, cells: &Cells, settings: &Flood) {
        let fading = Fading::seed(self.diameter());
        for (i, &emission) in cells.emission().iter().enumerate() {
            if emission == [0.0; 3] {
                continue;
            }
            let cell = self.grid.cell(i);
            let color = match self.grid.classes[i] {
                CellClass::Solid if self.is_buried(cell) => continue,
                CellClass::Solid => emission,
                CellClass::Medium => {
                    let extinction = self.grid.extinction[i];
                    std::array::from_fn(|c| emission[c] * attenuation(extinction[c]).1)
                }
                CellClass::Empty | CellClass::Outside => continue,
            };
            let from = cell.map(|v| v as f32 + 0.5);
            for (_, direction) in circle(settings.matter_rays) {
                let (energy, spacing) = (1.0, 0.0);
                let ray = LightRay { from, direction, color, energy, spacing, inside: true };
                self.cast(cells, settings, ray, fading);
            }
        }
    }

    /// Returns whether a cell has no open cell round it.
    fn is_buried(&self, [x, y]: [i32; 2]) -> bool {
        (y - 1..=y + 1).all(|y| (x - 1..=x + 1).all(|x| !self.grid.class([x, y]).is_open()))
    }

    /// Casts the sky: rays from the middle of every side of a cell at the border.
    fn cast_sky(&mut self, cells: &Cells, settings: &Flood) {
        let sky = cells.sky();
        if sky.is_black() {
            return;
        }
        let fading = Fading::seed(self.diameter());
        let [w, h] = self.size.map(|v| v as f32);
        for (angle, direction) in circle(settings.matter_rays) {
            let color = match sky {
                // What is narrow may lie between two rays.
                Sky::Panorama(panorama) => {
                    let (from, half) =
                        (f64::from(angle) + PI, PI / f64::from(settings.matter_rays));
                    panorama.mean(from - half, from + half)
                }
                _ => sky.radiance(direction.map(|d| -d)),
            };
            let mut side = |from: [f32; 2], normal: [f32; 2]| {
                if direction[0] * normal[0] + direction[1] * normal[1] > 0.0 {
                    let (energy, spacing) = (1.0, 0.0);
                    let ray = LightRay { from, direction, color, energy, spacing, inside: false };
                    self.cast(cells, settings, ray, fading);
                }
            };
            for x in 0..cells.width() {
                side([x as f32 + 0.5, 0.0], [0.0, 1.0]);
                side([x as f32 + 0.5, h], [0.0, -1.0]);
            }
            for y in 0..cells.height() {
                side([0.0, y as f32 + 0.5], [1.0, 0.0]);
                side([w, y as f32 + 0.5], [-1.0, 0.0]);
            }
        }
    }

    /// Draws a ray, and those that are reflected where it ends.
    fn cast(&mut self, cells: &Cells, settings: &Flood, ray: LightRay, fading: Fading) {
        let Some((bounced, hit)) = self.draw(ray, fading) else { return };
        if settings.bounce_rays == 0 {
            return;
        }
        let albedo = cells.albedo()[hit];
        if albedo == [0.0; 3] {
            return;
        }
        let color = std::array::from_fn(|c| bounced.color[c] * albedo[c]);
        for (_, direction) in circle(settings.bounce_rays) {
            self.draw(LightRay { direction, color, ..bounced }, fading);
        }
    }

    /// Draws a ray into the cells that it crosses. If it meets a wall, returns the ray as it starts
    /// again from the cell before, and the index of the wall.
    fn draw(&mut self, mut ray: LightRay, fading: Fading) -> Option<(LightRay, usize)> {
        let (grid, frame, energy) = (&self.grid, self.links.frame(), &mut self.energy);
        let mut last = None;
        let LightRay { from, direction, inside, .. } = ray;
        let hit = grid.cast(from, direction, fading.reach, inside, |step, cell| {
            let [enter, leave] = step.span;
            let distance = 0.5 * (enter + leave);
            let left = ray.energy * fading.at(distance) * (ray.spacing * distance).max(1.0);
            energy.deposit(frame.index(step.cell), ray.color, left);
            if grid.classes[cell] == CellClass::Medium {
                let extinction = grid.extinction[cell];
                for c in 0..3 {
                    ray.color[c] *= transmittance(extinction[c] * (leave - enter));
                }
            }
            last = Some(step.cell);
        });
        if hit == RayHit::NONE {
            return None;
        }
        let energy = ray.energy * fading.at(hit.length);
        let from = last?.map(|v| v as f32 + 0.5);
        Some((LightRay { from, energy, spacing: 0.0, inside: false, ..ray }, hit.cell as usize))
    }

    fn diameter(&self) -> f32 {
        self.size[0].max(self.size[1]) as f32
    }

    /// Writes the light of every cell; in solid cells, which hold none, the mean of the cells before
    /// their faces.
    fn write(&self, cells: &Cells, light: &mut Vec<Rgb>) {
        light.resize(cells.len(), [0.0; 3]);
        let (grid, frame) = (&self.grid, self.links.frame());
        light.par_chunks_mut(cells.width() as usize).enumerate().for_each(|(y, row)| {
            for (x, rgb) in row.iter_mut().enumerate() {
                let [x, y] = [x as i32, y as i32];
                if grid.class([x, y]).is_open() {
                    *rgb = self.energy.color(frame.index([x, y]));
                    continue;
                }
                let (mut sum, mut faces) = ([0.0; 3], 0.0);
                for [dx, dy] in NORMALS {
                    let before = [x + dx, y + dy];
                    if grid.class(before).is_open() {
                        let color = self.energy.color(frame.index(before));
                        (0..3).for_each(|c| sum[c] += color[c]);
                        faces += 1.0;
                    }
                }
                *rgb = if faces > 0.0 { sum.map(|v: f32| v / faces) } else { [0.0; 3] };
            }
        });
    }

    /// Writes the energy of every cell in row order: like the light, without colour.
    pub(crate) fn energy(&self, energy: &mut Vec<f32>) {
        energy.clear();
        let frame = self.links.frame();
        let cells = (0..self.grid.classes.len()).map(|i| self.grid.cell(i));
        energy.extend(cells.map(|cell| self.energy.energy(frame.index(cell))));
    }
}

/// Returns angles and unit directions evenly round the circle, the first along +x.
fn circle(rays: u32) -> impl Iterator<Item = (f32, [f32; 2])> {
    (0..rays).map(move |i| (circle::angle(i, rays), circle::direction(i, rays)))
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::super::vector_units::{agree, cells};
    use super::*;

    #[test]
    fn every_vector_unit_gives_the_same_bytes() {
        let cells = cells();
        agree(0.0, |level| {
            let mut light = Vec::new();
            FloodSolver::on(level).solve(
                &cells,
                &Flood::default(),
                [0; 2],
                &mut light,
                &mut Clock::default(),
            );
            light
        });
    }
}
