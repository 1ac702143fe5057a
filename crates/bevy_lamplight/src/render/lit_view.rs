//! What is kept of each lit camera from frame to frame.

use super::budget::Budget;
use super::draw::Draw;
use super::extract::ExtractedView;
use super::stage::{GLOW, MATTER, Pipelines, SUMS, Stage, Staged};
use crate::components::Lighting2d;
use crate::pieces::Surroundings;
use bevy::log::{error, warn};
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::{Entity, Resource};
use lamplight::{Method, Settings};
use lamplight_wgpu::wgpu::util::TextureBlitter;
use lamplight_wgpu::wgpu::{
    BindGroup, Device, Extent3d, Queue, TextureDescriptor, TextureDimension, TextureFormat,
    TextureUsages, TextureView,
};
use lamplight_wgpu::{Compose, Lighting, Result, Textures, Window};
use std::fmt::Display;

/// Lit cameras, by their entities in the render world.
#[derive(Resource, Default)]
pub struct LitViews {
    pub views: HashMap<Entity, LitView>,
    pub told: Told,
}

/// What was said of cameras; once is enough.
#[derive(Default)]
pub struct Told(HashSet<(Entity, String)>);

impl Told {
    /// Says why a camera is not lit.
    pub fn problem(&mut self, camera: Entity, words: impl Display) {
        let words = words.to_string();
        if self.is_new(camera, &words) {
            error!("the camera {camera} is not lit: {words}");
        }
    }

    /// Says what may surprise.
    pub fn advice(&mut self, camera: Entity, words: impl Display) {
        let words = words.to_string();
        if self.is_new(camera, &words) {
            warn!("the camera {camera}: {words}");
        }
    }

    /// The same with other figures is the same.
    fn is_new(&mut self, camera: Entity, words: &str) -> bool {
        let kind = words.replace(|c: char| c.is_ascii_digit() || c == '.', "");
        self.0.insert((camera, kind))
    }
}

/// A lit camera.
pub struct LitView {
    pub lighting: Lighting,
    pub budget: Budget,
    /// Of spots, where the method does not light them itself.
    pub spots: Option<Spots>,
    pub compose: Compose,
    /// Carries over what lies around the camera's part of its target, which is other cameras'.
    pub around: Option<(TextureFormat, TextureBlitter)>,
    pub draw: Draw,
    pub staged: Staged,
    pub grid: Grid,
    /// What glows on the screen; made when something does.
    pub glow: Option<TextureView>,
    /// Light for the user's own passes, where they asked for it.
    pub texture: Option<TextureView>,
    asked: (Lighting2d, f32),
}

/// Light of spots, found by `polar`.
pub struct Spots {
    pub lighting: Lighting,
    pub light: TextureView,
}

/// Matter, cell by cell.
pub struct Grid {
    pub size: [u32; 2],
    pub sums: [TextureView; 4],
    pub sums_group: BindGroup,
    pub matter: [TextureView; 3],
}

impl Grid {
    fn new(device: &Device, pipelines: &Pipelines, size: [u32; 2]) -> Self {
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        let sums = SUMS.map(|format| texture(device, "lamplight sums", size, format, usage));
        Self {
            size,
            sums_group: pipelines.bind_sums(device, &sums),
            sums,
            matter: MATTER.map(|format| texture(device, "lamplight matter", size, format, usage)),
        }
    }

    fn textures(&self) -> Textures {
        let [emission, tint_opacity, albedo] = self.matter.clone();
        Textures { emission, tint_opacity, albedo }
    }
}

impl LitView {
    pub fn new(
        device: &Device,
        queue: &Queue,
        pipelines: &Pipelines,
        view: &ExtractedView,
    ) -> Result<Self> {
        let cell = view.placement.cell;
        let settings = view.lighting.settings(cell)?;
        Ok(Self {
            lighting: Lighting::new(device, queue, settings)?,
            budget: Budget::new(device, queue),
            spots: None,
            compose: Compose::new(device)?,
            around: None,
            draw: Draw::default(),
            staged: Staged::default(),
            grid: Grid::new(device, pipelines, view.placement.placed.size),
            glow: None,
            texture: None,
            asked: (view.lighting.clone(), cell),
        })
    }

