//! Suns drawn into the sky, for the methods that read the sky.
//!
//! A sun with [`Direct::Glow`](crate::Direct::Glow) is to the sky what a lamp that glows is to matter (`lamp_discs.rs`):
//! part of a radiance that the method finds anyway, at the method's own angular resolution. The sky becomes a
//! panorama whose columns hold the mean radiance of sky and suns, so no light is lost of a sun that is narrower than
//! a column (0.044°).

use crate::{Method, Panorama, Rgb, Sky, Sun};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The sky with its suns, kept until one of them changes.
#[derive(Debug, Default)]
pub struct SunGlow {
    sky: Sky,
    suns: Vec<Sun>,
    sum: Sky,
}

impl SunGlow {
    /// Returns the sky with all suns drawn in that the method does not light exactly ([`Method::shines_exactly`]).
    pub fn draw(&mut self, method: Method, sky: &Sky, suns: &[Sun]) -> Sky {
        let is_drawn = |sun: &&Sun| !method.shines_exactly(sun) && !sun.is_off();
        let glowing = || suns.iter().filter(is_drawn);
        if glowing().next().is_none() {
            return sky.clone();
        }
        if self.sky != *sky || !glowing().eq(&self.suns) {
            self.sky = sky.clone();
            self.suns.clear();
            self.suns.extend(glowing());
            self.sum = sum(sky, &self.suns);
        }
        self.sum.clone()
    }
}

/// Returns the radiance of a sky and of suns in front of it.
fn sum(sky: &Sky, suns: &[Sun]) -> Sky {
    let count = Panorama::MAX_COLUMNS;
    let width = TAU / count as f64;
    let column = |k: usize| -> Rgb {
        let from = FRAC_PI_2 + k as f64 * width;
        let mut radiance = sky.mean(from, from + width);
        for sun in suns {
            let share = (seen(sun, from, from + width) / width) as f32;
            let own = sun.radiance();
            (0..3).for_each(|c| radiance[c] += share * own[c]);
        }
        radiance
    };
    let columns: Vec<Rgb> = (0..count).map(column).collect();
    // As many columns as there may be, so there always is a panorama.
    Panorama::of(&columns).map_or(Sky::BLACK, Sky::from)
}

/// Returns the angle that a sun covers between two angles of less than a turn.
fn seen(sun: &Sun, from: f64, to: f64) -> f64 {
    let half = 0.5 * f64::from(sun.angle);
    // The sun is seen against the way that its light travels.
    let start = f64::from(sun.direction) + PI - half;
    let start = from + (start - from).rem_euclid(TAU);
    let overlap = |start: f64| (to.min(start + 2.0 * half) - from.max(start)).max(0.0);
    // It may begin before `from`, a turn earlier.
    overlap(start) + overlap(start - TAU)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Direct;

    const METHOD: Method = Method::Holographic;

    fn glowing(direction: f32, angle: f32) -> Sun {
        Sun { direction, angle, direct: Direct::Glow, ..Sun::default() }
    }

    #[test]
    fn all_light_of_suns_is_in_the_sky_wherever_they_stand() {
        let mut glow = SunGlow::default();
        for (direction, angle) in [(1.3, 0.4), (-FRAC_PI_2 as f32, 0.02), (0.7, 1e-4), (-6.2, 0.5)]
        {
            let sun = glowing(direction, angle);
            let night = Sky::Uniform([0.0, 0.25, 0.0]);
            let sky = glow.draw(METHOD, &night, &[sun]);
            let mean = sky.mean(0.0, TAU);
            let expected = f64::from(sun.radiance()[0]) * f64::from(angle) / TAU;
            let found = f64::from(mean[0]);
            assert!((found - expected).abs() < 1e-4 * expected, "{found}, not {expected}");
            assert!((f64::from(mean[1]) - found - 0.25).abs() < 1e-4);
            // Opposite to its light.
            let towards = [-direction.cos(), -direction.sin()];
            if angle > 0.01 {
                let found = sky.radiance(towards)[0] / sun.radiance()[0];
                assert!((found - 1.0).abs() < 1e-3, "{found} of its radiance at {direction}");
            }
            assert_eq!(sky.radiance(towards.map(|v| -v))[0], 0.0);
        }
    }

    #[test]
    fn exact_suns_and_skies_alone_are_left_as_they_are() {
        let mut glow = SunGlow::default();
        let sky = Sky::Uniform([0.5; 3]);
        let exact = Sun::default();
        let masked = Sun { mask: 1, ..glowing(1.0, 0.1) };
        let dark = Sun { intensity: 0.0, ..glowing(1.0, 0.1) };
        assert_eq!(glow.draw(METHOD, &sky, &[exact, masked, dark]), sky);
        assert_ne!(glow.draw(METHOD, &sky, &[glowing(1.0, 0.1)]), sky);
        // These light all suns exactly.
        for method in [Method::Polar, Method::Flood] {
            assert_eq!(glow.draw(method, &sky, &[glowing(1.0, 0.1)]), sky);
        }
        // What was kept is not returned after a change.
        let [first, second] = [1.0, 1.1].map(|at| glow.draw(METHOD, &sky, &[glowing(at, 0.1)]));
        assert_ne!(first, second);
    }
}
