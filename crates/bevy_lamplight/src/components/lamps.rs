//! Lamps, and light from everywhere.

use bevy::prelude::*;
use lamplight::{Cone, Falloff, Gradient, Lamp, Sky};
use std::f32::consts::{FRAC_PI_3, PI};

/// A lamp at an entity's place.
///
/// For the methods that see what glows (`holographic`, `cascades`, `raymarch`) it is a small disc,
/// and its light falls off as light in a plane does: at a distance `d` in the open there arrives
///
/// ```text
/// color · intensity · range / (4 d)
/// ```
///
/// which is `intensity` at a quarter of the range, and a quarter of it at the range. `polar` and
/// `flood` light it by their rule: `intensity` at the lamp, nothing beyond the range. What is around
/// the lamp blocks its light as it does any other; a lamp in a wall shines out of it.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[require(Transform, Visibility)]
pub struct PointLight2d {
    /// Colour of the light.
    pub color: Color,
    /// How bright it is; 0 is off.
    pub intensity: f32,
    /// How far it reaches, world units.
    pub range: f32,
    /// Radius of what glows, world units: larger lamps have softer shadows and no more light. Less than
    /// two cells is as two cells, so that the smallest lamps are as bright.
    pub radius: f32,
    /// How light fades, for `polar` and `flood`.
    pub falloff: Falloff2d,
}

impl Default for PointLight2d {
    fn default() -> Self {
        Self {
            color: Color::WHITE,
            intensity: 1.0,
            range: 128.0,
            radius: 8.0,
            falloff: Falloff2d::default(),
        }
    }
}

/// A lamp that shines one way: along the entity's own x axis, so that a rotation of 0 lights what is
/// to the right.
///
/// It is lit by the rule of `polar`, whatever the camera's method: `intensity` at the lamp, fading to
/// nothing at the range; shadows, glass and fog as for any light. Its light is not sent on by walls,
/// but for `flood`.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[require(Transform, Visibility)]
pub struct SpotLight2d {
    /// Colour of the light.
    pub color: Color,
    /// How bright it is; 0 is off.
    pub intensity: f32,
    /// How far it reaches, world units.
    pub range: f32,
    /// Radius of the lamp, world units: larger ones have softer shadows.
    pub radius: f32,
    /// Angle from edge to edge, radians.
    pub angle: f32,
    /// Share of the way from the middle to either edge over which light fades, 0 to 1.
    pub softness: f32,
    /// How light fades with distance.
    pub falloff: Falloff2d,
}

impl Default for SpotLight2d {
    fn default() -> Self {
        let PointLight2d { color, intensity, radius, falloff, .. } = PointLight2d::default();
        let (range, angle, softness) = (256.0, FRAC_PI_3, 0.5);
        Self { color, intensity, range, radius, angle, softness, falloff }
    }
}

/// How light fades to nothing at a lamp's range ([`lamplight::Falloff`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub enum Falloff2d {
    /// Evenly.
    #[default]
    Linear,
    /// Slowly at first and at last.
    Smooth,
    /// By one over the distance, cut off at the range.
    Inverse,
}

impl From<Falloff2d> for Falloff {
    fn from(falloff: Falloff2d) -> Self {
        match falloff {
            Falloff2d::Linear => Self::Linear,
            Falloff2d::Smooth => Self::Smooth,
            Falloff2d::Inverse => Self::Inverse,
        }
    }
}

/// On a camera with [`Lighting2d`](crate::Lighting2d): light that arrives everywhere, in walls too,
/// so that nothing is black.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct AmbientLight2d {
    /// Colour of the light.
    pub color: Color,
    /// Multiplies it.
    pub brightness: f32,
}

impl Default for AmbientLight2d {
    fn default() -> Self {
        Self { color: Color::WHITE, brightness: 0.1 }
    }
}

impl AmbientLight2d {
    /// What arrives.
    pub(crate) fn radiance(&self) -> [f32; 3] {
        radiance(self.color, self.brightness)
    }
}

/// On a camera with [`Lighting2d`](crate::Lighting2d): the light that comes from beyond the lit grid,
/// from above, the sides and below. It falls in from outside and is blocked as other light is: outdoors
/// in a side view. For views from above, which have no outside, see [`AmbientLight2d`].
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct Sky2d {
    /// From straight up.
    pub zenith: Color,
    /// From the sides.
    pub horizon: Color,
    /// From straight down.
    pub ground: Color,
    /// Multiplies all three.
    pub brightness: f32,
}

