//! The query of lit cameras and the components that configure their light.

use crate::components::{AmbientLight2d, LightTexture2d, Lighting2d, Panorama2d, Relief2d, Sky2d};
use crate::placement::{Placement, PlacementError};
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
    panorama: Option<&'static Panorama2d>,
    ambient: Option<&'static AmbientLight2d>,
    relief: Option<&'static Relief2d>,
    tone_map: Option<&'static Tonemapping>,
    pub has_light_texture: Has<LightTexture2d>,
}

impl LitCameraItem<'_, '_> {
    /// Its place among the cameras.
    pub fn order(&self) -> isize {
        self.camera.order
    }

    /// The placement of its grid; `None` if it sees nothing or is inactive.
    pub fn placement(&self) -> Result<Option<Placement>, PlacementError> {
        let Self { camera, projection, transform, lighting, .. } = self;
        if !camera.is_active {
            return Ok(None);
        }
        Placement::new(camera, projection, transform, lighting)
    }

    /// The layers that it sees.
    pub fn layers(&self) -> &RenderLayers {
        self.layers.unwrap_or_default()
    }

    /// The sky around its grid.
    pub fn sky(&self) -> Sky {
        let gradient = || self.sky.map(Sky2d::sky);
        self.panorama.map(Panorama2d::sky).or_else(gradient).unwrap_or_default()
    }

    /// The radiance of its ambient light.
    pub fn ambient(&self) -> [f32; 3] {
        self.ambient.map_or([0.0; 3], |ambient| ambient.radiance())
    }

    /// The way in which its light falls on tilted surfaces.
    pub fn relief(&self) -> Relief2d {
        self.relief.copied().unwrap_or_default()
    }

    /// The tone map of its lit picture.
    pub fn tone_map(&self) -> ToneMap {
        // Bevy gives 2D cameras `Linear`, which maps nothing.
        let has_own = self
            .tone_map
            .is_some_and(|own| !matches!(own, Tonemapping::None | Tonemapping::Linear));
        self.lighting.tone_map.for_camera(has_own)
    }
}
