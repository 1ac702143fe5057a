//! The host's device, and buffers that are the same for every grid.

use crate::compiler::Compiler;
use crate::matter::{cookies_texture, masks_texture, strips_texture, write_masks};
use crate::pipeline::STEP_BYTES;
use crate::tier::has_compute;
use crate::uniforms::FrameUniforms;
use lamplight::ALL_LAYERS;
use wgpu::{
    BindingResource, Buffer, BufferBinding, BufferDescriptor, BufferUsages, Device, Queue,
    TextureView,
};

/// The number of steps that a dispatch can select.
const STEPS: u32 = 66;

/// The device and buffers that all methods share.
#[derive(Debug)]
pub struct Shared {
    /// True if the device has compute shaders.
    pub has_compute: bool,
    pub compiler: Compiler,
    pub device: Device,
    pub queue: Queue,
    /// [`FrameUniforms`], written before each frame.
    pub frame: Buffer,
    /// One texel, for grids whose cells are all in all layers.
    pub all_layers: TextureView,
    /// One texel, for skies that are no panorama.
    pub no_panorama: TextureView,
    /// One texel, for lamps without cookies.
    pub no_cookies: TextureView,
    steps: Buffer,
}

impl Shared {
    pub fn new(compiler: Compiler, queue: &Queue) -> Self {
        let device = &compiler.device;
        let mut steps = vec![0; (STEPS * STEP_BYTES) as usize];
        for (number, bytes) in (0u32..).zip(steps.chunks_exact_mut(STEP_BYTES as usize)) {
            bytes[..4].copy_from_slice(&number.to_ne_bytes());
        }
        let frame = [0; size_of::<FrameUniforms>()];
        let all_layers = masks_texture(device, [1, 1]);
        write_masks(queue, &all_layers, &[ALL_LAYERS]);
        Self {
            has_compute: has_compute(device),
            device: device.clone(),
            queue: queue.clone(),
            frame: filled(device, queue, "frame", BufferUsages::UNIFORM, &frame),
            all_layers,
            no_panorama: strips_texture(device, [1, 1]),
            no_cookies: cookies_texture(device, [1, 1]),
            steps: filled(device, queue, "steps", BufferUsages::UNIFORM, &steps),
            compiler,
        }
    }

    /// The number of a step, selected by each dispatch.
    pub fn step(&self) -> BindingResource<'_> {
        self.number(0)
    }

    /// The number of a step, fixed.
    pub fn number(&self, number: u32) -> BindingResource<'_> {
        let (offset, size) = (u64::from(number * STEP_BYTES), std::num::NonZeroU64::new(4));
        BindingResource::Buffer(BufferBinding { buffer: &self.steps, offset, size })
    }
}

/// Creates a buffer with contents.
pub fn filled(
    device: &Device,
    queue: &Queue,
    label: &str,
    usage: BufferUsages,
    contents: &[u8],
) -> Buffer {
    let buffer = device.create_buffer(&BufferDescriptor {
        label: Some(label),
        size: contents.len() as u64,
        usage: usage | BufferUsages::COPY_DST | BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    queue.write_buffer(&buffer, 0, contents);
    buffer
}
