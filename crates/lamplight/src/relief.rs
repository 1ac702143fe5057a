//! Relief: the light of surfaces that are tilted out of the plane, by a normal per cell.
//!
//! Light runs in the plane, and a picture is seen from above. To light a tilted surface, light is taken to arrive from
//! above the plane at the elevation ε. A surface of unit normal n, z towards the viewer, then receives
//!
//! `E(n) = (1/2π) ∫ L·max(0, n·(ω cos ε, sin ε)) dω / sin ε ≈ max(0, n_z·J + cot ε·(n_x·m_x + n_y·m_y))`
//!
//! by the mean radiance J and its first moment m. Divided by sin ε, a surface that is not tilted receives J, as without
//! normals. The right side is exact where no part of the light comes from behind the surface, and where it all comes from
//! one direction; in between, light from behind takes away what it should not. The worst case is a steep surface between two
//! equal lights: exact up to 90° − ε, and at ε = 45° it is 27 % too dark if tilted by 60°.
//!
//! Highlights are those of Blinn (1977), for the one direction d = m/|m| that light comes from in the mean: with
//! l = (d cos ε, sin ε), h halfway between l and the viewer, `α = roughness²` and `p = 2/α² − 2` (Karis 2013),
//!
//! `specular·(p + 8)/8·max(0, n·h)^p·max(0, n·l)/sin ε·|m|`

use crate::notation;
use crate::srgb::luminance;
use crate::{Error, Moment, Result, Rgb};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};

/// A unit normal: x to the right, y down, z towards the viewer.
pub type Normal = [f32; 3];

/// The lighting of cells that have a normal ([`Cells::normals`](crate::Cells::normals)).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Relief {
    /// The elevation of light above the plane, radians (or degrees as text, `"45deg"`), 0.05 to π/2. Lower: stronger
    /// relief, with darker slopes; at π/2 normals only darken.
    #[serde(deserialize_with = "notation::angle")]
    #[schemars(with = "notation::Angle")]
    pub elevation: f32,
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
    /// Light at 45°, without highlights.
    pub(crate) const DEFAULT: Self = Self { elevation: FRAC_PI_4, specular: 0.0, roughness: 0.5 };
    /// The least elevation, radians.
    const LOWEST: f32 = 0.05;
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
        let elevations = [Self::LOWEST, FRAC_PI_2];
        within("elevation", self.elevation, elevations, "an angle from 0.05 to π/2 (90deg)")?;
        within("specular", self.specular, [0.0, 1.0], "0 to 1")?;
        within("roughness", self.roughness, [Self::SMOOTHEST, 1.0], "0.05 to 1")
    }

    /// The exponent of Blinn's highlights, `2/roughness⁴ − 2`.
    pub fn exponent(&self) -> f32 {
        2.0 / self.roughness.powi(4) - 2.0
    }

    /// Returns the light that a surface receives, and its highlight.
    pub fn shade(&self, normal: Normal, light: Rgb, moment: &Moment) -> (Rgb, Rgb) {
        let [nx, ny, nz] = normal;
        let [sin, cos] = [self.elevation.sin(), self.elevation.cos()];
        let [mx, my] = moment;
        let received = std::array::from_fn(|c| {
            (nz * light[c] + cos / sin * (nx * mx[c] + ny * my[c])).max(0.0)
        });
        if self.specular == 0.0 {
            return (received, [0.0; 3]);
        }
        let [x, y] = [luminance(*mx), luminance(*my)];
        let length = x.hypot(y);
        if length == 0.0 {
            return (received, [0.0; 3]);
        }
        let to_light = [x / length * cos, y / length * cos, sin];
        // Halfway to the viewer, at z = 1.
        let half = [to_light[0], to_light[1], to_light[2] + 1.0];
        let dot = |v: [f32; 3]| (nx * v[0] + ny * v[1] + nz * v[2]).max(0.0);
        let along_half = dot(half) / half.iter().map(|v| v * v).sum::<f32>().sqrt();
        let power = self.exponent();
        let gain =
            self.specular * (power + 8.0) / 8.0 * along_half.min(1.0).powf(power) * dot(to_light)
                / sin;
        (received, [0, 1, 2].map(|c| gain * mx[c].hypot(my[c])))
    }
}

