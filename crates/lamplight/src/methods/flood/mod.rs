//! `flood`: rays drawn into a grid of energy, a bounce, many blurs; energy is kept between frames
//! (tmpvar 2019, "Blur Based 2D Realtime Radiosity").
//!
//! Each frame every cell loses a little light; each light draws its rays into the cells that they
//! cross; a ray that meets a wall sends a few more on from before it; then neighbours are mixed, so
//! that light flows between the rays and round corners. Nothing is cleared: light that moved leaves
//! a trail that fades.
//!
//! It is a look, not physics: what a cell holds is the brightest ray through it, not the sum. What
//! holds is that no light gets through a wall, that it never brightens by itself, and that it comes
//! to rest on a still scene.
//!
//! Beyond the source: any size, lamps with their range, falloff and cone, glowing matter and the sky,
//! and mixing that favours no direction. Bounced rays start before the wall that was met, so that
//! none comes out on its other side.
//!
//! Cost: rounds × cells, and rays × lights × px. Known failures: fingers where rays lie farther apart
//! than the blur reaches (about √(2·rounds) px); light weaker than the decay does not last.

mod blur;

use crate::clock::Clock;
use crate::settings::{Fade, Flood as Settings, Sweeps};
use crate::stages::bounce::NORMALS;
use crate::stages::circle;
use crate::stages::ground::{Ground, Hit, Kind};
use crate::stages::transmittance::exp_negative;
use crate::{Cells, Lamp, Rgb};
use blur::{Energy, Links};
use fearless_simd::Level;
use rayon::prelude::*;

/// The source's attenuation is `1/(1 + STEEPNESS·D·d²)`, d in grids of D px,
pub const STEEPNESS: f32 = 0.75;
/// and a ray ends where it falls under this.
pub const FAINTEST: f32 = 0.01;

/// px that rays go by the source's rule, in a grid whose longer side is `diameter` px:
/// `1/(1 + STEEPNESS·reach²/D) = FAINTEST`.
pub fn reach(diameter: f32) -> f32 {
    ((1.0 / FAINTEST - 1.0) * diameter / STEEPNESS).sqrt()
}

/// The method, its buffers and the energy of the frames before.
#[derive(Debug)]
pub struct Flood {
    level: Level,
    size: [u32; 2],
    ground: Ground,
    links: Links,
    energy: Energy,
    scratch: Energy,
}

impl Default for Flood {
    fn default() -> Self {
        Self::on(Level::new())
    }
}

/// A ray on its way: colour × energy is what it leaves in the cells that it crosses.
#[derive(Clone, Copy)]
struct Ray {
    from: [f32; 2],
    direction: [f32; 2],
    color: Rgb,
    energy: f32,
    /// Whether it starts in what glows, and so may leave a wall.
    inside: bool,
}

/// How rays fade with distance, and how far they go.
#[derive(Clone, Copy)]
struct Fading<'a> {
    lamp: Option<&'a Lamp>,
    /// The grid's longer side, px.
    diameter: f32,
    reach: f32,
}

impl<'a> Fading<'a> {
    /// By the source's rule.
    fn seed(diameter: f32) -> Self {
        Self { lamp: None, diameter, reach: reach(diameter) }
    }

    /// Of a lamp.
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

impl Flood {
    /// On these vector units; which ones makes no difference but to the time.
    fn on(level: Level) -> Self {
        Self {
            level,
            size: [0; 2],
            ground: Ground::default(),
            links: Links::default(),
            energy: Energy::default(),
            scratch: Energy::default(),
        }
    }

