//! Matter and occluders: entities that emit, block, filter and reflect light.

use bevy::prelude::*;

/// Makes an entity part of the light: its sprite, text, tilemap chunk, or mesh with a
/// [`ColorMaterial`](bevy::sprite_render::ColorMaterial). Alpha and colour are those that are drawn.
///
/// It affects light anywhere on the lit grid, on the screen or in the border around it, unless it is
/// hidden ([`Visibility`]) or on other layers than the camera
/// ([`RenderLayers`](bevy::camera::visibility::RenderLayers)).
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct Matter2d {
    /// Emitted radiance, 0 or more; multiplied by the drawn colour, and then at most 60,000. Black does not glow.
    pub emission: LinearRgba,
    /// Fraction of light that is lost per world unit, 0 to 1; multiplied by the drawn alpha. 1 is a
    /// solid wall. Emissive matter needs a value above 0, because it emits `emission × opacity`.
    pub opacity: f32,
    /// Colour filter per world unit, 0 to 1 per channel, as in stained glass. The transmittance of 100
    /// units of 0.99 is 0.37.
    pub tint: LinearRgba,
    /// Fraction of light that is reflected or scattered, 0 to 1 per channel; multiplied by the drawn
    /// colour.
    pub albedo: LinearRgba,
}

impl Default for Matter2d {
    /// A solid wall.
    fn default() -> Self {
        Self::wall()
    }
}

impl Matter2d {
    /// Albedo of walls.
    const WALL_ALBEDO: f32 = 0.8;

    /// A wall that blocks light and reflects most of what its colours would.
    pub const fn wall() -> Self {
        Self {
            emission: LinearRgba::BLACK,
            opacity: 1.0,
            tint: LinearRgba::WHITE,
            albedo: LinearRgba::rgb(Self::WALL_ALBEDO, Self::WALL_ALBEDO, Self::WALL_ALBEDO),
        }
    }

    /// A light source that emits `strength` times its own colours, and blocks light.
    pub const fn glow(strength: f32) -> Self {
        let emission = LinearRgba::rgb(strength, strength, strength);
        Self { emission, albedo: LinearRgba::BLACK, ..Self::wall() }
    }

    /// Glass that colours the light passing through it. The tint is per world unit.
    pub const fn glass(tint: LinearRgba) -> Self {
        Self { opacity: 0.0, tint, albedo: LinearRgba::BLACK, ..Self::wall() }
    }

    /// Fog that scatters a fraction of light per world unit.
    pub const fn fog(opacity: f32) -> Self {
        Self { opacity, albedo: LinearRgba::WHITE, ..Self::wall() }
    }
}

/// An invisible solid shape around the entity's origin that blocks light. It is in the entity's own units
/// and follows its transform. If the entity has a [`Matter2d`], the shape is made of it, in white.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
#[require(Transform, Visibility)]
pub struct LightOccluder2d {
    /// Its outline.
    pub shape: OccluderShape,
}

impl Default for LightOccluder2d {
    fn default() -> Self {
        Self::rectangle(16.0, 16.0)
    }
}

impl LightOccluder2d {
    /// A rectangle.
    pub fn rectangle(width: f32, height: f32) -> Self {
        Self { shape: OccluderShape::Rectangle { size: Vec2::new(width, height) } }
    }

    /// A circle.
    pub fn circle(radius: f32) -> Self {
        Self { shape: OccluderShape::Circle { radius } }
    }

    /// An upright capsule: all points within `radius` of a segment of `length`.
    pub fn capsule(radius: f32, length: f32) -> Self {
        Self { shape: OccluderShape::Capsule { radius, length } }
    }

    /// A simple polygon. It is closed automatically.
    pub fn polygon(points: impl Into<Vec<Vec2>>) -> Self {
        Self { shape: OccluderShape::Polygon { points: points.into() } }
    }
}

/// The outline of a [`LightOccluder2d`].
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum OccluderShape {
    /// Width and height.
    Rectangle {
        /// Full size.
        size: Vec2,
    },
    /// A disc.
    Circle {
        /// Its radius.
        radius: f32,
    },
    /// All points within a distance of an upright segment.
    Capsule {
        /// Distance from the segment.
        radius: f32,
        /// Length of the segment.
        length: f32,
    },
    /// A simple polygon.
    Polygon {
        /// Three or more points, in either order. Fewer block nothing.
        points: Vec<Vec2>,
    },
}

/// Draws a sprite, text or mesh over the lit picture, in its own colours, as user interfaces need. Unlit
/// entities lie above everything lit, sorted by z among each other. Meshes need
/// [`AlphaMode2d::Blend`](bevy::sprite_render::AlphaMode2d::Blend), and sprites
/// [`SpriteAlphaMode::Blend`](bevy::sprite::SpriteAlphaMode::Blend), which is their default.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct Unlit2d;
