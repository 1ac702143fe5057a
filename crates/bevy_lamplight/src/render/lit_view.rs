//! State of each lit camera that persists across frames.

use super::backend::LightBackend;
use super::budget::Budget;
use super::draw::{DrawList, LampModel};
use super::extract::{ExtractedLighting, LitCameraView};
use super::pipelines::{GLOW, LAMPS, MASKS, MATTER, NORMALS, Pipelines, SUMS, TargetTransform};
use super::quad_buffers::QuadBuffers;
use crate::camera_log::CameraLog;
use crate::components::Lighting2d;
use bevy::platform::collections::HashMap;
use bevy::prelude::{Entity, Resource};
use lamplight::Settings;
use lamplight_wgpu::wgpu::util::TextureBlitter;
use lamplight_wgpu::wgpu::{
    BindGroup, Device, Extent3d, Queue, TextureDescriptor, TextureDimension, TextureFormat,
    TextureUsages, TextureView,
};
use lamplight_wgpu::{
    Backend, Compose, Error, FrameInput, Lighting, LightingOptions, Lights, Textures, VisibleRect,
    check_grid,
};

/// Lit cameras by their entity in the render world.
#[derive(Resource, Default)]
pub struct LitViews {
    pub views: HashMap<Entity, LitView>,
    /// Lights nothing, and keeps what cameras have compiled for those that come after them.
    pub compiled: Option<Lighting>,
    pub log: CameraLog,
}

/// The lighting of one camera.
pub struct LitView {
    /// True if it is prepared for this frame. Otherwise the camera's picture stays as it is.
    pub is_lit: bool,
    /// True if this frame's matter is drawn already.
    pub is_drawn: bool,
    pub lighting: Lighting,
    pub budget: Budget,
    pub compose: Compose,
    /// Copies the parts of the target that belong to other cameras.
    pub neighbours: Option<(TextureFormat, TextureBlitter)>,
    pub draw: DrawList,
    pub quads: QuadBuffers,
    pub grid: MatterTextures,
    /// Emitted light on the screen, if there is any.
    pub glow: Option<TextureView>,
    /// Normals on the screen, if there are any.
    pub normals: Option<TextureView>,
    /// Light for passes of the user, if the camera has a `LightTexture2d`.
    pub texture: Option<TextureView>,
    settings: Settings,
    configured: Configuration,
}

/// The values that a camera's settings of light are resolved from.
#[derive(PartialEq)]
struct Configuration {
    lighting: Lighting2d,
    /// World units per cell.
    cell: f32,
    has_normals: bool,
    /// The elevation of light, radians.
    elevation: f32,
}

impl Configuration {
    fn of(view: &LitCameraView, budget: &mut Budget) -> Self {
        let LitCameraView { lighting, placement, has_normals, relief, .. } = view;
        let quality = budget.quality(lighting.quality);
        let (lighting, cell) = (Lighting2d { quality, ..lighting.clone() }, placement.cell);
        Self { lighting, cell, has_normals: *has_normals, elevation: relief.elevation }
    }

    /// Resolves the settings. Normals need the first moment of light.
    fn settings(&self) -> Result<Settings, Error> {
        let settings = self.lighting.settings(self.cell)?;
        let moment = settings.moment || self.has_normals;
        let settings = Settings { moment, elevation: self.elevation, ..settings };
        settings.check()?;
        Ok(settings)
    }
}

/// Matter, cell by cell.
pub struct MatterTextures {
    pub size: [u32; 2],
    pub sums: [TextureView; 4],
    pub sums_group: BindGroup,
    pub matter: [TextureView; 3],
    /// The emission coefficient of lamps, from the first one that glows on.
    pub lamps: Option<TextureView>,
    /// Light layers, from the first lamp on that chooses among them.
    pub masks: Option<TextureView>,
}

impl MatterTextures {
    fn new(device: &Device, pipelines: &Pipelines, size: [u32; 2]) -> Result<Self, Error> {
        check_grid(device, size)?;
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        let sums = SUMS.map(|format| texture(device, "lamplight sums", size, format, usage));
        Ok(Self {
            size,
            sums_group: pipelines.bind_sums(device, &sums),
            sums,
            matter: MATTER.map(|format| texture(device, "lamplight matter", size, format, usage)),
            lamps: None,
            masks: None,
        })
    }

    /// Makes room for lamps that glow.
    fn add_lamps(&mut self, device: &Device) {
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        let lamps = || texture(device, "lamplight lamps", self.size, LAMPS, usage);
        self.lamps.get_or_insert_with(lamps);
    }

    /// Makes room for light layers.
    fn add_masks(&mut self, device: &Device) {
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        let masks = || texture(device, "lamplight masks", self.size, MASKS, usage);
        self.masks.get_or_insert_with(masks);
    }

    fn textures(&self) -> Textures {
        let [emission, tint_opacity, albedo] = self.matter.clone();
        let (glow, masks) = (self.lamps.clone(), self.masks.clone());
        Textures { emission, tint_opacity, albedo, glow, masks }
    }
}

