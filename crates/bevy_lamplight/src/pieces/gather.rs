//! Finding all that takes part in light, in the main world.

use super::meshes::MeshMatter;
use super::sprites::SpriteMatter;
use super::texts::TextMatter;
use super::tiles::TileMatter;
use super::{Substance, Surroundings, occluders};
use crate::components::{LightOccluder2d, Matter2d, PointLight2d, SpotLight2d, WorldLamp};
use bevy::asset::Assets;
use bevy::camera::visibility::{InheritedVisibility, RenderLayers};
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::image::{Image, TextureAtlasLayout};
use bevy::math::Rect;
use bevy::mesh::Mesh;
use bevy::prelude::{GlobalTransform, Query, Res, Resource, Visibility};
use bevy::sprite_render::ColorMaterial;
use bevy::text::TextColor;

/// Pictures that are made of other entities' assets; none in an app without them.
#[derive(SystemParam)]
pub struct Pictures<'w, 's> {
    pub images: Option<Res<'w, Assets<Image>>>,
    pub atlases: Option<Res<'w, Assets<TextureAtlasLayout>>>,
    pub meshes: Option<Res<'w, Assets<Mesh>>>,
    pub materials: Option<Res<'w, Assets<ColorMaterial>>>,
    pub text_colors: Query<'w, 's, &'static TextColor>,
}

/// There where Bevy hands visibility down from parents to children. Without it, what an entity says
/// itself counts.
#[derive(Resource, Default)]
pub struct VisibilityPropagates;

/// Where an entity is, and who sees it.
#[derive(QueryData)]
pub struct Place {
    pub transform: &'static GlobalTransform,
    own: Option<&'static Visibility>,
    inherited: Option<&'static InheritedVisibility>,
    layers: Option<&'static RenderLayers>,
}

impl PlaceItem<'_, '_> {
    /// Whether it is shown at all; not whether it lies on a screen.
    fn is_shown(&self, propagates: bool) -> bool {
        match propagates {
            true => self.inherited.is_none_or(|visibility| visibility.get()),
            false => self.own.is_none_or(|visibility| *visibility != Visibility::Hidden),
        }
    }

    /// Its layers.
    pub fn layers(&self) -> RenderLayers {
        self.layers.unwrap_or_default().clone()
    }
}

/// All that takes part in light.
#[derive(SystemParam)]
pub struct Gather<'w, 's> {
    sprites: Query<'w, 's, (&'static Matter2d, Place, SpriteMatter)>,
    texts: Query<'w, 's, (&'static Matter2d, Place, TextMatter)>,
    meshes: Query<'w, 's, (&'static Matter2d, Place, MeshMatter)>,
    tiles: Query<'w, 's, (&'static Matter2d, Place, TileMatter)>,
    occluders: Query<'w, 's, (Option<&'static Matter2d>, Place, &'static LightOccluder2d)>,
    points: Query<'w, 's, (&'static PointLight2d, Place)>,
    spots: Query<'w, 's, (&'static SpotLight2d, Place)>,
    pictures: Pictures<'w, 's>,
    propagates: Option<Res<'w, VisibilityPropagates>>,
}

impl Gather<'_, '_> {
    /// Finds what lies in any of these parts of the world; lamps wherever they are.
    pub fn gather(&self, areas: &[Rect], to: &mut Surroundings) {
        to.clear();
        if areas.is_empty() {
            return;
        }
        let pictures = &self.pictures;
        let propagates = self.propagates.is_some();
        for (matter, place, sprite) in
            self.sprites.iter().filter(|(_, place, _)| place.is_shown(propagates))
        {
            let substance = to.add_substance(Substance::of(matter));
            sprite.cut_up(&place, substance, pictures, areas, to);
        }
        for (matter, place, text) in
            self.texts.iter().filter(|(_, place, _)| place.is_shown(propagates))
        {
            let substance = to.add_substance(Substance::of(matter));
            text.cut_up(&place, substance, pictures, areas, to);
        }
        for (matter, place, mesh) in
            self.meshes.iter().filter(|(_, place, _)| place.is_shown(propagates))
        {
            let substance = to.add_substance(Substance::of(matter));
            mesh.cut_up(&place, substance, pictures, areas, to);
        }
        for (matter, place, tiles) in
            self.tiles.iter().filter(|(_, place, _)| place.is_shown(propagates))
        {
            let substance = to.add_substance(Substance::of(matter));
            tiles.cut_up(&place, substance, areas, to);
        }
        let wall = Matter2d::wall();
        for (matter, place, shape) in
            self.occluders.iter().filter(|(_, place, _)| place.is_shown(propagates))
        {
            let substance = to.add_substance(Substance::of(matter.unwrap_or(&wall)));
            occluders::cut_up(shape, &place, substance, areas, to);
        }
        let points = self.points.iter().filter(|(_, place)| place.is_shown(propagates)).filter_map(
            |(lamp, place)| Some((WorldLamp::point(lamp, place.transform)?, place.layers())),
        );
        let spots = self.spots.iter().filter(|(_, place)| place.is_shown(propagates)).filter_map(
            |(lamp, place)| Some((WorldLamp::spot(lamp, place.transform)?, place.layers())),
        );
        to.lamps.extend(points.chain(spots));
        to.sort();
    }
}
