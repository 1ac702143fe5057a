//! The elevation of light above the plane, on which the light of tilted surfaces depends ([`Relief`](crate::Relief)).
//!
//! Light runs in the plane. What a tilted surface receives of light that arrives at an elevation ε follows from the first
//! moment of that light times cot ε. All light has the same elevation ε₀
//! ([`Settings::elevation`](crate::Settings::elevation)), except that of
//!
//! - a lamp of height h above the plane: `cot ε = d/h` at the distance d, so its light is steep nearby and grazes far away;
//! - a sun with an elevation of its own.
//!
//! Their first moment is weighted by `cot ε / cot ε₀` where it is found. All moments can then be added up, and one
//! elevation serves the sum. No cotangent is more than 20 (2.9°): light of a low lamp stays finite far away.

use crate::{Lamp, Sun};
use std::f32::consts::FRAC_PI_4;
use std::ops::RangeInclusive;

/// The elevation of light if nothing sets another, radians.
pub const DEFAULT: f32 = FRAC_PI_4;
/// The elevations that all light may have, radians. Straight above, no weight could make up for it.
pub const OF_LIGHT: RangeInclusive<f32> = 0.05..=1.5;
/// The largest cotangent of an elevation.
const MAX_COTANGENT: f32 = 20.0;

/// Returns the factor on the first moment of a lamp's light at a distance, px; `tangent` is that of the elevation of all
/// light.
#[inline]
pub fn of_lamp(lamp: &Lamp, distance: f32, tangent: f32) -> f32 {
    lamp.height.map_or(1.0, |height| weight(distance / height, tangent))
}

/// Returns the factor on the first moment of a sun's light, as `of_lamp` does.
pub fn of_sun(sun: &Sun, tangent: f32) -> f32 {
    sun.elevation.map_or(1.0, |own| weight(1.0 / own.tan(), tangent))
}

/// `cot ε · tan ε₀`.
fn weight(cotangent: f32, tangent: f32) -> f32 {
    cotangent.clamp(0.0, MAX_COTANGENT) * tangent
}

/// Returns the most that the first moment may have of its light: 1, or more where light is lower than all other light.
pub fn longest_moment(lamps: &[Lamp], suns: &[Sun], elevation: f32) -> f32 {
    let tangent = elevation.tan();
    let lamps = lamps.iter().map(|lamp| of_lamp(lamp, lamp.range, tangent));
    lamps.chain(suns.iter().map(|sun| of_sun(sun, tangent))).fold(1.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_PI_2;

    /// Rounding of 32-bit floats.
    const ROUNDING: f32 = 1e-6;

    #[test]
    fn lamps_are_as_steep_as_their_height_over_their_distance() {
        let lamp = |height| Lamp { height, range: 300.0, ..Lamp::default() };
        let tangent = 0.5f32.tan();
        for distance in [0.0, 1.0, 10.0, 80.0] {
            assert_eq!(of_lamp(&lamp(None), distance, tangent), 1.0);
            let angle = 20f32.atan2(distance);
            let expected = tangent / angle.tan();
            let found = of_lamp(&lamp(Some(20.0)), distance, tangent);
            assert!((found - expected).abs() < ROUNDING * expected.max(1.0), "{found} {expected}");
        }
        // Neither flat nor low lamps give more than any number.
        assert_eq!(of_lamp(&lamp(Some(0.05)), 300.0, tangent), MAX_COTANGENT * tangent);
    }

    #[test]
    fn suns_with_the_elevation_of_all_light_change_nothing() {
        let sun = |elevation| Sun { elevation, ..Sun::default() };
        for elevation in [*OF_LIGHT.start(), 0.7, *OF_LIGHT.end()] {
            let found = of_sun(&sun(Some(elevation)), elevation.tan());
            assert!((found - 1.0).abs() < ROUNDING, "{elevation}: {found}");
        }
        assert_eq!(of_sun(&sun(None), 3.0), 1.0);
        assert_eq!(of_sun(&sun(Some(FRAC_PI_2)), 1.0), 0.0);
    }

    #[test]
    fn the_longest_moment_is_that_of_the_lowest_light() {
        let lamp = |height| Lamp { height, range: 60.0, ..Lamp::default() };
        let low = Sun { elevation: Some(0.2), ..Sun::default() };
        assert_eq!(longest_moment(&[lamp(None)], &[Sun::default()], DEFAULT), 1.0);
        assert_eq!(longest_moment(&[lamp(Some(90.0))], &[], DEFAULT), 1.0);
        let found = longest_moment(&[lamp(None), lamp(Some(20.0))], &[], DEFAULT);
        assert!((found - 3.0).abs() < 3.0 * ROUNDING, "{found}");
        let found = longest_moment(&[lamp(Some(20.0))], &[low], DEFAULT);
        assert!((found - 1.0 / 0.2f32.tan()).abs() < 5.0 * ROUNDING, "{found}");
    }
}
