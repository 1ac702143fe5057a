//! Light masks: which lamp or sun lights which entity.

use bevy::prelude::*;
use lamplight::ALL_LAYERS;

/// The light layers of an entity's sprite, text, tilemap chunk, mesh or [`LightOccluder2d`](crate::LightOccluder2d), a
/// bit each. A lamp or sun lights it if their masks have a bit in common
/// ([`PointLight2d::mask`](crate::PointLight2d::mask)).
///
/// ```
/// # use bevy::prelude::*; use bevy_lamplight::prelude::*;
/// # fn system(mut commands: Commands, assets: Res<AssetServer>) {
/// const PLAYER: u8 = 2;
/// commands.spawn((Sprite::from_image(assets.load("player.png")), LightMask2d(PLAYER)));
/// // Lights the player alone.
/// commands.spawn(PointLight2d { mask: PLAYER, ..default() });
/// # }
/// ```
///
/// Masks decide who receives the direct light of a lamp. All matter throws shadows, and light that was reflected or
/// scattered, the sky, ambient light and glowing matter light everything. The light of a place belongs to whatever is
/// drawn there: where several entities overlap, the topmost that has a mask or is [`Matter2d`](crate::Matter2d) decides.
/// Matter without a mask is in all layers, and so is what has neither, on its own.
///
/// Only cameras that see a lamp or sun with a mask spend time on these.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq, Reflect)]
#[reflect(Component, Default, Debug, Clone, PartialEq)]
#[type_path = "bevy_lamplight"]
#[cfg_attr(feature = "serialize", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serialize", reflect(Serialize, Deserialize))]
pub struct LightMask2d(
    /// The layers, 1 to 255; 0, which is none, counts as all.
    pub u8,
);

impl Default for LightMask2d {
    /// All layers.
    fn default() -> Self {
        Self(ALL_LAYERS)
    }
}

impl LightMask2d {
    /// Its layers, one or more.
    pub(crate) fn layers(self) -> u8 {
        if self.0 == 0 {
            warn_once!("a `LightMask2d` of 0 counts as all layers; valid are 1 to {ALL_LAYERS}");
            return ALL_LAYERS;
        }
        self.0
    }
}
