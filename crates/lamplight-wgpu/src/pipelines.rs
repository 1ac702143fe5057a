//! What is made once for all grids: compiled shaders and constant buffers.

use crate::frame::Frame;
use crate::kernel::{Kernels, STEP_BYTES, STEPS, Slot};
use crate::{constants, shaders};
use lamplight::Settings;
use lamplight::methods::raymarch::directions;
use lamplight::settings::Hit;
use lamplight::stages::noise;
use wgpu::{BindingResource, Buffer, BufferBinding, BufferDescriptor, BufferUsages, Device, Queue};

/// Everything that does not depend on the size of the grid.
#[derive(Debug)]
pub struct Pipelines {
    pub seed: Kernels,
    pub jump_flood: Kernels,
    pub distance: Kernels,
    pub optics: Kernels,
    pub clearance: Kernels,
    pub raymarch: Kernels,
    pub walls: Kernels,
    pub output: Kernels,
    pub constant: Constant,
}

/// Buffers that are the same for every grid.
#[derive(Debug)]
pub struct Constant {
    pub frame: Buffer,
    steps: Buffer,
    pub blue: Buffer,
    pub directions: Buffer,
}

impl Constant {
    /// The number of a step; which one is said when it runs.
    pub fn step(&self) -> BindingResource<'_> {
        let size = std::num::NonZeroU64::new(4);
        BindingResource::Buffer(BufferBinding { buffer: &self.steps, offset: 0, size })
    }
}

impl Pipelines {
    /// Compiles what these settings need.
    pub fn new(device: &Device, queue: &Queue, settings: &Settings) -> Self {
        use Slot::{Picture, Read, Step, Texture, Uniform, Write};
        let filled = |label, usage, bytes: &[u8]| {
            let buffer = device.create_buffer(&BufferDescriptor {
                label: Some(label),
                size: bytes.len() as u64,
                usage: usage | BufferUsages::COPY_DST,
                mapped_at_creation: false,
            });
            queue.write_buffer(&buffer, 0, bytes);
            buffer
        };
        let mut steps = vec![0; (STEPS * STEP_BYTES) as usize];
        for (number, bytes) in (0u32..).zip(steps.chunks_exact_mut(STEP_BYTES as usize)) {
            bytes[..4].copy_from_slice(&number.to_ne_bytes());
        }
        let directions: Vec<[f32; 2]> = directions(&settings.raymarch).collect();
        let constant = Constant {
            frame: filled("frame", BufferUsages::UNIFORM, &[0; size_of::<Frame>()]),
            steps: filled("steps", BufferUsages::UNIFORM, &steps),
            blue: filled("blue noise", BufferUsages::STORAGE, noise::blue()),
            directions: filled(
                "directions",
                BufferUsages::STORAGE,
                bytemuck::cast_slice(&directions),
            ),
        };
        let kernels = |shader, entries: &[&str], slots: &[Slot], constants: &[_]| {
            Kernels::new(device, shader, entries, slots, constants)
        };
        Self {
            seed: kernels(&shaders::SEED, &["main"], &[Uniform, Texture, Write], constants::SEED),
            jump_flood: kernels(
                &shaders::JUMP_FLOOD,
                &["main"],
                &[Uniform, Step, Read, Write],
                constants::SEED,
            ),
            distance: kernels(
                &shaders::DISTANCE,
                &["main"],
                &[Uniform, Read, Write],
                constants::DISTANCE,
            ),
            optics: kernels(
                &shaders::OPTICS,
                &["main", "light_fog"],
                &[Uniform, Texture, Texture, Write, Write, Read],
                constants::OPTICS,
            ),
            clearance: kernels(
                &shaders::CLEARANCE,
                &["begin", "double", "finish"],
                &[Uniform, Step, Read, Read, Read, Write],
                constants::CLEARANCE,
            ),
            raymarch: kernels(
                match settings.raymarch.hit {
                    Hit::Edge => &shaders::RAYMARCH,
                    Hit::Distance => &shaders::RAYMARCH_DISTANCE,
                },
                &["main", "receive"],
                &[Uniform, Read, Read, Read, Read, Read, Read, Step, Texture, Write],
                &constants::raymarch(settings.raymarch.hit),
            ),
            walls: kernels(
                &shaders::WALLS,
                &["begin", "sink", "finish"],
                &[Uniform, Step, Texture, Read, Read, Write, Write],
                &[],
            ),
            output: kernels(
                &shaders::OUTPUT,
                &["main"],
                &[Uniform, Read, Picture],
                constants::OUTPUT,
            ),
            constant,
        }
    }
}
