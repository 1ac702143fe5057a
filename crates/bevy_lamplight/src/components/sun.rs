//! Suns.

use super::lamps::radiance;
use bevy::prelude::*;
use lamplight::{ALL_LAYERS, Direct, Sun};
use std::f32::consts::FRAC_PI_2;

/// A sun: parallel light from beyond the lit grid, which travels along the entity's own x axis; its place does not
/// matter. Every method lights it exactly, with shadows whose edges are as soft as the sun is wide.
///
/// Matter beyond the grid throws no shadow into it: a larger [`border`](crate::Lighting2d::border) of the camera
/// lets longer shadows in.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[require(Transform, Visibility)]
pub struct SunLight2d {
    /// Colour of the light.
    pub color: Color,
    /// Brightness; 0 is off. What a wall receives that the sun meets head on: a white one shows half of that, and the
    /// open 1/2π.
    pub intensity: f32,
    /// Apparent width, radians, 0.0001 to 0.5. Higher: softer shadows.
    pub angle: f32,
    /// The light layers that it lights, as in [`PointLight2d::mask`](crate::PointLight2d::mask).
    pub mask: u8,
    /// The elevation above the plane at which its light arrives, radians, 0.05 to π/2, for surfaces with a
    /// [`NormalMap2d`](crate::NormalMap2d). `None`: that of all light ([`Relief2d`](crate::Relief2d)).
    pub elevation: Option<f32>,
    /// If true, its light is part of the sky: for nothing, at the angular resolution of the method. `false`: exact
    /// shadows, which take about as long as all other light. Without effect in `polar` and `flood`, and for suns with a
    /// mask or an elevation.
    pub glow: bool,
}

impl Default for SunLight2d {
    fn default() -> Self {
        let Sun { intensity, angle, .. } = Sun::default();
        let mask = ALL_LAYERS;
        Self { color: Color::WHITE, intensity, angle, mask, elevation: None, glow: false }
    }
}

impl SunLight2d {
    /// Converts to a sun of `lamplight`, whose y points down; `None` if it is off or a value is not finite.
    pub(crate) fn sun(&self, transform: &GlobalTransform) -> Option<Sun> {
        let travels = transform.affine().transform_vector3(Vec3::X).truncate();
        let sun = Sun {
            direction: -travels.to_angle(),
            angle: self.angle.clamp(1e-4, 0.5),
            color: radiance(self.color, self.intensity),
            intensity: 1.0,
            elevation: self.elevation.map(|elevation| elevation.clamp(0.05, FRAC_PI_2)),
            direct: if self.glow { Direct::Glow } else { Direct::Exact },
            mask: self.mask,
        };
        let is_on = sun.color != [0.0; 3] && travels != Vec2::ZERO;
        (is_on && sun.check(&"sun").is_ok()).then_some(sun)
    }
}
