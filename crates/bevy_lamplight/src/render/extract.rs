//! From the main world: lit cameras, and all that takes part in light around them.

use crate::components::{AmbientLight2d, LightTexture2d, Lighting2d, Sky2d};
use crate::pieces::{Gather, Surroundings};
use crate::placement::Placement;
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{Camera, Projection};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::math::Rect;
use bevy::prelude::{Entity, GlobalTransform, Has, Query, ResMut, Resource};
use bevy::render::Extract;
use bevy::render::sync_world::RenderEntity;
use lamplight::{Sky, ToneMap};

/// What a frame is lit by.
#[derive(Resource, Default)]
pub struct Extracted {
    pub views: Vec<ExtractedView>,
    pub surroundings: Surroundings,
    areas: Vec<Rect>,
}

/// A lit camera.
pub struct ExtractedView {
    /// In the render world.
    pub entity: Entity,
    pub placement: Placement,
    pub lighting: Lighting2d,
    pub layers: RenderLayers,
    pub sky: Sky,
    pub ambient: [f32; 3],
    pub tone_map: ToneMap,
    pub to_texture: bool,
}

type LitCamera = (
    RenderEntity,
    &'static Camera,
    &'static Projection,
    &'static GlobalTransform,
    &'static Lighting2d,
    Option<&'static RenderLayers>,
    Option<&'static Sky2d>,
    Option<&'static AmbientLight2d>,
    Option<&'static Tonemapping>,
    Has<LightTexture2d>,
);

pub fn extract(
    mut extracted: ResMut<Extracted>,
    cameras: Extract<Query<LitCamera>>,
    gather: Extract<Gather>,
) {
    let Extracted { views, surroundings, areas } = &mut *extracted;
    let lit = cameras.iter().filter(|(_, camera, ..)| camera.is_active).filter_map(
        |(
            entity,
            camera,
            projection,
            transform,
            lighting,
            layers,
            sky,
            ambient,
            own,
            to_texture,
        )| {
            Some(ExtractedView {
                entity,
                placement: Placement::of(camera, projection, transform, lighting)?,
                lighting: lighting.clone(),
                layers: layers.unwrap_or_default().clone(),
                sky: sky.map_or(Sky::BLACK, |sky| sky.sky()),
                ambient: ambient.map_or([0.0; 3], |ambient| ambient.radiance()),
                tone_map: lighting.tone_map.for_camera(own.is_some_and(|own| own.is_enabled())),
                to_texture,
            })
        },
    );
    views.clear();
    views.extend(lit);
    areas.clear();
    areas.extend(views.iter().map(|view| view.placement.area()));
    gather.gather(areas, surroundings);
}
