//! The draw list of a camera.

use super::extract::{ExtractedLighting, LitCameraView};
use crate::quads::{ExtractedScene, Quad, QuadGroup, QuadMap, QuadMaterial, QuadShape};
use crate::surroundings::is_parted;
use bevy::asset::AssetId;
use bevy::image::Image;
use bevy::math::Vec2;
use bevy::platform::collections::HashMap;
use lamplight::internals::lamp;
use lamplight::surroundings::{LampPart, part_lamp};
use lamplight::{ALL_LAYERS, Lamp, Settings, Sun};
use std::ops::Range;

/// Quads on the grid of a camera, in cells and y down, in drawing order.
#[derive(Debug, Default)]
pub struct DrawList {
    pub quads: Vec<Quad>,
    /// The material of each quad.
    pub materials: Vec<QuadMaterial>,
    pub batches: Vec<QuadBatch>,
    /// The batches of lamps that glow, which block nothing.
    pub lamp_batches: Vec<QuadBatch>,
    /// The batches of everything drawn, if any of it has normals.
    pub surface_batches: Vec<QuadBatch>,
    /// The batches of everything with light layers, if any lamp chooses among them.
    pub mask_batches: Vec<QuadBatch>,
    /// True if anything on the screen emits light.
    pub glows: bool,
    /// Lamps that are lit by rule instead of as discs.
    pub lamps: Vec<Lamp>,
    pub suns: Vec<Sun>,
    normalization: SourceNormalization,
}

/// Quads of one draw call.
#[derive(Debug)]
pub struct QuadBatch {
    pub image: AssetId<Image>,
    /// The image of their normals, if they have any.
    pub normals: Option<AssetId<Image>>,
    pub quads: Range<u32>,
    /// True if Bevy draws them on the screen.
    pub is_drawn: bool,
}

impl DrawList {
    /// Lists everything on the grid of a camera. Lamps that cannot be drawn ([`Lamp::is_exact`]), and with
    /// [`LampModel::ByRule`] all lamps, are lit by rule; others are drawn as discs.
    pub fn fill(&mut self, view: &LitCameraView, extracted: &ExtractedLighting, model: LampModel) {
        let ExtractedLighting { scene, surfaces, masks, .. } = extracted;
        self.quads.clear();
        self.materials.clear();
        self.lamp_batches.clear();
        self.lamps.clear();
        self.suns.clear();
        self.glows = false;
        let batches = std::mem::take(&mut self.batches);
        self.batches = self.add_groups(view, scene, batches);
        self.add_lamps(view, scene, model);
        self.surface_batches.clear();
        // Where nothing has normals, flat surfaces change nothing.
        if surfaces.groups.iter().any(|group| group.normals.is_some() && is_seen(group, view)) {
            let batches = std::mem::take(&mut self.surface_batches);
            self.surface_batches = self.add_groups(view, surfaces, batches);
        }
        let suns = scene.suns.iter().filter(|(_, layers)| layers.intersects(&view.layers));
        self.suns.extend(suns.map(|(sun, _)| *sun));
        self.mask_batches.clear();
        if !self.light_all_layers() {
            let batches = std::mem::take(&mut self.mask_batches);
            self.mask_batches = self.add_groups(view, masks, batches);
        }
    }

    /// Returns whether all lamps and suns of the camera light all layers.
    fn light_all_layers(&self) -> bool {
        let masks = self.lamps.iter().map(|lamp| lamp.mask);
        masks.chain(self.suns.iter().map(|sun| sun.mask)).all(|mask| mask == ALL_LAYERS)
    }

    /// Lists the quads of a scene, and returns their batches, with neighbours of one image in one. Those given lend their
    /// allocation.
    fn add_groups(
        &mut self,
        view: &LitCameraView,
        scene: &ExtractedScene,
        mut batches: Vec<QuadBatch>,
    ) -> Vec<QuadBatch> {
        batches.clear();
        let placement = &view.placement;
        for group in scene.groups.iter().filter(|group| is_seen(group, view)) {
            let quads = scene.quads_of(group);
            let begin = self.quads.len() as u32;
            let on_grid = |quad: &Quad| Quad { world: placement.on_grid(&quad.world), ..*quad };
            self.quads.extend(quads.iter().map(on_grid));
            let materials = quads.iter().map(|quad| scene.materials[quad.material as usize]);
            self.materials.extend(materials);
            self.glows |= group.is_drawn && scene.materials[quads[0].material as usize].glows();
            let end = self.quads.len() as u32;
            let QuadGroup { image, normals, is_drawn, .. } = *group;
            match batches.last_mut() {
                Some(last)
                    if (last.image, last.normals, last.is_drawn) == (image, normals, is_drawn) =>
                {
                    last.quads.end = end;
                }
                _ => batches.push(QuadBatch { image, normals, quads: begin..end, is_drawn }),
            }
        }
        batches
    }

