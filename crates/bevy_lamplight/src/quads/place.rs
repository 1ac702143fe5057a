//! The parts that all sources of quads share: the assets they read, and the place of an entity.

use bevy::asset::Assets;
use bevy::camera::visibility::{InheritedVisibility, RenderLayers};
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::image::{Image, TextureAtlasLayout};
use bevy::mesh::Mesh;
use bevy::prelude::{GlobalTransform, Query, Res, Resource, Visibility};
use bevy::sprite_render::ColorMaterial;
use bevy::text::TextColor;

/// Assets and sections that quads are made of. An app without rendering has none of the assets.
#[derive(SystemParam)]
pub struct SceneAssets<'w, 's> {
    pub images: Option<Res<'w, Assets<Image>>>,
    pub atlases: Option<Res<'w, Assets<TextureAtlasLayout>>>,
    pub meshes: Option<Res<'w, Assets<Mesh>>>,
    pub materials: Option<Res<'w, Assets<ColorMaterial>>>,
    pub text_colors: Query<'w, 's, &'static TextColor>,
}

/// Marks apps in which Bevy propagates visibility from parents to children. Without it, only an
/// entity's own [`Visibility`] counts.
#[derive(Resource, Default)]
pub struct VisibilityPropagates;

/// The transform, visibility and layers of an entity.
#[derive(QueryData)]
pub struct EntityPlace {
    pub transform: &'static GlobalTransform,
    own: Option<&'static Visibility>,
    inherited: Option<&'static InheritedVisibility>,
    layers: Option<&'static RenderLayers>,
}

impl EntityPlaceItem<'_, '_> {
    /// Returns whether the entity is visible, on or off the screen.
    pub fn is_visible(&self, propagates: bool) -> bool {
        if propagates {
            self.inherited.is_none_or(|visibility| visibility.get())
        } else {
            self.own.is_none_or(|visibility| *visibility != Visibility::Hidden)
        }
    }

    /// The entity's render layers.
    pub fn layers(&self) -> RenderLayers {
        self.layers.unwrap_or_default().clone()
    }

    /// The entity's z in the world.
    pub fn z(&self) -> f32 {
        self.transform.translation().z
    }
}
