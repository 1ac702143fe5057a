//! The matter of the host's textures as numbers, for the CPU.

use crate::draw_program::DrawProgram;
use crate::error::{PrepareError, Result};
use crate::error_scope::with_error_scope;
use crate::fetch::Fetch;
use crate::grid_size::GridSize;
use crate::matter::{Textures, texture_of};
use crate::planner::{FramePlanner, view};
use crate::programs;
use wgpu::{
    BindGroup, BindingResource, Buffer, BufferDescriptor, BufferUsages,
    COPY_BYTES_PER_ROW_ALIGNMENT, CommandEncoder, LoadOp, Operations, RenderPassColorAttachment,
    RenderPassDescriptor, RenderPipeline, StoreOp, TexelCopyBufferInfo, TexelCopyBufferLayout,
    TextureFormat, TextureUsages, TextureView,
};

/// Parts of the values, as the shader numbers them; the last is only read if lamps are drawn on a texture of their own.
const PARTS: usize = 4;

/// The format of values: the bits of floats.
const FORMAT: TextureFormat = TextureFormat::Rgba32Uint;

/// The pipelines, the resources of the last grid, and the values on their way.
#[derive(Debug)]
pub struct MatterValues {
    program: DrawProgram,
    /// By part; compiled when the part is first read.
    pipelines: [Option<RenderPipeline>; PARTS],
    kept: Option<Kept>,
    /// The size of the grid whose values are on their way.
    requested: Option<(GridSize, Fetch<[f32; 4]>)>,
}

/// A texture that a part is drawn on, and the buffer of all parts, which the CPU reads.
#[derive(Debug)]
struct Kept {
    size: GridSize,
    parts: usize,
    target: TextureView,
    buffer: Buffer,
}

/// The values of a grid.
#[derive(Debug)]
pub struct GridValues<'a> {
    size: [u32; 2],
    /// Part by part, row by row, each row with its padding.
    texels: &'a [[f32; 4]],
}

impl GridValues<'_> {
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
            let program = DrawProgram::new(device, programs::MATTER_VALUES);
            Ok(Self { program, pipelines: Default::default(), kept: None, requested: None })
        })
    }

    /// Requests the values of the textures as they are now, after everything that was submitted before. Those that were
    /// requested before are given up.
    pub fn request(&mut self, planner: &FramePlanner, textures: &Textures) -> Result<()> {
        let FramePlanner { device, shared, size, .. } = *planner;
        self.forget();
        let parts = if textures.glow.is_some() { PARTS } else { PARTS - 1 };
        let kept = self.kept.take().filter(|kept| kept.size == size && kept.parts >= parts);
        let kept = match kept {
            Some(kept) => kept,
            None => with_error_scope(device, || Kept::new(planner, parts))?,
        };
        let Self { program, pipelines, .. } = self;
        let record = || -> Result<()> {
            let bound = program.bind(device, resources(planner, textures));
            let mut encoder = device.create_command_encoder(&Default::default());
            for (part, pipeline) in pipelines.iter_mut().enumerate().take(parts) {
                let compile = || program.pipeline(device, FORMAT.into(), &[("PART", part as f64)]);
                kept.draw(&mut encoder, pipeline.get_or_insert_with(compile), &bound);
                kept.copy(&mut encoder, part);
            }
            shared.queue.submit([encoder.finish()]);
            Ok(())
        };
        if let Err(error) = with_error_scope::<_, PrepareError>(device, record) {
            // They may be invalid.
            self.pipelines = Default::default();
            return Err(error);
        }
        self.requested = Some((size, Fetch::map(device, kept.buffer.clone())));
        self.kept = Some(kept);
        Ok(())
    }

    /// Returns whether values are on their way.
    pub fn is_requested(&self) -> bool {
        self.requested.is_some()
    }

    /// Forgets the values that are on their way.
    pub fn forget(&mut self) {
        if self.requested.take().is_some() {
            // Its buffer is in use until they arrive.
            self.kept = None;
        }
    }

    /// Reads the values that were requested. Returns `false` if they have not arrived, unless it `waits` for them.
    pub fn read(&mut self, waits: bool, read: impl FnOnce(&GridValues)) -> Result<bool> {
        let Some((size, fetch)) = self.requested.take() else { return Ok(false) };
        // It is lost with an error, after which its buffer may still be in use.
        let kept = self.kept.take();
        if waits {
            fetch.wait_until_arrived()?;
        }
        let has_arrived = waits || fetch.has_arrived()?;
        if has_arrived {
            fetch.read(|texels| read(&GridValues { size: size.into(), texels }))?;
        } else {
            self.requested = Some((size, fetch));
        }
        self.kept = kept;
        Ok(has_arrived)
    }
}

/// The resources of the program's slots.
fn resources<'a>(planner: &'a FramePlanner, textures: &'a Textures) -> [BindingResource<'a>; 6] {
    let shared = planner.shared;
    [
        shared.frame.as_entire_binding(),
        view(&textures.emission),
        view(&textures.tint_opacity),
        view(&textures.albedo),
        view(textures.glow.as_ref().unwrap_or(&shared.no_cookies)),
        planner.masks(),
    ]
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
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
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
