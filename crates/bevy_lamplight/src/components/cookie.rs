//! Cookies: pictures that lamps project on the plane.

use bevy::prelude::*;

/// A picture on the plane around a [`PointLight2d`](crate::PointLight2d) or [`SpotLight2d`](crate::SpotLight2d), which
/// multiplies the lamp's light: leaves above a lantern, the cross of a window, the blotches of a torch.
///
/// ```
/// # use bevy::prelude::*; use bevy_lamplight::prelude::*;
/// # fn system(mut commands: Commands, assets: Res<AssetServer>) {
/// commands.spawn((
///     PointLight2d { range: 200.0, ..default() },
///     LightCookie2d { image: assets.load("leaves.png"), size: 160.0 },
/// ));
/// # }
/// ```
///
/// The middle of the picture is at the lamp. It turns, flips and grows with the entity; of an entity that is stretched, the
/// width counts. Outside the picture the lamp gives no light, and transparent pixels are black. Walls and fog around
/// send its light on, beyond the picture too. A lamp with a cookie ends at its range and costs as much time as a spot.
///
/// The image has up to 2048×2048 pixels, in a format that is not compressed, and is kept in the main world
/// ([`RenderAssetUsages`](bevy::asset::RenderAssetUsages)), as images are by default; without such an image the cookie
/// has no effect. Until its image is loaded, the lamp is dark.
#[derive(Component, Clone, Debug, PartialEq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
pub struct LightCookie2d {
    /// The picture.
    pub image: Handle<Image>,
    /// Its width, world units. Its height follows from its proportions.
    pub size: f32,
}

impl Default for LightCookie2d {
    /// A picture as wide as the default range of a lamp reaches.
    fn default() -> Self {
        Self { image: Handle::default(), size: 256.0 }
    }
}
