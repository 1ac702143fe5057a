//! The matter of the host's textures as numbers, for the CPU.

use crate::error::Result;
use crate::error_scope::with_error_scope;
use crate::fetch::Fetch;
use crate::grid_size::GridSize;
use crate::matter::{Textures, texture_of};
use crate::planner::{FramePlanner, view};
use crate::shader_module::shader_module;
use crate::{programs, shaders};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor,
    Buffer, BufferDescriptor, BufferUsages, COPY_BYTES_PER_ROW_ALIGNMENT, CommandEncoder, Device,
    FragmentState, LoadOp, Operations, PipelineCompilationOptions, PipelineLayoutDescriptor,
    RenderPassColorAttachment, RenderPassDescriptor, RenderPipeline, RenderPipelineDescriptor,
    ShaderStages, StoreOp, TexelCopyBufferInfo, TexelCopyBufferLayout, TextureFormat,
    TextureUsages, TextureView, VertexState,
};

/// Parts of the values, as the shader numbers them; the last is only read if lamps are drawn on a texture of their own.
const PARTS: usize = 4;

/// The format of values: the bits of floats.
const FORMAT: TextureFormat = TextureFormat::Rgba32Uint;

/// The pipelines, the resources of the last grid, and the values on their way.
#[derive(Debug)]
pub struct MatterValues {
    layout: BindGroupLayout,
    /// By part.
    pipelines: [RenderPipeline; PARTS],
    kept: Option<Kept>,
    requested: Option<(GridSize, Fetch<[f32; 4]>)>,
}

/// A texture that a part is drawn on, and the buffer of all parts.
#[derive(Debug)]
struct Kept {
    size: GridSize,
    parts: usize,
    target: TextureView,
    buffer: Buffer,
}

/// The values of a grid.
#[derive(Debug)]
pub struct GridValues {
    pub size: [u32; 2],
    /// Part by part, row by row, each row with its padding.
    texels: Vec<[f32; 4]>,
}

impl GridValues {
    pub const EMISSION: usize = 0;
    /// Tint, and in the last place the opacity.
    pub const TINT_OPACITY: usize = 1;
    /// Albedo, and in the last place the layers ÷ 255.
    pub const ALBEDO_LAYERS: usize = 2;
    /// The emission coefficient.
    pub const GLOW: usize = 3;

    /// The values of a part, cell by cell.
    pub fn part(&self, part: usize) -> impl Iterator<Item = [f32; 4]> + '_ {
        let [width, height] = self.size.map(|side| side as usize);
        let stride = row_bytes(self.size[0]) as usize / TEXEL;
        let rows = self.texels[part * height * stride..].chunks(stride).take(height);
        rows.flat_map(move |row| row[..width].iter().copied())
    }
}

/// Bytes of the value of a cell.
const TEXEL: usize = size_of::<[f32; 4]>();

/// Returns the bytes of a row of values, with the padding that copies need.
fn row_bytes(width: u32) -> u32 {
    (width * TEXEL as u32).next_multiple_of(COPY_BYTES_PER_ROW_ALIGNMENT)
}

impl MatterValues {
    pub fn new(planner: &FramePlanner) -> Result<Self> {
        let device = planner.device;
        with_error_scope(device, || {
            let program = programs::MATTER_VALUES;
            let label = Some(shaders::label(program.shader));
            let slots = (0..).zip(program.bindings);
            let slots =
                slots.map(|(slot, (_, binding))| binding.entry(slot, ShaderStages::FRAGMENT));
            let layout = device.create_bind_group_layout(&BindGroupLayoutDescriptor {
                label,
                entries: &slots.collect::<Vec<_>>(),
            });
            let pipelines = pipelines(device, &layout);
            Ok(Self { layout, pipelines, kept: None, requested: None })
        })
    }

    /// Requests the values of the textures as they are now, after everything that was submitted before.
    pub fn request(&mut self, planner: &FramePlanner, textures: &Textures) -> Result<()> {
        let FramePlanner { device, shared, size, .. } = *planner;
        let parts = if textures.glow.is_some() { PARTS } else { PARTS - 1 };
        let kept = self.kept.take().filter(|kept| kept.size == size && kept.parts >= parts);
        let kept = match kept {
            Some(kept) => kept,
            None => with_error_scope(device, || Kept::new(planner, parts))?,
        };
        let record = || -> Result<()> {
            let bound = self.bind(planner, textures);
            let mut encoder = device.create_command_encoder(&Default::default());
            for (part, pipeline) in self.pipelines.iter().enumerate().take(parts) {
                kept.draw(&mut encoder, pipeline, &bound);
                kept.copy(&mut encoder, part);
            }
            shared.queue.submit([encoder.finish()]);
            Ok(())
        };
        with_error_scope(device, record)?;
        self.requested = Some((size, Fetch::new(device, &shared.queue, &kept.buffer)?));
        self.kept = Some(kept);
        Ok(())
    }

