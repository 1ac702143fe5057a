//! From the main world: lit cameras, and all that takes part in light around them.

use crate::components::Lighting2d;
use crate::lit_camera::LitCamera;
use crate::pieces::{Gather, Surroundings};
use crate::placement::{Misplaced, Placement};
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
    /// Cameras of the main world that cannot be lit.
    pub misplaced: Vec<(Entity, Misplaced)>,
    pub surroundings: Surroundings,
    areas: Vec<Rect>,
}

/// A lit camera.
pub struct ExtractedView {
    /// In the main world.
    pub camera: Entity,
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
    cameras: Extract<Query<(Entity, RenderEntity, LitCamera)>>,
    gather: Extract<Gather>,
) {
    let Extracted { views, misplaced, surroundings, areas } = &mut *extracted;
    views.clear();
    misplaced.clear();
    for (camera, entity, lit) in &cameras {
        let placement = match lit.placement() {
            Ok(Some(placement)) => placement,
            Ok(None) => continue,
            Err(why) => {
                misplaced.push((camera, why));
                continue;
            }
        };
        views.push(ExtractedView {
            camera,
            entity,
            placement,
            lighting: lit.lighting.clone(),
            layers: lit.layers().clone(),
            sky: lit.sky(),
            ambient: lit.ambient(),
            tone_map: lit.tone_map(),
            to_texture: lit.to_texture,
        });
    }
    areas.clear();
    areas.extend(views.iter().map(|view| view.placement.area()));
    gather.gather(areas, surroundings);
}