    /// Makes everything ready to be recorded; `target`: pixels of what the camera draws on, and the
    /// part of it that is its own.
    pub fn prepare(
        &mut self,
        device: &Device,
        queue: &Queue,
        pipelines: &Pipelines,
        view: &ExtractedView,
        surroundings: &Surroundings,
        target: Target,
    ) -> Result<()> {
        let ExtractedView { placement, lighting, .. } = view;
        let asked = (lighting.clone(), placement.cell);
        if asked != self.asked {
            self.lighting.set_settings(device, queue, lighting.settings(placement.cell)?)?;
            self.asked = asked;
        }
        let placed = &placement.placed;
        if placed.size != self.grid.size {
            self.grid = Grid::new(device, pipelines, placed.size);
        }
        let by_rule = lighting.method.lights_lamps();
        self.draw.take(view, surroundings, by_rule);
        let [width, height] = placed.size.map(|v| v as f32);
        let grid = Stage {
            x_axis: [2.0 / width, 0.0],
            y_axis: [0.0, -2.0 / height],
            origin: [-1.0, 1.0],
            size: [width, height],
            cell: placement.cell,
            unused: 0.0,
        };
        let stages = [grid, on_screen(&placed.window, placement.cell, target.viewport)];
        self.staged.write(device, queue, pipelines, &self.draw, stages)?;
        self.glow = match (self.draw.glows, self.glow.take()) {
            (false, _) => None,
            (true, Some(glow)) if size_of_view(&glow) == target.size => Some(glow),
            (true, _) => {
                let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
                Some(texture(device, "lamplight glow", target.size, GLOW, usage))
            }
        };

        let textures = self.grid.textures();
        self.lighting.set_origin(placed.origin);
        self.lighting.set_lamps(if by_rule { &self.draw.lamps } else { &[] })?;
        self.lighting.prepare_textures(device, queue, &textures, view.sky)?;
        self.prepare_spots(device, queue, view, &textures, by_rule)?;
        self.texture = match (view.to_texture, self.texture.take()) {
            (false, _) => None,
            (true, Some(texture)) if size_of_view(&texture) == placed.size => Some(texture),
            (true, _) => Some(light_texture(device, placed.size)),
        };
        if let Some(texture) = &self.texture {
            self.lighting.write_to(device, texture)?;
        }
        Ok(())
    }

    fn prepare_spots(
        &mut self,
        device: &Device,
        queue: &Queue,
        view: &ExtractedView,
        textures: &Textures,
        by_rule: bool,
    ) -> Result<()> {
        if by_rule || self.draw.lamps.is_empty() {
            self.spots = None;
            return Ok(());
        }
        let size = view.placement.placed.size;
        let wall_depth = self.lighting.settings().wall_depth;
        let settings = Settings { method: Method::Polar, wall_depth, ..Settings::default() };
        let mut spots = match self.spots.take() {
            Some(mut spots) => {
                if *spots.lighting.settings() != settings {
                    spots.lighting.set_settings(device, queue, settings)?;
                }
                spots
            }
            None => Spots {
                lighting: Lighting::new(device, queue, settings)?,
                light: light_texture(device, size),
            },
        };
        if size_of_view(&spots.light) != size {
            spots.light = light_texture(device, size);
        }
        spots.lighting.set_lamps(&self.draw.lamps)?;
        spots.lighting.prepare_textures(device, queue, textures, lamplight::Sky::BLACK)?;
        spots.lighting.write_to(device, &spots.light)?;
        self.spots = Some(spots);
        Ok(())
    }
}

/// What a camera draws on.
#[derive(Clone, Copy)]
pub struct Target {
    /// Pixels.
    pub size: [u32; 2],
    /// Pixels of the camera's own part.
    pub viewport: [u32; 2],
}

/// From cells to the camera's part of the screen: the way back from its window.
fn on_screen(window: &Window, cell: f32, viewport: [u32; 2]) -> Stage {
    use bevy::math::{Affine2, Vec2};
    let Window { corner, right, down } = *window;
    let cells = Affine2::from_cols(right.into(), down.into(), corner.into());
    let across = cells.inverse();
    let clip = |v: Vec2| [2.0 * v.x, -2.0 * v.y];
    let origin = clip(across.translation);
    Stage {
        x_axis: clip(across.matrix2.x_axis),
        y_axis: clip(across.matrix2.y_axis),
        origin: [origin[0] - 1.0, origin[1] + 1.0],
        size: viewport.map(|v| v as f32),
        cell,
        unused: 0.0,
    }
}

fn light_texture(device: &Device, size: [u32; 2]) -> TextureView {
    let usage = TextureUsages::STORAGE_BINDING | TextureUsages::TEXTURE_BINDING;
    texture(device, "lamplight light", size, TextureFormat::Rgba16Float, usage)
}

fn size_of_view(view: &TextureView) -> [u32; 2] {
    [view.texture().width(), view.texture().height()]
}

fn texture(
    device: &Device,
    label: &str,
    [width, height]: [u32; 2],
    format: TextureFormat,
    usage: TextureUsages,
) -> TextureView {
    let texture = device.create_texture(&TextureDescriptor {
        label: Some(label),
        size: Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    });
    texture.create_view(&Default::default())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_problem_is_told_once_a_camera_whatever_its_figures() {
        let mut told = Told::default();
        let [first, second] = [1, 2].map(|i| Entity::from_raw_u32(i).unwrap());
        assert!(told.is_new(first, "exposure is 33, not below 32"));
        assert!(!told.is_new(first, "exposure is 34.5, not below 32"));
        assert!(told.is_new(first, "wall_depth is 33, not below 32"));
        assert!(told.is_new(second, "exposure is 33, not below 32"));
    }
}
