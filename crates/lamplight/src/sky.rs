//! The sky: the boundary radiance of the grid.

use crate::check::BRIGHT;
use crate::{Error, Panorama, Result, Rgb, notation};
use schemars::JsonSchema;
use serde::Serialize;
use std::f64::consts::{PI, TAU};

/// Radiance beyond the grid, by direction.
///
/// [`crate::scene::SceneSky`] has its notation in a file.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(description = "Radiance beyond the grid, by direction.")]
#[non_exhaustive]
pub enum Sky {
    /// One linear RGB radiance from all directions.
    Uniform(#[schemars(with = "notation::Color")] Rgb),
    /// A gradient over the elevation of the direction.
    Gradient(Gradient),
    /// A strip over the angle of the direction.
    Panorama(Panorama),
}

/// A sky that changes with elevation: `zenith` straight up (−y), `horizon` to the sides,
/// `ground` straight down; linear in the sine of the elevation between them.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct Gradient {
    /// Linear RGB radiance from straight up.
    #[schemars(with = "notation::Color")]
    pub zenith: Rgb,
    /// Linear RGB radiance from the sides.
    #[schemars(with = "notation::Color")]
    pub horizon: Rgb,
    /// Linear RGB radiance from straight down.
    #[schemars(with = "notation::Color")]
    pub ground: Rgb,
}

impl Sky {
    /// No light from outside.
    pub const BLACK: Self = Self::Uniform([0.0; 3]);

    /// The radiance along a ray of this unit direction (y points down).
    #[inline]
    pub fn radiance(&self, direction: [f32; 2]) -> Rgb {
        match self {
            Self::Uniform(rgb) => *rgb,
            Self::Gradient(gradient) => gradient.radiance(direction[1]),
            Self::Panorama(panorama) => panorama.radiance(direction),
        }
    }

    /// The mean radiance between two angles, radians from +x towards +y, the first below the second. It is exact, so
    /// that a cone sees all of a sky whose light is narrower than the cone.
    pub fn mean(&self, from: f64, to: f64) -> Rgb {
        match self {
            Self::Uniform(rgb) => *rgb,
            Self::Gradient(gradient) => gradient.mean(from, to),
            Self::Panorama(panorama) => panorama.mean(from, to),
        }
    }

    /// Returns whether the sky is black in all directions.
    pub fn is_black(&self) -> bool {
        let black = |rgb: &Rgb| *rgb == [0.0; 3];
        match self {
            Self::Uniform(rgb) => black(rgb),
            Self::Gradient(gradient) => gradient.ends().iter().all(black),
            Self::Panorama(panorama) => panorama.columns().iter().all(black),
        }
    }

    /// Rejects radiance that is not from 0 to 1e12.
    pub fn check(&self) -> Result<()> {
        let valid = |rgb: &[f32]| match rgb.iter().find(|v| !(0.0..=BRIGHT).contains(*v)) {
            Some(v) => Err(Error::value("sky", v, "a radiance from 0 to 1e12")),
            None => Ok(()),
        };
        match self {
            Self::Uniform(rgb) => valid(rgb),
            Self::Gradient(gradient) => valid(gradient.ends().as_flattened()),
            Self::Panorama(panorama) => panorama.check(),
        }
    }
}

impl Gradient {
    /// Returns the radiance along a ray whose unit direction has the y component `dy`.
    #[inline]
    fn radiance(&self, dy: f32) -> Rgb {
        let (end, weight) = if dy < 0.0 { (self.zenith, -dy) } else { (self.ground, dy) };
        std::array::from_fn(|c| self.horizon[c] + (end[c] - self.horizon[c]) * weight)
    }

    /// Returns the mean radiance between two angles.
    fn mean(&self, from: f64, to: f64) -> Rgb {
        let [up, down] = sines(from, to).map(|sine| sine / (to - from));
        std::array::from_fn(|c| {
            let [zenith, horizon, ground] = self.ends().map(|rgb| f64::from(rgb[c]));
            (horizon + (zenith - horizon) * up + (ground - horizon) * down) as f32
        })
    }

    fn ends(&self) -> [Rgb; 3] {
        [self.zenith, self.horizon, self.ground]
    }
}

/// Returns `∫ max(−sin θ, 0) dθ` (up) and `∫ max(sin θ, 0) dθ` (down) between two angles: the weights of the zenith
/// and of the ground of a gradient.
pub fn sines(from: f64, to: f64) -> [f64; 2] {
    let [(before, start), (after, end)] = [from, to].map(|angle| {
        let (turns, cosine) = ((angle / TAU).floor(), angle.cos());
        // Down, from 0 on: 2 in each whole turn, all of it in the first half.
        let down = if angle - turns * TAU < PI { 1.0 - cosine } else { 2.0 };
        (2.0 * turns + down, cosine)
    });
    let down = after - before;
    [down - (start - end), down]
}

impl From<Rgb> for Sky {
    fn from(radiance: Rgb) -> Self {
        Self::Uniform(radiance)
    }
}

impl From<Gradient> for Sky {
    fn from(gradient: Gradient) -> Self {
        Self::Gradient(gradient)
    }
}

impl From<Panorama> for Sky {
    fn from(panorama: Panorama) -> Self {
        Self::Panorama(panorama)
    }
}

impl Default for Sky {
    fn default() -> Self {
        Self::BLACK
    }
}

/// The black sky, for inputs that borrow theirs.
impl Default for &Sky {
    fn default() -> Self {
        &Sky::BLACK
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_are_their_integrals() {
        for step in 0..200 {
            let from = -7.0 + 0.04 * f64::from(step);
            let to = from + 0.01 + 0.03 * f64::from(step);
            let n = 20_000;
            let width = (to - from) / f64::from(n);
            let sum = |sign: f64| {
                let value = |i| (sign * (from + (f64::from(i) + 0.5) * width).sin()).max(0.0);
                (0..n).map(value).sum::<f64>() * width
            };
            let [up, down] = sines(from, to);
            // The midpoint rule's error, at a kink too.
            assert!((up - sum(-1.0)).abs() < 1e-6 && (down - sum(1.0)).abs() < 1e-6, "{from}");
        }
    }
}