impl Default for Sky2d {
    /// A clear day.
    fn default() -> Self {
        Self {
            zenith: Color::linear_rgb(0.3, 0.5, 1.0),
            horizon: Color::linear_rgb(0.7, 0.8, 1.0),
            ground: Color::BLACK,
            brightness: 1.0,
        }
    }
}

impl Sky2d {
    /// The library's sky.
    pub(crate) fn sky(&self) -> Sky {
        let [zenith, horizon, ground] =
            [self.zenith, self.horizon, self.ground].map(|color| radiance(color, self.brightness));
        Sky::Gradient(Gradient { zenith, horizon, ground })
    }
}

/// Brightest that what glows is drawn: half floats hold as much, with room for sums.
pub(crate) const BRIGHTEST: f32 = 60_000.0;

/// What a colour of some brightness gives; nothing of what no light is.
fn radiance(color: Color, brightness: f32) -> [f32; 3] {
    let LinearRgba { red, green, blue, .. } = color.to_linear();
    [red, green, blue].map(|v| v * brightness).map(|v| if v.is_finite() { v.max(0.0) } else { 0.0 })
}

/// A lamp of either kind, in world units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WorldLamp {
    pub position: Vec2,
    pub color: [f32; 3],
    pub range: f32,
    pub radius: f32,
    pub falloff: Falloff2d,
    /// Direction (radians, y up), angle and softness of a spot.
    pub cone: Option<[f32; 3]>,
}

impl WorldLamp {
    /// None where it lights nothing, or is nowhere.
    pub fn point(lamp: &PointLight2d, transform: &GlobalTransform) -> Option<Self> {
        let PointLight2d { color, intensity, range, radius, falloff } = *lamp;
        let position = transform.translation().truncate();
        let color = radiance(color, intensity);
        let is_a_size = range.is_finite() && range > 0.0 && radius.is_finite() && radius >= 0.0;
        (is_a_size && position.is_finite() && color != [0.0; 3]).then_some(Self {
            position,
            color,
            range,
            radius,
            falloff,
            cone: None,
        })
    }

    /// The same for a spot.
    pub fn spot(lamp: &SpotLight2d, transform: &GlobalTransform) -> Option<Self> {
        let SpotLight2d { color, intensity, range, radius, angle, softness, falloff } = *lamp;
        let point = PointLight2d { color, intensity, range, radius, falloff };
        let ahead = transform.affine().transform_vector3(Vec3::X).truncate();
        let cone = [ahead.to_angle(), angle, softness];
        let lamp = Self::point(&point, transform)?;
        (cone.iter().all(|v| v.is_finite()) && ahead != Vec2::ZERO && angle > 0.0)
            .then_some(Self { cone: Some(cone), ..lamp })
    }

    /// As the library knows it, on a grid whose left and top lies at `corner` of the world.
    pub fn on_grid(&self, corner: Vec2, cell: f32) -> Lamp {
        let place = (self.position - corner) / cell;
        Lamp {
            position: [place.x, -place.y],
            color: self.color,
            intensity: 1.0,
            range: (self.range / cell).clamp(1.0, 1e5),
            size: (self.radius / cell).clamp(0.05, 512.0),
            falloff: self.falloff.into(),
            cone: self.cone.map(|[direction, angle, softness]| Cone {
                direction: -direction,
                angle: angle.clamp(0.001, 2.0 * PI),
                softness: softness.clamp(0.0, 1.0),
            }),
        }
    }

    /// The disc that stands for it where methods see what glows, its radiance for a colour: of a disc
    /// of radius r and radiance E there arrives `E · 2r / (2π d)`, the share of the circle it fills.
    pub fn disc(&self, corner: Vec2, cell: f32) -> Lamp {
        /// Cells; the light of smaller discs falls between rays.
        const LEAST: f32 = 2.0;
        let lamp = self.on_grid(corner, cell);
        let size = lamp.size.max(LEAST);
        let gain = PI * self.range / (4.0 * size * cell);
        Lamp { size, color: self.color.map(|c| (c * gain).min(BRIGHTEST)), ..lamp }
    }
}
