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
mod knots;

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
        Self { level, ground: Ground::default(), fans: Vec::new(), canvas: Canvas::default() }
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

#[cfg(test)]
#[cfg(target_arch = "x86_64")]
mod tests {
    use super::*;
    use crate::{Lamp, Matter};
    use fearless_simd::Simd;

    /// Walls, fog and lamps.
    fn cells() -> Cells {
        let mut cells = Cells::new(61, 37).unwrap();
        for i in 0..cells.len() {
            let matter = match i % 61 {
                20..24 if i % 7 < 5 => Matter { opacity: 1.0, albedo: [0.7; 3], ..Matter::EMPTY },
                45..50 => Matter { opacity: 0.03, tint: [0.9, 0.3, 0.1], ..Matter::EMPTY },
                _ => Matter::EMPTY,
            };
            cells.set_matter(i, matter);
        }
        for x in [9.3, 33.8] {
            cells.lamps_mut().push(Lamp { position: [x, 18.1], ..Lamp::default() });
        }
        cells
    }

    #[test]
    fn every_vector_unit_gives_the_same_bytes() {
        let cells = cells();
        let solve = |level: Level| {
            let mut light = Vec::new();
            Polar::on(level).solve(
                &cells,
                &[],
                &Settings::default(),
                &mut light,
                &mut Clock::default(),
            );
            light
        };
        let best = Level::new();
        let lesser = [
            best.as_sse2().map(Simd::level),
            best.as_sse4_2().map(Simd::level),
            best.as_avx2().map(Simd::level),
        ];
        let light = solve(best);
        assert!(light.iter().flatten().any(|&v| v > 0.0));
        for level in lesser.into_iter().flatten() {
            assert!(solve(level) == light, "{level:?} differs from {best:?}");
        }
    }
}
