//! `polar`: a fan of rays from every lamp, then every pixel looks its ray up (Griffis, "Polar-Ray
//! Traced Lighting").
//!
//! Pass A ([`fan`]): a lamp that reaches R px sends `⌈2πR⌉` rays, each of which keeps how far it
//! comes. Pass B ([`canvas`]): a pixel within R finds its ray from atan2 and is lit if it is nearer
//! than the ray comes, by `color · intensity · falloff(d)`.
//!
//! Beyond the seed: exact ray lengths, edges that are linear between rays or as soft as the lamp's
//! size makes them, fog and glass that darken and tint, cones, blend modes, and lit walls.
//!
//! Cost: `2πR` walks of at most R px and `πR²` look-ups a lamp, whatever the scene holds. Known
//! failures: glowing matter, the sky and bounces are not seen; a lamp inside a wall lights nothing;
//! what stands behind a nearer wall throws no penumbra of its own.

mod angle;
mod canvas;
mod fan;
mod inside;
mod knots;

pub use fan::{NARROWEST, NEAREST, WIDEST, rays};
pub use knots::{APART, FINEST};

use crate::clock::Clock;
use crate::settings::Polar as Settings;
use crate::stages::ground::Ground;
use crate::{Cells, Rgb};
use canvas::Canvas;
use fan::Fan;
use fearless_simd::Level;
use rayon::prelude::*;

/// Lamps are taken in groups whose rays may need so much memory, bytes.
const MOST_BYTES: usize = 128 << 20;

/// The method with its buffers.
#[derive(Debug)]
pub struct Polar {
    level: Level,
    ground: Ground,
    /// Rays of the lamps at hand; more than there are lamps when a frame before had more.
    fans: Vec<Fan>,
    /// How many of them are of the last group of the last frame.
    last: usize,
    canvas: Canvas,
}

impl Default for Polar {
    fn default() -> Self {
        Self::on(Level::new())
    }
}

impl Polar {
    /// On these vector units; which ones makes no difference but to the time.
    fn on(level: Level) -> Self {
        Self {
            level,
            ground: Ground::default(),
            fans: Vec::new(),
            last: 0,
            canvas: Canvas::default(),
        }
    }

    /// Lights the cells with their lamps, which are not drawn in. `distance` is the distance field,
    /// empty unless `walk = "distance"`.
    pub(crate) fn solve(
        &mut self,
        cells: &Cells,
        distance: &[f32],
        settings: &Settings,
        light: &mut Vec<Rgb>,
        clock: &mut Clock,
    ) {
        self.ground.prepare(cells, settings.translucent);
        self.canvas.clear(cells);
        clock.lap("ground");
        self.last = 0;
        let mut lamps = cells.lamps();
        while !lamps.is_empty() {
            let (level, ground) = (self.level, &self.ground);
            let bytes = |lamp| Fan::most_bytes(lamp, ground, settings);
            let mut sum = 0usize;
            let fit = lamps.iter().take_while(|&lamp| {
                sum = sum.saturating_add(bytes(lamp));
                sum <= MOST_BYTES
            });
            let (group, rest) = lamps.split_at(fit.count().max(1));
            if self.fans.len() < group.len() {
                self.fans.resize_with(group.len(), Fan::default);
            }
            self.last = group.len();
            let fans = &mut self.fans[..group.len()];
            fans.par_iter_mut().zip(group).for_each(|(fan, lamp)| {
                fan.trace(level, lamp, ground, distance, settings);
            });
            clock.lap("rays");
            self.canvas.light(level, ground, fans, settings);
            clock.lap("polar");
            lamps = rest;
        }
        self.canvas.write(light);
        clock.lap("polar");
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::super::vector_units::{agree, cells};
    use super::*;

    #[test]
    fn every_vector_unit_gives_the_same_bytes() {
        let (cells, settings) = (cells(), Settings::default());
        agree(0.0, |level| {
            let mut light = Vec::new();
            Polar::on(level).solve(&cells, &[], &settings, &mut light, &mut Clock::default());
            light
        });
    }
}
