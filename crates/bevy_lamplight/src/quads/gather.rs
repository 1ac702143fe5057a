//! Collects everything that takes part in light, in the main world.

use super::material::QuadMaterial;
use super::meshes::MeshMatter;
use super::place::{EntityPlace, EntityPlaceItem, SceneAssets, VisibilityPropagates};
use super::scene::ExtractedScene;
use super::source::{QuadSource, QuadWriter};
use super::sprites::SpriteMatter;
use super::texts::TextMatter;
use super::tiles::TileMatter;
use crate::components::{
    LightCookie2d, LightOccluder2d, Matter2d, PointLight2d, SpotLight2d, SunLight2d, WorldLamp,
};
use crate::cookies::{CookieImages, LampCookie};
use bevy::ecs::system::SystemParam;
use bevy::math::Rect;
use bevy::prelude::{GlobalTransform, Query, Res};

/// All entities that take part in light.
#[derive(SystemParam)]
pub struct Gather<'w, 's> {
    sprites: Query<'w, 's, (&'static Matter2d, EntityPlace, SpriteMatter)>,
    texts: Query<'w, 's, (&'static Matter2d, EntityPlace, TextMatter)>,
    meshes: Query<'w, 's, (&'static Matter2d, EntityPlace, MeshMatter)>,
    tiles: Query<'w, 's, (&'static Matter2d, EntityPlace, TileMatter)>,
    occluders: Query<'w, 's, (Option<&'static Matter2d>, EntityPlace, &'static LightOccluder2d)>,
    points: Query<'w, 's, (&'static PointLight2d, EntityPlace, Option<&'static LightCookie2d>)>,
    spots: Query<'w, 's, (&'static SpotLight2d, EntityPlace, Option<&'static LightCookie2d>)>,
    suns: Query<'w, 's, (&'static SunLight2d, EntityPlace)>,
    cookies: Option<Res<'w, CookieImages>>,
    assets: SceneAssets<'w, 's>,
    propagates: Option<Res<'w, VisibilityPropagates>>,
}

impl Gather<'_, '_> {
    /// Collects matter that overlaps any of these areas of the world, all lamps, and all suns.
    pub fn gather(&self, areas: &[Rect], scene: &mut ExtractedScene) {
        scene.clear();
        if areas.is_empty() {
            return;
        }
        self.add(areas, scene, self.sprites.iter());
        self.add(areas, scene, self.texts.iter());
        self.add(areas, scene, self.meshes.iter());
        self.add(areas, scene, self.tiles.iter());
        let wall = Matter2d::wall();
        let occluders = self.occluders.iter();
        let of_wall = occluders.map(|(own, place, shape)| (own.unwrap_or(&wall), place, shape));
        self.add(areas, scene, of_wall);
        let points = self.points.iter().filter(|(_, place, _)| self.is_visible(place)).filter_map(
            |(lamp, place, cookie)| {
                let lamp = WorldLamp::point(lamp, place.transform)?;
                Some((self.with_cookie(lamp, cookie, place.transform)?, place.layers()))
            },
        );
        let spots = self.spots.iter().filter(|(_, place, _)| self.is_visible(place)).filter_map(
            |(lamp, place, cookie)| {
                let lamp = WorldLamp::spot(lamp, place.transform)?;
                Some((self.with_cookie(lamp, cookie, place.transform)?, place.layers()))
            },
        );
        scene.lamps.extend(points.chain(spots));
        let suns = self.suns.iter().filter(|(_, place)| self.is_visible(place));
        let suns =
            suns.filter_map(|(sun, place)| Some((sun.sun(place.transform)?, place.layers())));
        scene.suns.extend(suns);
        scene.sort();
    }

    /// Returns a lamp with its cookie; `None` if it is dark.
    fn with_cookie(
        &self,
        lamp: WorldLamp,
        cookie: Option<&LightCookie2d>,
        transform: &GlobalTransform,
    ) -> Option<WorldLamp> {
        let (Some(cookie), Some(cookies)) = (cookie, &self.cookies) else { return Some(lamp) };
        match cookies.cookie(cookie, transform, self.assets.images.as_deref()) {
            LampCookie::Lit(cookie) => Some(WorldLamp { cookie, ..lamp }),
            LampCookie::Dark => None,
        }
    }

    fn is_visible(&self, place: &EntityPlaceItem) -> bool {
        place.is_visible(self.propagates.is_some())
    }

    /// Adds the quads of all visible entities.
    fn add<'m, 'w, 's, S: QuadSource>(
        &self,
        areas: &[Rect],
        scene: &mut ExtractedScene,
        entities: impl Iterator<Item = (&'m Matter2d, EntityPlaceItem<'w, 's>, S)>,
    ) {
        for (matter, place, source) in entities.filter(|(_, place, _)| self.is_visible(place)) {
            let material = scene.add_material(QuadMaterial::new(matter));
            let mut writer = QuadWriter::new(scene, areas, material);
            source.push_quads(&place, &self.assets, &mut writer);
        }
    }
}
