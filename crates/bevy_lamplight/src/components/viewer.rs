//! Viewers: who sees what.

use bevy::prelude::*;
use lamplight::{Cone, Sight};
use std::f32::consts::TAU;

/// An eye at an entity's position that looks along the entity's own x axis, for [`SightQuery`](crate::SightQuery).
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[require(Transform)]
pub struct Viewer2d {
    /// The distance from which on nothing is seen, world units.
    pub range: f32,
    /// The fraction of the range, from its end inwards, over which sight fades, 0 to 1.
    pub fade: f32,
    /// Radius of the eye, world units. Larger eyes see softly around corners, and less close to walls.
    pub radius: f32,
    /// Angle of the field of view from edge to edge, radians; 2π or more is all round.
    pub angle: f32,
    /// Fraction of the field of view, from the edge inwards, over which sight fades, 0 to 1.
    pub softness: f32,
}

impl Default for Viewer2d {
    /// Looks all round.
    fn default() -> Self {
        let Sight { range, fade, size, .. } = Sight::default();
        Self { range, fade, radius: size, angle: TAU, softness: 0.2 }
    }
}

impl Viewer2d {
    /// Converts to a viewer of `lamplight`, on a grid whose top left corner lies at `corner` of the world; `None` if it
    /// sees nothing.
    pub(crate) fn sight(
        &self,
        transform: &GlobalTransform,
        corner: Vec2,
        cell: f32,
    ) -> Option<Sight> {
        let place = (transform.translation().truncate() - corner) / cell;
        let ahead = transform.affine().transform_vector3(Vec3::X).truncate();
        let cone = Cone {
            direction: -ahead.to_angle(),
            angle: self.angle.clamp(0.001, TAU),
            softness: self.softness.clamp(0.0, 1.0),
            profile: None,
        };
        let sight = Sight {
            position: [place.x, -place.y],
            size: (self.radius / cell).clamp(0.05, 512.0),
            range: (self.range / cell).clamp(1.0, 1e5),
            fade: self.fade.clamp(0.0, 1.0),
            cone: (self.angle < TAU).then_some(cone),
        };
        let sees = self.range > 0.0 && self.angle > 0.0 && ahead != Vec2::ZERO;
        (sees && sight.check(&"viewer").is_ok()).then_some(sight)
    }
}
