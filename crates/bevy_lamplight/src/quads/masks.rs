//! Collects the light layers of what lamps with a mask may light: everything that has a light mask or is matter.

use super::material::QuadMaterial;
use super::meshes::MeshMatter;
use super::place::{EntityPlace, EntityPlaceItem, SceneAssets, VisibilityPropagates};
use super::scene::ExtractedScene;
use super::source::{QuadSource, QuadWriter};
use super::sprites::SpriteMatter;
use super::texts::TextMatter;
use super::tiles::TileMatter;
use crate::components::{LightMask2d, LightOccluder2d, Matter2d};
use bevy::ecs::system::SystemParam;
use bevy::math::Rect;
use bevy::prelude::{Or, Query, Res, With};
use lamplight::ALL_LAYERS;

/// A light mask, if the entity has one.
type Mask = Option<&'static LightMask2d>;
/// A filter for all that hides the layers of things below it.
type HasLayers = Or<(With<LightMask2d>, With<Matter2d>)>;

/// All entities with light layers.
#[derive(SystemParam)]
pub struct GatherMasks<'w, 's> {
    masked: Query<'w, 's, (&'static LightMask2d, EntityPlace)>,
    sprites: Query<'w, 's, (Mask, EntityPlace, SpriteMatter), HasLayers>,
    texts: Query<'w, 's, (Mask, EntityPlace, TextMatter), HasLayers>,
    meshes: Query<'w, 's, (Mask, EntityPlace, MeshMatter), HasLayers>,
    tiles: Query<'w, 's, (Mask, EntityPlace, TileMatter), HasLayers>,
    occluders: Query<'w, 's, (Mask, EntityPlace, &'static LightOccluder2d)>,
    assets: SceneAssets<'w, 's>,
    propagates: Option<Res<'w, VisibilityPropagates>>,
}

impl GatherMasks<'_, '_> {
    /// Collects what has light layers and overlaps any of these areas of the world. Nothing, if all of it is lit by all
    /// lamps and suns of the `lit` scene.
    pub fn gather(&self, areas: &[Rect], lit: &ExtractedScene, scene: &mut ExtractedScene) {
        scene.clear();
        if areas.is_empty() || !lit.has_masked_lights() || !self.has_masks() {
            return;
        }
        self.add(areas, scene, self.sprites.iter());
        self.add(areas, scene, self.texts.iter());
        self.add(areas, scene, self.meshes.iter());
        self.add(areas, scene, self.tiles.iter());
        self.add(areas, scene, self.occluders.iter());
        scene.sort();
    }

    /// Returns whether anything visible is not in all layers.
    fn has_masks(&self) -> bool {
        let mut masked = self.masked.iter();
        masked.any(|(mask, place)| mask.layers() != ALL_LAYERS && self.is_visible(&place))
    }

    fn is_visible(&self, place: &EntityPlaceItem) -> bool {
        place.is_visible(self.propagates.is_some())
    }

    /// Adds the quads of all visible entities.
    fn add<'m, 'w, 's, S: QuadSource>(
        &self,
        areas: &[Rect],
        scene: &mut ExtractedScene,
        entities: impl Iterator<Item = (Option<&'m LightMask2d>, EntityPlaceItem<'w, 's>, S)>,
    ) {
        for (mask, place, source) in entities.filter(|(_, place, _)| self.is_visible(place)) {
            let layers = mask.map_or(ALL_LAYERS, |mask| mask.layers());
            let material = scene.add_material(QuadMaterial::layers(layers));
            let mut writer = QuadWriter::new(scene, areas, material);
            source.push_quads(&place, &self.assets, &mut writer);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::{PointLight2d, SunLight2d};
    use crate::quads::Gather;
    use bevy::ecs::system::RunSystemOnce;
    use bevy::math::Vec2;
    use bevy::prelude::{Visibility, World};

    /// The number of groups that are drawn for their layers.
    fn drawn(spawn: impl FnOnce(&mut World)) -> usize {
        let mut world = World::new();
        world.spawn(LightOccluder2d::default());
        spawn(&mut world);
        let count = |gather: Gather, masks: GatherMasks| {
            let areas = [Rect::from_center_half_size(Vec2::ZERO, Vec2::splat(100.0))];
            let [mut scene, mut layers] = [(); 2].map(|()| ExtractedScene::default());
            gather.gather(&areas, &mut scene);
            masks.gather(&areas, &scene, &mut layers);
            layers.groups.len()
        };
        world.run_system_once(count).expect("the system needs nothing")
    }

    #[test]
    fn layers_are_drawn_only_where_lights_choose_among_them() {
        let masked = || (LightOccluder2d::default(), LightMask2d(2));
        let lamp = |mask| PointLight2d { mask, ..PointLight2d::default() };
        let sun = |mask| SunLight2d { mask, ..SunLight2d::default() };
        let both = |mask| {
            drawn(|world| {
                world.spawn((masked(), lamp(mask)));
            })
        };
        let unmasked = |world: &mut World| {
            world.spawn(lamp(2));
        };
        assert_eq!([both(ALL_LAYERS), both(0), drawn(unmasked)], [0; 3]);
        let hidden = |world: &mut World| {
            world.spawn((masked(), Visibility::Hidden));
            world.spawn(lamp(2));
        };
        assert_eq!(drawn(hidden), 0);
        let lit_by_the_sun = |world: &mut World| {
            world.spawn((masked(), sun(4)));
        };
        // The other occluder hides the layers of what lies below it.
        assert_eq!([both(2), drawn(lit_by_the_sun)], [2; 2]);
    }
}
