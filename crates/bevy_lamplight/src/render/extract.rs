//! From the main world: lit cameras, and all that takes part in light around them.

use crate::components::Lighting2d;
use crate::lit_camera::LitCamera;
use crate::pieces::{Gather, Surroundings};
use crate::placement::Placement;
use bevy::camera::visibility::RenderLayers;
use bevy::math::Rect;
use bevy::prelude::{Entity, Query, ResMut, Resource};
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

pub fn extract(
    mut extracted: ResMut<Extracted>,
    cameras: Extract<Query<(RenderEntity, LitCamera)>>,
    gather: Extract<Gather>,
) {
    let Extracted { views, surroundings, areas } = &mut *extracted;
    let lit = cameras.iter().filter_map(|(entity, camera)| {
        Some(ExtractedView {
            entity,
            placement: camera.placement()?,
            lighting: camera.lighting.clone(),
            layers: camera.layers().clone(),
            sky: camera.sky(),
            ambient: camera.ambient(),
            tone_map: camera.tone_map(),
            to_texture: camera.to_texture,
        })
    });
    views.clear();
    views.extend(lit);
    areas.clear();
    areas.extend(views.iter().map(|view| view.placement.area()));
    gather.gather(areas, surroundings);
}
