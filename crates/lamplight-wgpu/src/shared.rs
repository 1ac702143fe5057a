//! Buffers that are the same for every grid.

use crate::frame::Frame;
use crate::kernel::STEP_BYTES;
use wgpu::{BindingResource, Buffer, BufferBinding, BufferDescriptor, BufferUsages, Device, Queue};

/// Steps that a kernel may be told.
const STEPS: u32 = 66;

/// What all methods share.
#[derive(Debug)]
pub struct Shared {
    pub queue: Queue,
    /// [`Frame`], written before each frame.
    pub frame: Buffer,
    steps: Buffer,
}

impl Shared {
    pub fn new(device: &Device, queue: &Queue) -> Self {
        let mut steps = vec![0; (STEPS * STEP_BYTES) as usize];
        for (number, bytes) in (0u32..).zip(steps.chunks_exact_mut(STEP_BYTES as usize)) {
            bytes[..4].copy_from_slice(&number.to_ne_bytes());
        }
        let frame = [0; size_of::<Frame>()];
        Self {
            queue: queue.clone(),
            frame: filled(device, queue, "frame", BufferUsages::UNIFORM, &frame),
            steps: filled(device, queue, "steps", BufferUsages::UNIFORM, &steps),
        }
    }

    /// The number of a step; which one is said when it runs.
    pub fn step(&self) -> BindingResource<'_> {
        self.number(0)
    }

    /// This number, one of the steps'.
    pub fn number(&self, number: u32) -> BindingResource<'_> {
        let (offset, size) = (u64::from(number * STEP_BYTES), std::num::NonZeroU64::new(4));
        BindingResource::Buffer(BufferBinding { buffer: &self.steps, offset, size })
    }
}

/// A buffer with something in it.
pub fn filled(
    device: &Device,
    queue: &Queue,
    label: &str,
    usage: BufferUsages,
    bytes: &[u8],
) -> Buffer {
    let buffer = device.create_buffer(&BufferDescriptor {
        label: Some(label),
        size: bytes.len() as u64,
        usage: usage | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    queue.write_buffer(&buffer, 0, bytes);
    buffer
}
