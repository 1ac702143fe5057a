//! Relief: the light of surfaces that are tilted out of the plane, by a normal per cell.
//!
//! Light runs in the plane, and a picture is seen from above. To light a tilted surface, light is taken to arrive from
//! above the plane at the elevation ε ([`Settings::elevation`](crate::Settings::elevation)). A surface of unit normal n,
//! z towards the viewer, then receives
//!
//! `E(n) = (1/2π) ∫ L·max(0, n·(ω cos ε, sin ε)) dω / sin ε ≈ max(0, n_z·J + cot ε·(n_x·m_x + n_y·m_y))`
//!
//! by the mean radiance J and its first moment m. Divided by sin ε, a surface that is not tilted receives J, as without
//! normals. The right side is exact where no part of the light comes from behind the surface, and where it all comes from
//! one direction; in between, light from behind takes away what it should not. The worst case is a steep surface between two
//! equal lights: exact up to 90° − ε, and at ε = 45° it is 27 % too dark if tilted by 60°.
//!
//! Lamps with a height and suns may have an elevation of their own ([`crate::elevation`]). It is in their moments, as a
//! factor on cot ε, so the sum stays exact where it was.
//!
//! Highlights are those of Blinn (1977), for the one direction that light comes from in the mean: with l the unit vector
//! along `(cot ε·m, min(|m|, J))`, h halfway between l and the viewer, `α = roughness²` and `p = 2/α² − 2` (Karis 2013),
//!
//! `specular·(p + 8)/8·max(0, n·h)^p·max(0, n·l)/l_z·min(|m|, J)`
//!
//! So light at ε has its highlight at ε, and lower light, whose moment is longer than J, at its own elevation. Limit: a
//! moment shorter than J may be that of steep light or of light from all around. It counts as the latter, so highlights
//! fade near a lamp that hangs higher than `d·tan ε`.

use crate::srgb::luminance;
use crate::{Error, Moment, Result, Rgb};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A unit normal: x to the right, y down, z towards the viewer.
pub type Normal = [f32; 3];

/// The least light ÷ the length of its moment that counts for highlights: less than any light has, but for rounding.
pub const LEAST_LIGHT: f32 = 1e-3;

/// The lighting of cells that have a normal ([`Cells::normals`](crate::Cells::normals)).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Relief {
    /// The strength of highlights, 0 to 1; 0 is none.
    pub specular: f32,
    /// The roughness of the surface, 0.05 to 1. Lower: smaller and brighter highlights.
    pub roughness: f32,
}

impl Default for Relief {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Relief {
    /// Without highlights.
    pub(crate) const DEFAULT: Self = Self { specular: 0.0, roughness: 0.5 };
    /// The least roughness: highlights of less would fall between two pixels.
    const SMOOTHEST: f32 = 0.05;

    /// Returns whether these are the defaults.
    pub(crate) fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// Rejects values out of their range.
    pub fn check(&self) -> Result<()> {
        let within = |key: &str, value: f32, [least, most]: [f32; 2], expected: &str| {
            if (least..=most).contains(&value) {
                return Ok(());
            }
            Err(Error::value(format!("relief.{key}"), value, expected))
        };
        within("specular", self.specular, [0.0, 1.0], "0 to 1")?;
        within("roughness", self.roughness, [Self::SMOOTHEST, 1.0], "0.05 to 1")
    }

    /// The exponent of Blinn's highlights, `2/roughness⁴ − 2`.
    pub fn exponent(&self) -> f32 {
        2.0 / self.roughness.powi(4) - 2.0
    }

