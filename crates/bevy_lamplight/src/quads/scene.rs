//! The scene as quads, lamps and suns, in world units.

use super::material::QuadMaterial;
use super::quad::Quad;
use crate::components::WorldLamp;
use bevy::asset::AssetId;
use bevy::camera::visibility::RenderLayers;
use bevy::image::Image;
use bevy::math::{Rect, Vec2};
use lamplight::{ALL_LAYERS, Sun};
use std::ops::Range;

/// Everything that takes part in light, the surfaces that are lit, or the light layers of what is lit.
#[derive(Debug, Default)]
pub struct ExtractedScene {
    /// Quads, group after group.
    pub quads: Vec<Quad>,
    /// Materials that quads refer to by index.
    pub materials: Vec<QuadMaterial>,
    /// Groups from the bottom to the top: later ones cover earlier ones.
    pub groups: Vec<QuadGroup>,
    /// Lamps that are on.
    pub lamps: Vec<(WorldLamp, RenderLayers)>,
    /// Suns that are on, as grids see them.
    pub suns: Vec<(Sun, RenderLayers)>,
}

/// The quads of one entity that show one image.
#[derive(Debug)]
pub struct QuadGroup {
    /// Range in [`ExtractedScene::quads`].
    pub quads: Range<u32>,
    /// The image that they show.
    pub image: AssetId<Image>,
    /// The image of their normals, if they have any.
    pub normals: Option<AssetId<Image>>,
    /// Layers of the entity.
    pub layers: RenderLayers,
    /// True if Bevy draws it on the screen; it does not draw occluders.
    pub is_drawn: bool,
    z: f32,
    bounds: Rect,
}

impl QuadGroup {
    /// Returns whether any quad may overlap an area of the world.
    pub fn touches(&self, area: Rect) -> bool {
        overlaps(self.bounds, area)
    }

    /// Returns whether all of its quads lie in an area of the world.
    pub fn is_within(&self, area: Rect) -> bool {
        is_within(self.bounds, area)
    }
}

/// Returns whether a box and an area overlap or touch.
pub fn overlaps(own: Rect, area: Rect) -> bool {
    own.min.cmple(area.max).all() && area.min.cmple(own.max).all()
}

/// Returns whether a box lies in an area.
pub fn is_within(own: Rect, area: Rect) -> bool {
    own.min.cmpge(area.min).all() && own.max.cmple(area.max).all()
}

/// Properties of a new group.
pub struct GroupSettings {
    pub image: AssetId<Image>,
    pub normals: Option<AssetId<Image>>,
    pub layers: RenderLayers,
    pub is_drawn: bool,
    pub z: f32,
}

impl ExtractedScene {
    /// Removes everything and keeps the allocations.
    pub fn clear(&mut self) {
        self.quads.clear();
        self.materials.clear();
        self.groups.clear();
        self.lamps.clear();
        self.suns.clear();
    }

    /// The quads of a group.
    pub fn quads_of(&self, group: &QuadGroup) -> &[Quad] {
        &self.quads[group.quads.start as usize..group.quads.end as usize]
    }

    /// Adds a material and returns its index.
    pub fn add_material(&mut self, material: QuadMaterial) -> u32 {
        self.materials.push(material);
        self.materials.len() as u32 - 1
    }

    /// Makes a group of all quads from index `first` on. Drops them if they overlap none of the areas
    /// or are not finite.
    pub fn finish_group(&mut self, first: usize, settings: GroupSettings, areas: &[Rect]) {
        let GroupSettings { image, normals, layers, is_drawn, z } = settings;
        let quads = &self.quads[first..];
        let corners = quads.iter().flat_map(|quad| quad.world.corners());
        let bounds = corners.fold(Rect::EMPTY, |all, corner| all.union_point(corner));
        let range = first as u32..self.quads.len() as u32;
        let group = QuadGroup { quads: range, image, normals, layers, is_drawn, z, bounds };
        let is_finite = quads.iter().all(Quad::is_finite) && !z.is_nan();
        if !is_finite || quads.is_empty() || !areas.iter().any(|&area| group.touches(area)) {
            self.quads.truncate(first);
            return;
        }
        self.groups.push(group);
    }

    /// Returns whether there is a lamp or sun that does not light all layers.
    pub fn has_masked_lights(&self) -> bool {
        let lamps = self.lamps.iter().map(|(lamp, _)| lamp.mask);
        lamps.chain(self.suns.iter().map(|(sun, _)| sun.mask)).any(|mask| mask != ALL_LAYERS)
    }

    /// Bounds of all groups and of the ranges of all lamps; `None` if there are none.
    pub fn bounds(&self) -> Option<Rect> {
        let groups = self.groups.iter().map(|group| group.bounds);
        let lamps = self
            .lamps
            .iter()
            .map(|(lamp, _)| Rect::from_center_half_size(lamp.position, Vec2::splat(lamp.range)));
        groups.chain(lamps).reduce(|all, own| all.union(own))
    }

    /// Sorts groups from the bottom to the top.
    pub fn sort(&mut self) {
        self.groups.sort_by(|a, b| a.z.total_cmp(&b.z));
    }
}
