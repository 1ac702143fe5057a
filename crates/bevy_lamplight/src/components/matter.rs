//! What glows, blocks, filters and reflects.

use bevy::prelude::*;

/// Makes what an entity shows take part in light: its sprite, text, mesh with a
/// [`ColorMaterial`](bevy::sprite_render::ColorMaterial), or tilemap chunk, as it is drawn, by its
/// own alpha and colour.
///
/// It counts wherever it lies on the lit grid, on the screen or in the border round it; not where
/// it is hidden ([`Visibility`]) or on other layers than the camera
/// ([`RenderLayers`](bevy::camera::visibility::RenderLayers)).
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct Matter2d {
    /// Multiplies the picture's colour: the radiance it gives off, 0 or more, unbounded. Black does
    /// not glow.
    pub emission: LinearRgba,
    /// Share of light that is lost in crossing one world unit, 0 to 1; 1 is a solid wall. The
    /// picture's alpha scales it. What is to glow has to be above 0, for it gives off
    /// `emission × opacity`.
    pub opacity: f32,
    /// Colour filter for each world unit crossed, 0 to 1 a channel: stained glass. A hundred units
    /// of 0.99 let through 0.37.
    pub tint: LinearRgba,
    /// Multiplies the picture's colour: the share of light that is sent on, 0 to 1 a channel.
    pub albedo: LinearRgba,
}

impl Default for Matter2d {
    /// A solid wall that sends on most of the light its colour would.
    fn default() -> Self {
        Self::wall()
    }
}

impl Matter2d {
    /// Share of light that walls send on.
    const WALL: f32 = 0.8;

    /// Blocks light and sends on what its colours do.
    pub const fn wall() -> Self {
        Self {
            emission: LinearRgba::BLACK,
            opacity: 1.0,
            tint: LinearRgba::WHITE,
            albedo: LinearRgba::rgb(Self::WALL, Self::WALL, Self::WALL),
        }
    }

    /// Gives off its own colours, so much brighter, and blocks light.
    pub const fn glow(strength: f32) -> Self {
        let emission = LinearRgba::rgb(strength, strength, strength);
        Self { emission, albedo: LinearRgba::BLACK, ..Self::wall() }
    }

    /// Lets light through and colours it; the tint is of each world unit.
    pub const fn glass(tint: LinearRgba) -> Self {
        Self { opacity: 0.0, tint, albedo: LinearRgba::BLACK, ..Self::wall() }
    }

    /// Stops a share of light in each world unit, and scatters it.
    pub const fn fog(opacity: f32) -> Self {
        Self { opacity, albedo: LinearRgba::WHITE, ..Self::wall() }
    }
}

/// A solid shape without a picture that blocks light, around the entity's origin, in its own units;
/// it turns and grows with its transform. With a [`Matter2d`] beside it, the shape is made of that
/// instead, in white.
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

    /// A capsule that stands upright: a segment of this length, this far around it.
    pub fn capsule(radius: f32, length: f32) -> Self {
        Self { shape: OccluderShape::Capsule { radius, length } }
    }

    /// A polygon, closed by itself, that does not cross itself.
    pub fn polygon(points: impl Into<Vec<Vec2>>) -> Self {
        Self { shape: OccluderShape::Polygon { points: points.into() } }
    }
}

/// The outline of a [`LightOccluder2d`].
#[derive(Clone, Debug, PartialEq, Reflect)]
#[reflect(Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub enum OccluderShape {
    /// Width and height.
    Rectangle {
        /// Full size.
        size: Vec2,
    },
    /// All within a distance.
    Circle {
        /// Distance from the middle.
        radius: f32,
    },
    /// All within a distance of an upright segment.
    Capsule {
        /// Distance from the segment.
        radius: f32,
        /// Length of the segment.
        length: f32,
    },
    /// Corners in order; either way round.
    Polygon {
        /// Three or more; fewer block nothing.
        points: Vec<Vec2>,
    },
}

/// Draws a sprite, text or transparent mesh over the lit picture, in its own colours: for what
/// belongs to the screen and not to the world. It lies above everything that is lit, in the order of
/// z among its kind. Opaque meshes need
/// [`AlphaMode2d::Blend`](bevy::sprite_render::AlphaMode2d::Blend).
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct Unlit2d;
