//! Collects the surfaces that cameras see: everything drawn, with its normal map or flat.

use super::material::QuadMaterial;
use super::meshes::MeshMatter;
use super::place::{EntityPlace, EntityPlaceItem, SceneAssets, VisibilityPropagates};
use super::scene::ExtractedScene;
use super::source::{QuadSource, QuadWriter};
use super::sprites::SpriteMatter;
use super::texts::TextMatter;
use super::tiles::TileMatter;
use crate::components::{NormalMap2d, Unlit2d};
use bevy::asset::AssetId;
use bevy::camera::visibility::RenderLayers;
use bevy::ecs::system::SystemParam;
use bevy::image::Image;
use bevy::log::warn_once;
use bevy::math::Rect;
use bevy::prelude::{Or, Query, Res, With, Without};
use bevy::sprite_render::{ColorMaterial, MeshMaterial2d};

/// A normal map, if the entity has one.
type Map = Option<&'static NormalMap2d>;
/// Meshes whose transparency is known, or that have normals in spite of it.
type IsSurface = (Or<(With<MeshMaterial2d<ColorMaterial>>, With<NormalMap2d>)>, Without<Unlit2d>);

/// All entities that are drawn and lit.
#[derive(SystemParam)]
pub struct GatherSurfaces<'w, 's> {
    mapped: Query<'w, 's, EntityPlace, (With<NormalMap2d>, Without<Unlit2d>)>,
    sprites: Query<'w, 's, (Map, EntityPlace, SpriteMatter), Without<Unlit2d>>,
    texts: Query<'w, 's, (EntityPlace, TextMatter), Without<Unlit2d>>,
    meshes: Query<'w, 's, (Map, EntityPlace, MeshMatter), IsSurface>,
    tiles: Query<'w, 's, (Map, EntityPlace, TileMatter), Without<Unlit2d>>,
    assets: SceneAssets<'w, 's>,
    propagates: Option<Res<'w, VisibilityPropagates>>,
}

impl GatherSurfaces<'_, '_> {
    /// Returns whether anything visible on these layers has a normal map.
    pub fn has_normals(&self, layers: &RenderLayers) -> bool {
        let mut mapped = self.mapped.iter();
        mapped.any(|place| self.is_visible(&place) && place.layers().intersects(layers))
    }

    /// Collects the surfaces that overlap any of these areas of the world.
    pub fn gather(&self, areas: &[Rect], scene: &mut ExtractedScene) {
        scene.clear();
        if areas.is_empty() {
            return;
        }
        let flat = scene.add_material(QuadMaterial::surface(0));
        self.add(areas, scene, flat, self.sprites.iter());
        let texts = self.texts.iter().map(|(place, text)| (None, place, text));
        self.add(areas, scene, flat, texts);
        self.add(areas, scene, flat, self.meshes.iter());
        self.add(areas, scene, flat, self.tiles.iter());
        scene.sort();
    }

    fn is_visible(&self, place: &EntityPlaceItem) -> bool {
        place.is_visible(self.propagates.is_some())
    }

    /// Adds the quads of all visible entities.
    fn add<'m, 'w, 's, S: QuadSource>(
        &self,
        areas: &[Rect],
        scene: &mut ExtractedScene,
        flat: u32,
        entities: impl Iterator<Item = (Option<&'m NormalMap2d>, EntityPlaceItem<'w, 's>, S)>,
    ) {
        for (map, place, source) in entities.filter(|(_, place, _)| self.is_visible(place)) {
            let normals = map.and_then(|map| self.normals(map));
            let material = normals
                .map_or(flat, |(_, encoding)| scene.add_material(QuadMaterial::surface(encoding)));
            let mut writer = QuadWriter::new(scene, areas, material);
            writer.normals = normals.map(|(image, _)| image);
            source.push_quads(&place, &self.assets, &mut writer);
        }
    }

    /// The image of a normal map and its encoding; `None` while it is not loaded, or if it holds no normals.
    fn normals(&self, map: &NormalMap2d) -> Option<(AssetId<Image>, u32)> {
        let image = self.assets.images.as_ref()?.get(&map.image)?;
        let format = image.texture_descriptor.format;
        let encoding = QuadMaterial::normal_encoding(format, map.y);
        if encoding.is_none() {
            warn_once!(
                "a normal map of the format {format:?} is ignored; it needs two or more channels without a sign"
            );
        }
        Some((map.image.id(), encoding?))
    }
}