/// Decodes a pixel of a normal map, `n·½ + ½` with y up: 128 of 255 is 0.
pub(crate) fn decode(rgb: Rgb) -> Normal {
    let [x, y, z] = rgb.map(|v| ((v * 255.0 - 128.0) / 127.0).clamp(-1.0, 1.0));
    unit([x, -y, z])
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

    /// Rounding of 32-bit floats.
    const ROUNDING: f32 = 1e-6;

    #[test]
    fn a_flat_surface_receives_the_mean_radiance() {
        let light = [1.0, 0.5, 0.25];
        for elevation in [0.1, 0.8, FRAC_PI_2] {
            let relief = Relief { elevation, ..Relief::default() };
            let (received, highlight) = relief.shade(UP, light, &[[0.3; 3], [-0.2; 3]]);
            assert_eq!((received, highlight), (light, [0.0; 3]));
        }
    }

    #[test]
    fn light_from_one_direction_follows_the_cosine() {
        for turn in [0.0f32, 1.0, 2.5] {
            let way = [turn.cos(), turn.sin()];
            let m = moment::from_direction([1.0; 3], way);
            for tilt in [-1.2f32, -0.4, 0.3, 1.3] {
                let normal = [tilt.sin() * way[0], tilt.sin() * way[1], tilt.cos()];
                let (received, _) = Relief::default().shade(normal, [1.0; 3], &m);
                let expected = (FRAC_PI_4.cos() * tilt.sin() + FRAC_PI_4.sin() * tilt.cos())
                    .max(0.0)
                    / FRAC_PI_4.sin();
                assert!((received[0] - expected).abs() < 4.0 * ROUNDING, "{received:?} {expected}");
            }
        }
    }

    #[test]
    fn highlights_are_brightest_halfway_and_narrow_where_smooth() {
        let m = moment::from_direction([1.0; 3], [1.0, 0.0]);
        let highlight = |tilt: f32, roughness: f32| {
            let relief = Relief { specular: 1.0, roughness, ..Relief::default() };
            relief.shade([tilt.sin(), 0.0, tilt.cos()], [1.0; 3], &m).1[1]
        };
        let halfway = 0.5 * (FRAC_PI_2 - FRAC_PI_4);
        for roughness in [0.2, 0.5] {
            let best = highlight(halfway, roughness);
            assert!(best > highlight(halfway + 0.3, roughness), "{roughness}");
            assert!(best > highlight(halfway - 0.3, roughness), "{roughness}");
        }
        let fades = |roughness| highlight(halfway + 0.2, roughness) / highlight(halfway, roughness);
        assert!(fades(0.2) < 0.5 * fades(0.5));
    }

    #[test]
    fn maps_are_decoded_with_y_up() {
        let byte = |v: [u8; 3]| decode(v.map(|v| f32::from(v) / 255.0));
        assert_eq!(byte([128, 128, 255]), UP);
        assert!(byte([255, 128, 128])[0] > 0.999);
        assert!(byte([128, 255, 128])[1] < -0.999);
        assert_eq!(byte([128; 3]), UP);
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
            (Relief { elevation: 0.0, ..Relief::default() }, "relief.elevation"),
            (Relief { elevation: f32::NAN, ..Relief::default() }, "relief.elevation"),
            (Relief { specular: 2.0, ..Relief::default() }, "relief.specular"),
            (Relief { roughness: 0.0, ..Relief::default() }, "relief.roughness"),
        ] {
            let error = relief.check().unwrap_err().to_string();
            assert!(error.contains(key), "{error}");
        }
        Relief::default().check().unwrap();
    }
}