impl LitView {
    /// `compiled`: the light whose compiled pipelines cameras share.
    pub fn new(
        device: &Device,
        queue: &Queue,
        backend: LightBackend,
        pipelines: &Pipelines,
        view: &LitCameraView,
        compiled: &mut Option<Lighting>,
    ) -> Result<Self, Error> {
        let mut budget = Budget::default();
        let configured = Configuration::of(view, &mut budget);
        // What fails for values that are errors comes first, since it is tried again in each frame.
        let settings = configured.settings()?;
        let grid = MatterTextures::new(device, pipelines, view.placement.placed.size)?;
        budget.measure(device, queue);
        let compiled = match compiled {
            Some(compiled) => compiled,
            // It needs no trial of backends.
            none => none.insert(Lighting::new(device, queue, &LightingOptions::on(Backend::Gpu))?),
        };
        Ok(Self {
            is_lit: false,
            is_drawn: false,
            lighting: compiled.beside(&LightingOptions::on(backend.into()))?,
            budget,
            compose: Compose::new(device, queue)?,
            neighbours: None,
            draw: DrawList::default(),
            quads: QuadBuffers::default(),
            grid,
            glow: None,
            normals: None,
            texture: None,
            settings,
            configured,
        })
    }

    /// Prepares the matter of a frame for drawing.
    pub fn prepare_matter(
        &mut self,
        device: &Device,
        queue: &Queue,
        pipelines: &Pipelines,
        view: &LitCameraView,
        extracted: &ExtractedLighting,
        target: CameraTarget,
    ) -> Result<(), Error> {
        let placement = &view.placement;
        let wanted = Configuration::of(view, &mut self.budget);
        if wanted != self.configured {
            if wanted.cell != self.configured.cell {
                // History has cells of another size.
                self.lighting.reset();
            }
            self.settings = wanted.settings()?;
            self.configured = wanted;
        }
        let placed = &placement.placed;
        if placed.size != self.grid.size {
            self.grid = MatterTextures::new(device, pipelines, placed.size)?;
        }
        self.draw.fill(view, extracted, LampModel::of(&self.settings));
        if !self.draw.lamp_batches.is_empty() {
            self.grid.add_lamps(device);
        }
        if !self.draw.mask_batches.is_empty() {
            self.grid.add_masks(device);
        }
        let [width, height] = placed.size.map(|v| v as f32);
        let grid = TargetTransform {
            x_axis: [2.0 / width, 0.0],
            y_axis: [0.0, -2.0 / height],
            origin: [-1.0, 1.0],
            size: [width, height],
            cell: placement.cell,
            unused: [0.0; 3],
        };
        let screen = on_screen(&placed.visible, placement.cell, target.viewport);
        self.quads.write(device, queue, pipelines, &self.draw, [grid, screen])?;
        let on_target = |label, format| {
            let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
            texture(device, label, target.size, format, usage)
        };
        let has_normals = !self.draw.surface_batches.is_empty();
        keep(&mut self.glow, self.draw.glows, target.size, || on_target("lamplight glow", GLOW));
        keep(&mut self.normals, has_normals, target.size, || {
            on_target("lamplight normals", NORMALS)
        });
        keep(&mut self.texture, view.has_light_texture, placed.size, || {
            light_texture(device, placed.size)
        });
        Ok(())
    }

    /// Prepares the light of a frame for recording. The CPU finds it now, of matter that is drawn already.
    pub fn prepare_light(&mut self, view: &LitCameraView) -> Result<(), Error> {
        let placed = &view.placement.placed;
        let textures = self.grid.textures();
        let DrawList { lamps, suns, .. } = &self.draw;
        let lights = Lights { lamps, suns, sky: &view.sky, inflow: view.inflow.as_ref() };
        let input = FrameInput::of_textures(&self.settings, &textures, lights);
        let (origin, output) = (placed.origin, self.texture.as_ref());
        self.lighting.prepare(&FrameInput { origin, output, ..input })?;
        self.budget.spend(self.lighting.timings_on_cpu());
        Ok(())
    }
}

/// The render target of a camera.
#[derive(Clone, Copy)]
pub struct CameraTarget {
    /// Its size, pixels.
    pub size: [u32; 2],
    /// The size of the camera's viewport in it, pixels.
    pub viewport: [u32; 2],
}

/// The map from cells to the camera's viewport: the inverse of its window.
fn on_screen(visible: &VisibleRect, cell: f32, viewport: [u32; 2]) -> TargetTransform {
    use bevy::math::{Affine2, Vec2};
    let VisibleRect { corner, right, down } = *visible;
    let cells = Affine2::from_cols(right.into(), down.into(), corner.into());
    let across = cells.inverse();
    let clip = |v: Vec2| [2.0 * v.x, -2.0 * v.y];
    let origin = clip(across.translation);
    TargetTransform {
        x_axis: clip(across.matrix2.x_axis),
        y_axis: clip(across.matrix2.y_axis),
        origin: [origin[0] - 1.0, origin[1] + 1.0],
        size: viewport.map(|v| v as f32),
        cell,
        unused: [0.0; 3],
    }
}

/// Keeps a texture while it is needed and has its size, and makes it anew otherwise.
fn keep(
    own: &mut Option<TextureView>,
    is_needed: bool,
    size: [u32; 2],
    make: impl FnOnce() -> TextureView,
) {
    let kept = own.take().filter(|view| size_of_view(view) == size);
    *own = is_needed.then(|| kept.unwrap_or_else(make));
}

fn light_texture(device: &Device, size: [u32; 2]) -> TextureView {
    let written = match device.limits().max_storage_textures_per_shader_stage {
        0 => TextureUsages::empty(),
        _ => TextureUsages::STORAGE_BINDING,
    };
    let usage = written | TextureUsages::COPY_DST | TextureUsages::TEXTURE_BINDING;
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