    /// Returns the light that a surface receives, and its highlight; `elevation` is that of all light, radians.
    pub fn shade(&self, normal: Normal, light: Rgb, moment: &Moment, elevation: f32) -> (Rgb, Rgb) {
        let [nx, ny, nz] = normal;
        let cotangent = elevation.cos() / elevation.sin();
        let [mx, my] = moment;
        let received = std::array::from_fn(|c| {
            (nz * light[c] + cotangent * (nx * mx[c] + ny * my[c])).max(0.0)
        });
        let [x, y] = [luminance(*mx), luminance(*my)];
        let length = x.hypot(y);
        if self.specular == 0.0 || length == 0.0 {
            return (received, [0.0; 3]);
        }
        let up = (luminance(light) / length).clamp(LEAST_LIGHT, 1.0);
        let to_light = unit([cotangent * x / length, cotangent * y / length, up]);
        // Halfway to the viewer, at z = 1.
        let half = unit([to_light[0], to_light[1], to_light[2] + 1.0]);
        let dot = |v: [f32; 3]| (nx * v[0] + ny * v[1] + nz * v[2]).max(0.0);
        let power = self.exponent();
        let lobe = dot(half).min(1.0).powf(power) * dot(to_light) / to_light[2];
        let gain = self.specular * (power + 8.0) / 8.0 * lobe;
        (received, [0, 1, 2].map(|c| gain * mx[c].hypot(my[c]).min(light[c])))
    }
}

/// Decodes a pixel of a normal map, `n·½ + ½`: 128 of 255 is 0. The result has no unit length yet.
pub(crate) fn decode(rgb: Rgb) -> Normal {
    rgb.map(|v| ((v * 255.0 - 128.0) / 127.0).clamp(-1.0, 1.0))
}

/// The normal of a surface that is not tilted.
pub const UP: Normal = [0.0, 0.0, 1.0];

/// The normal of a surface that rises by this many px per px to the right and down: `(−∂h/∂x, −∂h/∂y, 1)`, of unit
/// length. Heights of a picture become its normals by it ([`Cells::normals_mut`](crate::Cells::normals_mut)).
pub fn normal_of_slope([right, down]: [f32; 2]) -> Normal {
    unit([-right, -down, 1.0])
}

/// The normal in a direction; [`UP`] if it has no length.
pub(crate) fn unit(direction: Normal) -> Normal {
    let length = direction.iter().map(|v| v * v).sum::<f32>().sqrt();
    if length < 1e-3 { UP } else { direction.map(|v| v / length) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::moment;
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

    /// Rounding of 32-bit floats.
    const ROUNDING: f32 = 1e-6;

    #[test]
    fn a_flat_surface_receives_the_mean_radiance() {
        let light = [1.0, 0.5, 0.25];
        for elevation in [0.1, 0.8, 1.5] {
            let shaded = Relief::default().shade(UP, light, &[[0.3; 3], [-0.2; 3]], elevation);
            assert_eq!(shaded, (light, [0.0; 3]));
        }
    }

    #[test]
    fn light_from_one_direction_follows_the_cosine() {
        for (turn, elevation) in [(0.0f32, 0.3f32), (1.0, FRAC_PI_4), (2.5, 1.2)] {
            let way = [turn.cos(), turn.sin()];
            let m = moment::from_direction([1.0; 3], way);
            for tilt in [-1.2f32, -0.4, 0.3, 1.3] {
                let normal = [tilt.sin() * way[0], tilt.sin() * way[1], tilt.cos()];
                let (received, _) = Relief::default().shade(normal, [1.0; 3], &m, elevation);
                let cosine = elevation.cos() * tilt.sin() + elevation.sin() * tilt.cos();
                let expected = cosine.max(0.0) / elevation.sin();
                assert!((received[0] - expected).abs() < 8.0 * ROUNDING, "{received:?} {expected}");
            }
        }
    }

    /// The highlight of light of 1 from +x, whose moment is this long, on a surface tilted that way.
    fn highlight(tilt: f32, roughness: f32, moment: f32) -> f32 {
        let relief = Relief { specular: 1.0, roughness };
        let m = moment::from_direction([moment; 3], [1.0, 0.0]);
        relief.shade([tilt.sin(), 0.0, tilt.cos()], [1.0; 3], &m, FRAC_PI_4).1[1]
    }

    #[test]
    fn highlights_are_brightest_halfway_and_narrow_where_smooth() {
        let halfway = 0.5 * (FRAC_PI_2 - FRAC_PI_4);
        let lit = |tilt, roughness| highlight(tilt, roughness, 1.0);
        for roughness in [0.2, 0.5] {
            let best = lit(halfway, roughness);
            assert!(best > lit(halfway + 0.3, roughness), "{roughness}");
            assert!(best > lit(halfway - 0.3, roughness), "{roughness}");
        }
        let fades = |roughness| lit(halfway + 0.2, roughness) / lit(halfway, roughness);
        assert!(fades(0.2) < 0.5 * fades(0.5));
    }

    #[test]
    fn highlights_of_low_light_lie_halfway_to_it_and_those_of_light_from_around_fade() {
        // Light whose moment is 3 times as long arrives at acot 3.
        let low = 0.5 * (FRAC_PI_2 - (1.0f32 / 3.0).atan());
        let best = highlight(low, 0.2, 3.0);
        assert!(best > highlight(low - 0.2, 0.2, 3.0) && best > highlight(low + 0.2, 0.2, 3.0));
        let halfway = 0.5 * (FRAC_PI_2 - FRAC_PI_4);
        let half = highlight(halfway, 0.2, 0.5) / highlight(halfway, 0.2, 1.0);
        assert!((half - 0.5).abs() < 4.0 * ROUNDING, "{half}");
        assert_eq!(highlight(halfway, 0.2, 0.0), 0.0);
    }

    #[test]
    fn the_middle_of_a_byte_is_decoded_as_0() {
        let byte = |v: [u8; 3]| decode(v.map(|v| f32::from(v) / 255.0));
        assert_eq!(byte([128, 128, 255]), UP);
        assert_eq!(byte([255, 128, 0])[..2], [1.0, 0.0]);
        assert_eq!(byte([255, 128, 0])[2], -1.0);
    }

    #[test]
    fn slopes_tilt_surfaces_away_from_where_they_rise() {
        assert_eq!(normal_of_slope([0.0; 2]), UP);
        let [x, y, z] = normal_of_slope([0.75, 0.0]);
        assert!((x + 0.6).abs() < ROUNDING && y == 0.0 && (z - 0.8).abs() < ROUNDING);
        assert!(normal_of_slope([0.0, -2.0])[1] > 0.8);
    }

    #[test]
    fn wrong_values_are_refused_by_their_key() {
        for (relief, key) in [
            (Relief { specular: 2.0, ..Relief::default() }, "relief.specular"),
            (Relief { roughness: 0.0, ..Relief::default() }, "relief.roughness"),
        ] {
            let error = relief.check().unwrap_err().to_string();
            assert!(error.contains(key), "{error}");
        }
        Relief::default().check().unwrap();
    }
}