    /// Lists lamps: those lit by rule as they are, the others as the quads of their discs.
    fn add_lamps(&mut self, view: &LitCameraView, scene: &ExtractedScene, model: LampModel) {
        let placement = &view.placement;
        let corner = placement.corner();
        for (lamp, layers) in &scene.lamps {
            let by_rule = model == LampModel::ByRule;
            let on_grid = lamp.on_grid(corner, placement.cell, by_rule);
            if !layers.intersects(&view.layers) || on_grid.check(&"lamp").is_err() {
                continue;
            }
            if by_rule || on_grid.is_exact() {
                self.lamps.push(on_grid);
                continue;
            }
            // Where all lamps are solid by the method's rule, all are visible.
            let all_solid = model == LampModel::Solid;
            let (is_solid, is_visible) = (all_solid || on_grid.solid, all_solid || on_grid.visible);
            if view.inflow.is_none() || !is_parted(&on_grid, all_solid) {
                self.add_lamp(view, &on_grid, is_solid, is_visible);
                continue;
            }
            let parts = part_lamp(&on_grid, placement.placed.size);
            for (part, _) in parts.filter(|(_, part)| *part == LampPart::Inside) {
                self.add_lamp(view, &part, is_solid, is_visible);
            }
        }
    }

    /// Lists a lamp, if its disc is on the grid.
    fn add_lamp(&mut self, view: &LitCameraView, lamp: &Lamp, is_solid: bool, is_visible: bool) {
        let middle = Vec2::from(lamp.position);
        let [width, height] = view.placement.placed.size.map(|v| v as f32);
        let past = (middle - middle.clamp(Vec2::ZERO, Vec2::new(width, height))).abs();
        if past.max_element() <= lamp.size {
            self.add_disc(lamp, is_solid, is_visible);
        }
    }

    /// Lists the quad of a lamp's disc.
    fn add_disc(&mut self, lamp: &Lamp, is_solid: bool, is_drawn: bool) {
        let gain = if is_solid { self.normalization.of(lamp.position, lamp.size) } else { 1.0 };
        self.materials.push(QuadMaterial::lamp(lamp.color.map(|c| c * lamp.intensity * gain)));
        let size = Vec2::splat(2.0 * lamp.size);
        let map = QuadMap {
            x_axis: [size.x, 0.0],
            y_axis: [0.0, size.y],
            origin: (Vec2::from(lamp.position) - 0.5 * size).to_array(),
        };
        let begin = self.quads.len() as u32;
        self.quads.push(Quad::shape(map, QuadShape::Lamp));
        self.glows |= is_drawn;
        let batches = if is_solid { &mut self.batches } else { &mut self.lamp_batches };
        let image = AssetId::default();
        match batches.last_mut() {
            Some(last)
                if (last.image, last.is_drawn, last.quads.end) == (image, is_drawn, begin) =>
            {
                last.quads.end += 1;
            }
            _ => {
                let quads = begin..begin + 1;
                batches.push(QuadBatch { image, normals: None, quads, is_drawn });
            }
        }
    }
}

/// Returns whether a group may be on the grid of a camera.
fn is_seen(group: &QuadGroup, view: &LitCameraView) -> bool {
    group.layers.intersects(&view.layers) && group.touches(view.placement.area())
}

/// The way in which a method lights lamps without a cone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LampModel {
    /// By range and falloff.
    ByRule,
    /// As discs that glow and block nothing, unless they are solid.
    Glow,
    /// As solid discs.
    Solid,
}

impl LampModel {
    /// The model of settings.
    pub fn of(settings: &Settings) -> Self {
        if settings.method().lights_lamps() {
            Self::ByRule
        } else if settings.method.reads_glow() {
            Self::Glow
        } else {
            Self::Solid
        }
    }
}

/// A cache of [`lamp::gain`], the factor by which a lamp's disc is brightened to make up for the
/// grid. It is keyed by the lamp's place within a cell and its radius, because evaluating it for a
/// thousand lamps per frame would take longer than lighting them.
#[derive(Debug, Default)]
struct SourceNormalization(HashMap<(u8, u8, u32), f32>);

impl SourceNormalization {
    /// Distinct places per axis of a cell.
    const PLACES: f32 = 32.0;
    /// Entries above which the cache is cleared, for lamps whose radius changes every frame.
    const MAX_ENTRIES: usize = 1 << 16;

    fn of(&mut self, position: [f32; 2], radius: f32) -> f32 {
        let place = position.map(|v| (v.rem_euclid(1.0) * Self::PLACES) as u8);
        if self.0.len() > Self::MAX_ENTRIES {
            self.0.clear();
        }
        let gain = || {
            let center = place.map(|v| (f64::from(v) + 0.5) / f64::from(Self::PLACES));
            lamp::gain(center, radius.into())
        };
        *self.0.entry((place[0], place[1], radius.to_bits())).or_insert_with(gain)
    }
}
