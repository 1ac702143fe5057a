//! Parameters of a dispatch: its quadrant and its group of levels.

use crate::error::Result;
use crate::gpu_struct::gpu_struct;
use crate::pipeline::STEP_BYTES;
use crate::planner::FramePlanner;
use std::num::NonZeroU64;
use wgpu::{BindingResource, Buffer, BufferBinding, BufferUsages};

gpu_struct! {
    /// `Sweep` of shaders/methods/holographic/sweep.wgsl, where the fields are explained.
    pub struct Sweep {
        pub depth: u32,
        pub rows: u32,
        pub axis: u32,
        pub reversed: u32,
        pub level: u32,
        pub first: u32,
        pub far: u32,
        pub odd: u32,
        pub even: u32,
        pub stored: u32,
        pub odd_top: u32,
        pub even_top: u32,
        pub stored_top: u32,
        pub cones_above: u32,
        pub cones_between: u32,
        pub above: u32,
        pub between: u32,
        pub below: u32,
        pub below_far: u32,
        pub turn: u32,
        pub cell_bits: u32,
        pub indirect: u32,
        pub gather_length: u32,
        pub footprints: u32,
        pub rays: u32,
        pub sky: u32,
        pub quadrants: u32,
        pub planes: u32,
        pub spacing_level: u32,
        pub cell_depth: u32,
        pub cell_rows: u32,
        pub cell_words: u32,
    }
}

/// The most quadrants that share a dispatch.
pub const QUADRANTS: usize = 4;
/// The turn of the last of them, as `sweep.wgsl` has it.
pub const LAST_TURN: u32 = QUADRANTS as u32 - 1;

/// The sweeps of the quadrants of a dispatch.
pub type Together = [Sweep; QUADRANTS];

/// Steps of the dynamic offset from one dispatch to the next.
pub const STEPS: u32 = (size_of::<Together>() as u32).div_ceil(STEP_BYTES);

/// The sweeps of all dispatches, indexed by dynamic offset.
#[derive(Debug)]
pub struct Sweeps {
    buffer: Buffer,
    /// Bytes that a dispatch reads.
    size: NonZeroU64,
}

impl Sweeps {
    /// Stores `N` sweeps of each dispatch.
    pub fn new<const N: usize>(planner: &FramePlanner, sweeps: &[[Sweep; N]]) -> Result<Self> {
        let size = size_of::<[Sweep; N]>();
        let stride = size.next_multiple_of(STEP_BYTES as usize);
        let mut bytes = vec![0; sweeps.len().max(1) * stride];
        for (sweeps, bytes) in sweeps.iter().zip(bytes.chunks_exact_mut(stride)) {
            bytes[..size].copy_from_slice(bytemuck::cast_slice(sweeps));
        }
        let buffer = planner.filled("sweeps", BufferUsages::UNIFORM, &bytes)?;
        Ok(Self { buffer, size: NonZeroU64::new(size as u64).unwrap_or(NonZeroU64::MIN) })
    }

    pub fn binding(&self) -> BindingResource<'_> {
        let (buffer, size) = (&self.buffer, Some(self.size));
        BindingResource::Buffer(BufferBinding { buffer, offset: 0, size })
    }
}
