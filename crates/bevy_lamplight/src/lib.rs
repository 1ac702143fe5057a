//! 2D global illumination for Bevy: one component on a camera lights the scene.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_lamplight::prelude::*;
//!
//! fn main() {
//!     App::new()
//!         .add_plugins((DefaultPlugins, LamplightPlugin))
//!         .insert_resource(ClearColor(Color::srgb(0.5, 0.5, 0.5)))
//!         .add_systems(Startup, setup)
//!         .run();
//! }
//!
//! fn setup(mut commands: Commands) {
//!     commands.spawn((Camera2d, Lighting2d::default()));
//!     commands.spawn((PointLight2d::default(), Transform::from_xyz(-100.0, 0.0, 0.0)));
//!     let sprite = Sprite::from_color(Color::WHITE, Vec2::splat(60.0));
//!     commands.spawn((sprite, Matter2d::wall()));
//! }
//! ```
//!
//! [`Lighting2d`] lights a camera. [`Matter2d`] makes anything that is drawn emit, block, filter or
//! reflect light. [`PointLight2d`] and [`SpotLight2d`] are lamps, which [`LightCookie2d`] gives a pattern,
//! [`SunLight2d`] is a sun, and [`LightOccluder2d`] is an invisible shape that blocks light. [`LightMask2d`] chooses which
//! lamps light an entity. Entities with [`Unlit2d`] are drawn unlit, over the lit picture. [`NormalMap2d`] lights flat
//! pictures as if their surface were tilted.
//! [`LightQuery`] returns the light at a place, for game rules, and [`SightQuery`] whether a [`Viewer2d`] sees it.
//!
//! `docs/light.md` of the project defines light. Where it measures in cells, this crate measures in
//! world units: opacity and tint are per world unit.

mod camera_log;
mod components;
mod cookies;
#[cfg(feature = "gizmos")]
mod gizmos;
mod lit_camera;
mod placement;
mod quads;
pub mod query;
mod raster;
pub mod render;
mod surroundings;

pub use components::*;
#[cfg(feature = "gizmos")]
pub use gizmos::{LamplightGizmosPlugin, LightGizmos};
pub use query::{LightQuery, LightQueryPlugin, LightQuerySettings, SightQuery};

use bevy::app::{App, Plugin};

/// The names that most programs use.
pub mod prelude {
    #[cfg(feature = "gizmos")]
    pub use crate::LamplightGizmosPlugin;
    pub use crate::LamplightPlugin;
    pub use crate::components::*;
    pub use crate::query::{LightQuery, LightQueryPlugin, LightQuerySettings, SightQuery};
    pub use crate::render::LightBackend;
}

/// Lights cameras that have a [`Lighting2d`].
pub struct LamplightPlugin;

impl Plugin for LamplightPlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<Lighting2d>()
            .register_type::<LightTexture2d>()
            .register_type::<Matter2d>()
            .register_type::<LightOccluder2d>()
            .register_type::<Unlit2d>()
            .register_type::<NormalMap2d>()
            .register_type::<LightCookie2d>()
            .register_type::<Relief2d>()
            .register_type::<PointLight2d>()
            .register_type::<SpotLight2d>()
            .register_type::<SunLight2d>()
            .register_type::<AmbientLight2d>()
            .register_type::<Sky2d>()
            .register_type::<Panorama2d>()
            .register_type::<LightMask2d>()
            .register_type::<Viewer2d>()
            .register_type::<LightQuerySettings>();
        if !app.is_plugin_added::<LightQueryPlugin>() {
            app.add_plugins(LightQueryPlugin);
        }
        if !app.is_plugin_added::<render::LightRenderPlugin>() {
            app.add_plugins(render::LightRenderPlugin);
        }
    }

    /// Adding the plugin twice has no effect.
    fn is_unique(&self) -> bool {
        false
    }
}

/// The README, whose examples are compiled with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