    /// Goes on by a frame; lamps are not drawn into the cells.
    pub(crate) fn solve(
        &mut self,
        cells: &Cells,
        settings: &Settings,
        light: &mut Vec<Rgb>,
        clock: &mut Clock,
    ) {
        let size = [cells.width(), cells.height()];
        self.ground.prepare(cells, true);
        let (kinds, stride) = (self.ground.kinds(), self.ground.stride());
        self.links.prepare(kinds, stride);
        if self.size != size {
            self.size = size;
            self.energy.clear(kinds.len());
            self.scratch.clear(kinds.len());
        }
        self.energy.decay(kinds, settings.decay);
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
                    // What two sweeps of a half each do in the open, both ways alike.
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

    fn cast_lamps(&mut self, cells: &Cells, settings: &Settings) {
        for lamp in cells.lamps().iter().filter(|lamp| !lamp.is_off()) {
            let fading = Fading::of(lamp, settings.fade, self.diameter());
            let color = lamp.color.map(|c| c * lamp.intensity);
            let share = |angle| lamp.cone.map_or(1.0, |cone| cone.share(angle));
            for (angle, direction) in circle(settings.rays) {
                let energy = share(angle);
                if energy > 0.0 {
                    let ray = Ray { from: lamp.position, direction, color, energy, inside: false };
                    self.cast(cells, settings, ray, fading);
                }
            }
        }
    }

    /// Matter that glows: walls with a face or a corner in the open, fog by the share it stops.
    fn cast_matter(&mut self, cells: &Cells, settings: &Settings) {
        let fading = Fading::seed(self.diameter());
        let width = cells.width() as usize;
        for (i, &emission) in cells.emission().iter().enumerate() {
            if emission == [0.0; 3] {
                continue;
            }
            let (x, y) = (i % width, i / width);
            let index = self.ground.index([x, y]);
            let color = match self.ground.kinds()[index] {
                Kind::Wall if self.is_buried(index) => continue,
                Kind::Wall => emission,
                Kind::Medium => {
                    let log = self.ground.log(index);
                    std::array::from_fn(|c| emission[c] * (1.0 - exp_negative(log[c])))
                }
                Kind::Clear | Kind::Outside => continue,
            };
            let from = [x as f32 + 0.5, y as f32 + 0.5];
            for (_, direction) in circle(settings.matter_rays) {
                self.cast(
                    cells,
                    settings,
                    Ray { from, direction, color, energy: 1.0, inside: true },
                    fading,
                );
            }
        }
    }

    /// Whether a cell has only walls round it.
    fn is_buried(&self, index: usize) -> bool {
        let (kinds, stride) = (self.ground.kinds(), self.ground.stride());
        [index - stride, index, index + stride].into_iter().all(|row| {
            kinds[row - 1..=row + 1].iter().all(|&kind| matches!(kind, Kind::Wall | Kind::Outside))
        })
    }

    /// The sky: rays from the middle of every side of a cell at the border.
    fn cast_sky(&mut self, cells: &Cells, settings: &Settings) {
        let sky = cells.sky();
        if sky.is_black() {
            return;
        }
        let fading = Fading::seed(self.diameter());
        let [w, h] = self.size.map(|v| v as f32);
        let mut side = |from: [f32; 2], normal: [f32; 2]| {
            for (_, direction) in circle(settings.matter_rays) {
                if direction[0] * normal[0] + direction[1] * normal[1] > 0.0 {
                    let color = sky.radiance(-direction[1]);
                    let ray = Ray { from, direction, color, energy: 1.0, inside: false };
                    self.cast(cells, settings, ray, fading);
                }
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

    /// Draws a ray, and those that are sent on from where it ends.
    fn cast(&mut self, cells: &Cells, settings: &Settings, ray: Ray, fading: Fading) {
        let Some((bounced, hit)) = self.draw(ray, fading) else { return };
        if settings.bounce_rays == 0 {
            return;
        }
        let [x, y] = self.ground.place(hit);
        let albedo = cells.albedo()[y * cells.width() as usize + x];
        if albedo == [0.0; 3] {
            return;
        }
        let color = std::array::from_fn(|c| bounced.color[c] * albedo[c]);
        for (_, direction) in circle(settings.bounce_rays) {
            self.draw(Ray { direction, color, ..bounced }, fading);
        }
    }

    /// Draws a ray into the cells that it crosses. Where it meets a wall: the ray as it starts anew
    /// from the cell before, and the wall's index in the frame.
    fn draw(&mut self, mut ray: Ray, fading: Fading) -> Option<(Ray, usize)> {
        let (ground, cells) = (&self.ground, &mut self.energy);
        let mut last = None;
        let Ray { from, direction, inside, .. } = ray;
        let hit = ground.walk(from, direction, fading.reach, inside, |[enter, leave], cell| {
            cells.deposit(cell, ray.color, ray.energy * fading.at(0.5 * (enter + leave)));
            if ground.kinds()[cell] == Kind::Medium {
                let log = ground.log(cell);
                for c in 0..3 {
                    ray.color[c] *= exp_negative(log[c] * (leave - enter));
                }
            }
            last = Some(cell);
        });
        if hit == Hit::NONE {
            return None;
        }
        let energy = ray.energy * fading.at(hit.length);
        let from = ground.place(last?).map(|v| v as f32 + 0.5);
        Some((Ray { from, energy, inside: false, ..ray }, hit.cell as usize))
    }

    fn diameter(&self) -> f32 {
        self.size[0].max(self.size[1]) as f32
    }

    /// What every cell holds; in solid cells, which hold nothing, the mean of what lies before their
    /// faces.
    fn write(&self, cells: &Cells, light: &mut Vec<Rgb>) {
        light.resize(cells.len(), [0.0; 3]);
        let (ground, kinds) = (&self.ground, self.ground.kinds());
        let stride = ground.stride() as isize;
        light.par_chunks_mut(cells.width() as usize).enumerate().for_each(|(y, row)| {
            for (x, rgb) in row.iter_mut().enumerate() {
                let index = ground.index([x, y]);
                if kinds[index] != Kind::Wall {
                    *rgb = self.energy.color(index);
                    continue;
                }
                let (mut sum, mut faces) = ([0.0; 3], 0.0);
                for [dx, dy] in NORMALS {
                    let n = index.wrapping_add_signed(dx as isize + dy as isize * stride);
                    if matches!(kinds[n], Kind::Clear | Kind::Medium) {
                        let color = self.energy.color(n);
                        (0..3).for_each(|c| sum[c] += color[c]);
                        faces += 1.0;
                    }
                }
                *rgb = if faces > 0.0 { sum.map(|v: f32| v / faces) } else { [0.0; 3] };
            }
        });
    }

    /// The source's energy of every cell, in row order: as the light, without colour.
    pub(crate) fn energy(&self, energy: &mut Vec<f32>) {
        energy.clear();
        let [w, h] = self.size.map(|v| v as usize);
        let cells = (0..h).flat_map(|y| (0..w).map(move |x| [x, y]));
        energy.extend(cells.map(|cell| self.energy.energy(self.ground.index(cell))));
    }
}

/// Angles and unit directions evenly round the circle, the first along +x.
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
            Flood::on(level).solve(&cells, &Settings::default(), &mut light, &mut Clock::default());
            light
        });
    }
}
