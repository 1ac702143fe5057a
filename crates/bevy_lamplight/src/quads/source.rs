//! The interface between components that show something and the quads made of them.

use super::place::{EntityPlaceItem, SceneAssets};
use super::quad::Quad;
use super::scene::{ExtractedScene, GroupSettings, overlaps};
use bevy::asset::AssetId;
use bevy::image::Image;
use bevy::math::{Rect, Vec2};

/// A component, or several, that quads are made of.
pub trait QuadSource {
    /// Adds the quads of an entity. Adds none while its assets are not loaded.
    fn push_quads(&self, place: &EntityPlaceItem, assets: &SceneAssets, to: &mut QuadWriter);
}

/// Adds the quads of one entity to a scene.
pub struct QuadWriter<'a> {
    scene: &'a mut ExtractedScene,
    /// Parts of the world that the scene has to cover.
    pub areas: &'a [Rect],
    /// The image of the entity's normals, if it has any.
    pub normals: Option<AssetId<Image>>,
    material: u32,
    first: usize,
}

impl<'a> QuadWriter<'a> {
    /// A writer of quads that have the material of this index.
    pub fn new(scene: &'a mut ExtractedScene, areas: &'a [Rect], material: u32) -> Self {
        let first = scene.quads.len();
        Self { scene, areas, normals: None, material, first }
    }

    /// Returns whether any of the areas may show something at these points of the world, and between them. Sources ask
    /// where that costs less than their quads do.
    pub fn shows(&self, points: impl Iterator<Item = Vec2>) -> bool {
        let bounds = points.fold(Rect::EMPTY, |all, point| all.union_point(point));
        self.areas.iter().any(|&area| overlaps(bounds, area))
    }

    /// Adds a quad.
    pub fn push(&mut self, quad: Quad) {
        self.scene.quads.push(Quad { material: self.material, ..quad });
    }

    /// Makes a group of the quads added since the last one.
    pub fn finish_group(&mut self, place: &EntityPlaceItem, image: AssetId<Image>, is_drawn: bool) {
        let (normals, layers, z) = (self.normals, place.layers(), place.z());
        let settings = GroupSettings { image, normals, layers, is_drawn, z };
        self.scene.finish_group(self.first, settings, self.areas);
        self.first = self.scene.quads.len();
    }
}
