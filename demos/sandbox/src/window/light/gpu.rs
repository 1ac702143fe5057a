//! The GPU backend: light is submitted before the window is drawn, and composed in its render pass.

use super::shown::Shown;
use anyhow::Result;
use eframe::egui::{PaintCallbackInfo, Painter, Rect};
use eframe::egui_wgpu::{Callback, CallbackResources, CallbackTrait, RenderState};
use lamplight::{Cells, Light, Settings};
use lamplight_wgpu::read_back::FetchLight;
use lamplight_wgpu::wgpu::{
    Device, Extent3d, Queue, RenderPass, TexelCopyBufferLayout, TextureDescriptor,
    TextureDimension, TextureFormat, TextureUsages, TextureView,
};
use lamplight_wgpu::{
    Backend, Color, Compose, ComposeParams, Filter, FrameInput, Lighting, LightingOptions, Timer,
};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Light computed on the device of the window.
pub struct OnGpu {
    name: String,
    options: LightingOptions,
    device: Device,
    queue: Queue,
    target: TextureFormat,
    lighting: Lighting,
    compose: Arc<Mutex<Compose>>,
    timer: Option<Timer>,
    colors: Option<Values>,
    normals: Option<Values>,
}

/// Three values per cell as a texture.
struct Values {
    size: [u32; 2],
    view: TextureView,
    texels: Vec<[f32; 4]>,
}

impl Values {
    fn new(device: &Device, size: [u32; 2]) -> Self {
        let [width, height] = size;
        let texture = device.create_texture(&TextureDescriptor {
            label: Some("values of the picture"),
            size: Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format: TextureFormat::Rgba32Float,
            usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
            view_formats: &[],
        });
        Self { size, view: texture.create_view(&Default::default()), texels: Vec::new() }
    }

    fn write(&mut self, queue: &Queue, values: &[[f32; 3]]) {
        self.texels.clear();
        self.texels.extend(values.iter().map(|&[x, y, z]| [x, y, z, 1.0]));
        let [width, height] = self.size;
        let layout = TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(16 * width),
            rows_per_image: None,
        };
        let extent = Extent3d { width, height, depth_or_array_layers: 1 };
        let bytes = bytemuck::cast_slice(&self.texels);
        queue.write_texture(self.view.texture().as_image_copy(), bytes, layout, extent);
    }
}

/// Draws the light of the last frame where the window has its place for it.
struct Draw(Arc<Mutex<Compose>>);

impl CallbackTrait for Draw {
    fn paint(&self, _: PaintCallbackInfo, pass: &mut RenderPass<'static>, _: &CallbackResources) {
        // Before the first frame there is nothing to draw.
        let _ = self.0.lock().unwrap_or_else(PoisonError::into_inner).draw(pass);
    }
}

impl OnGpu {
    pub fn new(state: &RenderState, options: LightingOptions, settings: &Settings) -> Result<Self> {
        // Browsers keep the name to themselves.
        let name = Some(state.adapter.get_info().name).filter(|name| !name.is_empty());
        let name = name.unwrap_or_else(|| "the GPU".to_owned());
        let host = (state.device.clone(), state.queue.clone());
        let lighting = Lighting::new(&host.0, &host.1, &options)?;
        Self::on(name, options, host, state.target_format, lighting, settings)
    }

    /// Another one on the same device, with the same pipelines.
    pub fn beside(&self, settings: &Settings) -> Result<Self> {
        Self::on(
            self.name.clone(),
            self.options,
            (self.device.clone(), self.queue.clone()),
            self.target,
            self.lighting.beside(&self.options)?,
            settings,
        )
    }

    fn on(
        name: String,
        options: LightingOptions,
        (device, queue): (Device, Queue),
        target: TextureFormat,
        mut lighting: Lighting,
        settings: &Settings,
    ) -> Result<Self> {
        lighting.precompile(settings)?;
        Ok(Self {
            name,
            options,
            target,
            lighting,
            compose: Arc::new(Mutex::new(Compose::new(&device, &queue)?)),
            timer: Timer::new(&device, &queue),
            colors: None,
            normals: None,
            device,
            queue,
        })
    }

    /// The name of what finds the light.
    pub fn name(&self) -> &str {
        if self.lighting.backend() == Backend::Cpu { "CPU" } else { &self.name }
    }

    /// Computes the light of a frame.
    pub fn light(&mut self, cells: &Cells, settings: &Settings) -> Result<()> {
        let Self { device, queue, lighting, timer, .. } = self;
        lighting.prepare(&FrameInput::of_cells(settings, cells))?;
        let mut encoder = device.create_command_encoder(&Default::default());
        match timer {
            Some(timer) => lighting.record_timed(&mut encoder, timer)?,
            None => lighting.record(&mut encoder)?,
        }
        queue.submit([encoder.finish()]);
        Ok(())
    }

    /// Prepares a picture with that light, which is composed in the window.
    pub fn prepare(&mut self, cells: &Cells, picture: &Cells, shown: Shown) -> Result<()> {
        let Self { device, queue, target, lighting, compose, colors, normals, .. } = self;
        let size = [picture.width(), picture.height()];
        let is_coarse = [cells.width(), cells.height()] != size;
        let write = |kept: &mut Option<Values>, values: &[[f32; 3]]| {
            let kept = kept.take().filter(|kept| kept.size == size);
            let mut kept = kept.unwrap_or_else(|| Values::new(device, size));
            kept.write(queue, values);
            kept
        };
        let of_picture = picture.color().filter(|_| !shown.light_alone);
        *colors = of_picture.map(|values| write(colors, values));
        // Colours and normals keep their own resolution.
        let of_picture = picture.normals().filter(|_| is_coarse && colors.is_some());
        *normals = of_picture.map(|values| write(normals, values));
        let params = ComposeParams {
            display: shown.display,
            filter: if shown.smooth || is_coarse { Filter::Linear } else { Filter::Nearest },
            color: match colors {
                None => Color::White,
                Some(colors) if is_coarse => Color::View(&colors.view),
                Some(colors) => Color::Cells(&colors.view),
            },
            normals: normals.as_ref().map(|normals| &normals.view),
            ..ComposeParams::default()
        };
        let mut compose = compose.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(compose.prepare(lighting, *target, &params)?)
    }

    pub fn draw(&self, painter: &Painter, place: Rect) {
        painter.add(Callback::new_paint_callback(place, Draw(self.compose.clone())));
    }

    pub fn ask(&self, cells: &Cells) -> Result<FetchLight> {
        Ok(FetchLight::new(&self.lighting, cells)?)
    }

    pub fn take(&self, asked: &FetchLight) -> Result<Option<Light>> {
        Ok(asked.take()?)
    }

    pub fn stages(&mut self) -> &[(&'static str, Duration)] {
        if self.lighting.backend() == Backend::Cpu {
            return self.lighting.timings_on_cpu();
        }
        self.timer.as_mut().map_or(&[], Timer::read)
    }

    pub fn memory(&self) -> Option<u64> {
        self.lighting.cost().map(|cost| cost.memory)
    }
}
