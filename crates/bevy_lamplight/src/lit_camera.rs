//! Cameras that are lit, and all that says how.

use crate::components::{AmbientLight2d, LightTexture2d, Lighting2d, Sky2d};
use crate::placement::{Misplaced, Placement};
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{Camera, Projection};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::ecs::query::QueryData;
use bevy::prelude::{GlobalTransform, Has};
use lamplight::{Sky, ToneMap};

/// A lit camera.
#[derive(QueryData)]
pub struct LitCamera {
    camera: &'static Camera,
    projection: &'static Projection,
    transform: &'static GlobalTransform,
    pub lighting: &'static Lighting2d,
    layers: Option<&'static RenderLayers>,
    sky: Option<&'static Sky2d>,
    ambient: Option<&'static AmbientLight2d>,
    tone_map: Option<&'static Tonemapping>,
    pub to_texture: Has<LightTexture2d>,
}

impl LitCameraItem<'_, '_> {
    /// Where its light lies; none where it sees nothing, or is off.
    pub fn placement(&self) -> Result<Option<Placement>, Misplaced> {
        let Self { camera, projection, transform, lighting, .. } = self;
        match camera.is_active {
            true => Placement::of(camera, projection, transform, lighting),
            false => Ok(None),
        }
    }

    /// What it sees.
    pub fn layers(&self) -> &RenderLayers {
        self.layers.unwrap_or_default()
    }

    /// Light from outside.
    pub fn sky(&self) -> Sky {
        self.sky.map_or(Sky::BLACK, |sky| sky.sky())
    }

    /// Light from everywhere.
    pub fn ambient(&self) -> [f32; 3] {
        self.ambient.map_or([0.0; 3], |ambient| ambient.radiance())
    }

    /// By what its light is brought back to what a screen shows.
    pub fn tone_map(&self) -> ToneMap {
        let has_own = self.tone_map.is_some_and(|own| own.is_enabled());
        self.lighting.tone_map.for_camera(has_own)
    }
}
