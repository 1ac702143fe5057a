//! Normal maps and relief: flat pictures that are lit as if their surface were tilted.

use bevy::prelude::*;
use lamplight::{Relief, Settings};

/// The normal map of an entity's sprite, tilemap chunk, or mesh with texture coordinates. What is drawn is lit by the
/// side that it turns to the light, and turns, flips and scales together with its normals.
///
/// ```
/// # use bevy::prelude::*; use bevy_lamplight::prelude::*;
/// # fn system(mut commands: Commands, assets: Res<AssetServer>) {
/// commands.spawn((
///     Sprite::from_image(assets.load("bricks.png")),
///     NormalMap2d::new(assets.load("bricks_normal.png")),
/// ));
/// # }
/// ```
///
/// Everything without one is flat and covers what lies below. [`Relief2d`] on the camera has the elevation of light and
/// highlights. A camera finds the direction of light, for a fifth more time, while anything visible on its layers has a
/// normal map, on the screen or not: a change would compile pipelines.
#[derive(Component, Clone, Debug, Default, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
pub struct NormalMap2d {
    /// The image of normals, `n·½ + ½`, laid out as the picture: the same sheet, parts and tiles, at any resolution.
    /// Linear or sRGB formats without a sign; z is derived where there are only two channels.
    pub image: Handle<Image>,
    /// The direction of its green channel.
    pub y: NormalY,
}

impl NormalMap2d {
    /// A normal map whose green channel is up.
    pub fn new(image: Handle<Image>) -> Self {
        Self { image, ..Self::default() }
    }
}

/// The direction in the picture in which the green channel of a normal map grows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Reflect)]
#[reflect(Default, Debug, Clone, PartialEq, Hash)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
pub enum NormalY {
    /// Up, as in OpenGL and most painting programs.
    #[default]
    Up,
    /// Down, as in Direct3D.
    Down,
}

/// The way in which a camera's light falls on surfaces with a [`NormalMap2d`] ([`lamplight::Relief`],
/// [`lamplight::Settings::elevation`]).
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize), serde(default))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct Relief2d {
    /// The elevation of light above the plane, radians, 0.05 to 1.5; lamps with a height and suns may have their own. Lower:
    /// stronger relief, with darker slopes.
    pub elevation: f32,
    /// The strength of highlights, 0 to 1; 0 is none.
    pub specular: f32,
    /// The roughness of surfaces, 0.05 to 1. Lower: smaller and brighter highlights.
    pub roughness: f32,
}

impl Default for Relief2d {
    fn default() -> Self {
        let Relief { specular, roughness } = Relief::default();
        Self { elevation: Settings::ELEVATION, specular, roughness }
    }
}

impl Relief2d {
    /// Converts to the relief of `lamplight`; the elevation belongs to its settings.
    pub(crate) fn relief(&self) -> Relief {
        let Self { specular, roughness, .. } = *self;
        Relief { specular, roughness }
    }
}
