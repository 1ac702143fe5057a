//! Suns: parallel light from beyond the grid.

use crate::mask::ALL_LAYERS;
use crate::{Direct, Result, Rgb, check, mask, notation};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f32::consts::{FRAC_PI_2, TAU};
use std::fmt::Display;

/// A sun: a part of the sky so narrow that it throws shadows, by default lit exactly in every method.
///
/// Its radiance L is even over its apparent width w, so a face that it meets head on receives
/// `E = ∫L cosθ dθ = 2L·sin(w/2)`, and an open cell the mean radiance `J = L·w/2π`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sun {
    /// The way its light travels, radians from +x towards +y (down), −2π to 2π: `"90deg"` is straight down.
    #[serde(deserialize_with = "notation::angle")]
    #[schemars(with = "notation::Angle")]
    pub direction: f32,
    /// Its apparent width, radians, 0.0001 to 0.5. Higher: softer shadows. The sun of the earth has 0.0093; what
    /// is wider is a sky.
    #[serde(default = "default_angle", deserialize_with = "notation::angle")]
    #[schemars(with = "notation::Angle")]
    pub angle: f32,
    /// The colour, linear RGB.
    #[serde(default = "default_color", deserialize_with = "notation::color")]
    #[schemars(with = "notation::Color")]
    pub color: Rgb,
    /// Factor on the colour, 0 to 1e6: the irradiance of a face that the sun meets head on. An open cell shows
    /// about 1/2π of it, a white wall ½.
    #[serde(default = "default_intensity")]
    pub intensity: f32,
    /// The elevation above the plane at which its light arrives, for surfaces with normals, radians, 0.05 to π/2. Lower:
    /// stronger relief. Without it, that of all light. Light itself and its shadows do not depend on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[serde(deserialize_with = "notation::optional_angle")]
    #[schemars(with = "Option<notation::Angle>")]
    pub elevation: Option<f32>,
    /// The way in which its direct light is found. `exact`: by shadow lines to every cell, the same in all methods; it
    /// takes about as long as all other light. `glow`: as part of the sky, for nothing, at the method's angular
    /// resolution; suns with a mask or an elevation stay `exact`, and so do all suns in `polar` and `flood`.
    #[serde(default = "exact", skip_serializing_if = "is_exact")]
    #[schemars(default = "exact")]
    pub direct: Direct,
    /// The layers whose cells it lights, a bit each, 1 to 255. By default all; a sun that lights only some is `exact`.
    #[serde(default = "mask::all_layers", skip_serializing_if = "mask::is_all")]
    #[schemars(range(min = 1, max = 255))]
    pub mask: u8,
}

fn exact() -> Direct {
    Direct::Exact
}

fn is_exact(direct: &Direct) -> bool {
    *direct == Direct::Exact
}

fn default_angle() -> f32 {
    Sun::default().angle
}

fn default_color() -> Rgb {
    Sun::default().color
}

fn default_intensity() -> f32 {
    Sun::default().intensity
}

impl Default for Sun {
    fn default() -> Self {
        Self {
            direction: TAU / 4.0,
            angle: 0.02,
            color: [1.0; 3],
            intensity: 3.0,
            elevation: None,
            direct: Direct::Exact,
            mask: ALL_LAYERS,
        }
    }
}

impl Sun {
    /// Validates the sun; `key` names it in the error.
    pub fn check(&self, key: &dyn Display) -> Result<()> {
        check::direction(format_args!("{key}.direction"), self.direction)?;
        check::number(format_args!("{key}.angle"), self.angle, 1e-4..=0.5)?;
        check::radiance(format_args!("{key}.color"), self.color)?;
        check::number(format_args!("{key}.intensity"), self.intensity, 0.0..=1e6)?;
        if let Some(elevation) = self.elevation {
            check::number(format_args!("{key}.elevation"), elevation, 0.05..=FRAC_PI_2)?;
        }
        mask::check(format_args!("{key}.mask"), self.mask)
    }

    /// Returns whether its light is found by shadow lines in every method, not as part of the sky.
    pub fn is_exact(&self) -> bool {
        self.direct == Direct::Exact || self.mask != ALL_LAYERS || self.elevation.is_some()
    }

    /// Returns whether the sun emits no light.
    pub(crate) fn is_off(&self) -> bool {
        self.intensity == 0.0 || self.color == [0.0; 3]
    }

    /// Its radiance.
    pub fn radiance(&self) -> Rgb {
        let head_on = 2.0 * (0.5 * self.angle).sin();
        self.color.map(|c| c * self.intensity / head_on)
    }
}
