//! Extraction from the main world: lit cameras, and the scene around them.

use crate::components::{Lighting2d, Relief2d};
use crate::lit_camera::LitCamera;
use crate::placement::{Placement, PlacementError};
use crate::quads::{ExtractedScene, Gather, GatherMasks, GatherSurfaces};
use crate::surroundings::CameraSurroundings;
use bevy::camera::visibility::RenderLayers;
use bevy::math::Rect;
use bevy::prelude::{Entity, Query, Res, ResMut, Resource};
use bevy::render::Extract;
use bevy::render::sync_world::RenderEntity;
use lamplight::{Display, Inflow, Sky, ToneMap};

/// Everything that a frame is lit from.
#[derive(Resource, Default)]
pub struct ExtractedLighting {
    pub views: Vec<LitCameraView>,
    /// All lit cameras in the render world, also those that see nothing now: inactive ones, and those of minimised windows.
    pub cameras: Vec<Entity>,
    /// Cameras of the main world that cannot be lit, and why.
    pub failed: Vec<(Entity, PlacementError)>,
    pub scene: ExtractedScene,
    /// The surfaces that cameras with normals see.
    pub surfaces: ExtractedScene,
    /// Everything with light layers, if any lamp chooses among them.
    pub masks: ExtractedScene,
    areas: Vec<Rect>,
}

/// A lit camera.
pub struct LitCameraView {
    /// Entity in the main world.
    pub camera: Entity,
    /// Entity in the render world.
    pub entity: Entity,
    pub placement: Placement,
    pub lighting: Lighting2d,
    pub layers: RenderLayers,
    pub sky: Sky,
    /// The light of its surroundings, in place of the sky.
    pub inflow: Option<Inflow>,
    pub ambient: [f32; 3],
    pub relief: Relief2d,
    pub tone_map: ToneMap,
    /// True if anything visible on its layers has a normal map.
    pub has_normals: bool,
    /// True if the camera has a [`LightTexture2d`](crate::LightTexture2d).
    pub has_light_texture: bool,
}

impl LitCameraView {
    /// The mapping of its light to its picture.
    pub fn display(&self) -> Display {
        Display {
            tonemap: self.tone_map,
            exposure: self.lighting.exposure,
            ambient: self.ambient,
            relief: self.relief.relief(),
        }
    }
}

/// Extracts lit cameras and the scene.
pub fn extract(
    mut extracted: ResMut<ExtractedLighting>,
    cameras: Extract<Query<(Entity, RenderEntity, LitCamera)>>,
    surroundings: Extract<Res<CameraSurroundings>>,
    gather: Extract<Gather>,
    gather_surfaces: Extract<GatherSurfaces>,
    gather_masks: Extract<GatherMasks>,
) {
    let ExtractedLighting { views, cameras: kept, failed, scene, surfaces, masks, areas } =
        &mut *extracted;
    views.clear();
    kept.clear();
    failed.clear();
    for (camera, entity, lit) in &cameras {
        kept.push(entity);
        let placement = match lit.placement() {
            Ok(Some(placement)) => placement,
            Ok(None) => continue,
            Err(error) => {
                failed.push((camera, error));
                continue;
            }
        };
        views.push(LitCameraView {
            camera,
            entity,
            placement,
            lighting: lit.lighting.clone(),
            layers: lit.layers().clone(),
            sky: lit.sky(),
            inflow: surroundings.inflow(camera, &placement).cloned(),
            ambient: lit.ambient(),
            relief: lit.relief(),
            tone_map: lit.tone_map(),
            has_normals: gather_surfaces.has_normals(lit.layers()),
            has_light_texture: lit.has_light_texture,
        });
    }
    areas.clear();
    areas.extend(views.iter().map(|view| view.placement.area()));
    gather.gather(areas, scene);
    gather_masks.gather(areas, scene, masks);
    areas.clear();
    areas.extend(views.iter().filter(|v| v.has_normals).map(|view| view.placement.area()));
    gather_surfaces.gather(areas, surfaces);
}