    /// Returns whether values are on their way.
    pub fn is_requested(&self) -> bool {
        self.requested.is_some()
    }

    /// Forgets the values that are on their way.
    pub fn forget(&mut self) {
        self.requested = None;
    }

    /// Returns the values that were requested; none if they have not arrived, unless it `waits` for them.
    pub fn arrived(&mut self, waits: bool) -> Result<Option<GridValues>> {
        let Some((size, fetch)) = self.requested.take() else { return Ok(None) };
        let texels = if waits {
            fetch.wait()?
        } else if let Some(texels) = fetch.take()? {
            texels
        } else {
            self.requested = Some((size, fetch));
            return Ok(None);
        };
        Ok(Some(GridValues { size: size.into(), texels }))
    }

    fn bind(&self, planner: &FramePlanner, textures: &Textures) -> BindGroup {
        let shared = planner.shared;
        let resources = [
            shared.frame.as_entire_binding(),
            view(&textures.emission),
            view(&textures.tint_opacity),
            view(&textures.albedo),
            view(textures.glow.as_ref().unwrap_or(&shared.no_cookies)),
            planner.masks(),
        ];
        let entries = (0..).zip(resources);
        let entries = entries.map(|(binding, resource)| BindGroupEntry { binding, resource });
        planner.device.create_bind_group(&BindGroupDescriptor {
            label: Some(shaders::label(programs::MATTER_VALUES.shader)),
            layout: &self.layout,
            entries: &entries.collect::<Vec<_>>(),
        })
    }
}

impl Kept {
    fn new(planner: &FramePlanner, parts: usize) -> Result<Self> {
        let size = planner.size;
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
        let bytes = parts as u64 * u64::from(row_bytes(size.width)) * u64::from(size.height);
        let most = planner.device.limits().max_buffer_size;
        if bytes > most {
            return Err(size.too_large("bytes for the matter of its textures", bytes, most));
        }
        let buffer = planner.device.create_buffer(&BufferDescriptor {
            label: Some("matter values"),
            size: bytes,
            usage: BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let target = texture_of(planner.device, "matter values", size.into(), FORMAT, usage);
        Ok(Self { size, parts, target, buffer })
    }

    /// Draws a part.
    fn draw(&self, encoder: &mut CommandEncoder, pipeline: &RenderPipeline, bound: &BindGroup) {
        let mut pass = encoder.begin_render_pass(&RenderPassDescriptor {
            label: Some("matter values"),
            color_attachments: &[Some(RenderPassColorAttachment {
                view: &self.target,
                depth_slice: None,
                resolve_target: None,
                ops: Operations { load: LoadOp::Clear(Default::default()), store: StoreOp::Store },
            })],
            ..RenderPassDescriptor::default()
        });
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, bound, &[]);
        pass.draw(0..3, 0..1);
    }

    /// Copies the part that was drawn to its place in the buffer.
    fn copy(&self, encoder: &mut CommandEncoder, part: usize) {
        let GridSize { width, height } = self.size;
        let row = row_bytes(width);
        let offset = part as u64 * u64::from(row) * u64::from(height);
        let layout =
            TexelCopyBufferLayout { offset, bytes_per_row: Some(row), rows_per_image: None };
        let texture = self.target.texture();
        let to = TexelCopyBufferInfo { buffer: &self.buffer, layout };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), to, texture.size());
    }
}

/// Compiles the pipeline of each part.
fn pipelines(device: &Device, layout: &BindGroupLayout) -> [RenderPipeline; PARTS] {
    let shader = programs::MATTER_VALUES.shader;
    let label = Some(shaders::label(shader));
    let module = shader_module(device, shaders::label(shader), shaders::text(shader));
    let layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
        label,
        bind_group_layouts: &[Some(layout)],
        immediate_size: 0,
    });
    std::array::from_fn(|part| {
        device.create_render_pipeline(&RenderPipelineDescriptor {
            label,
            layout: Some(&layout),
            vertex: VertexState {
                module: &module,
                entry_point: Some("cover"),
                compilation_options: PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(FragmentState {
                module: &module,
                entry_point: Some("values"),
                compilation_options: PipelineCompilationOptions {
                    constants: &[("PART", part as f64)],
                    ..PipelineCompilationOptions::default()
                },
                targets: &[Some(FORMAT.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    })
}
