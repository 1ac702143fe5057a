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
        pub levels: u32,
        pub first: u32,
        pub far: u32,
        pub odd: [u32; 4],
        pub odd_first: [u32; 4],
        pub odd_top: u32,
        pub odd_top_first: u32,
        pub even: u32,
        pub even_first: u32,
        pub even_top: u32,
        pub even_top_first: u32,
        pub cones_above: u32,
        pub first_quadrant: u32,
        pub above: u32,
        pub below: u32,
        pub below_far: u32,
        pub halves: u32,
        pub cell_bits: u32,
        pub indirect: u32,
        pub gather_length: u32,
        pub footprints: u32,
        pub rays: u32,
        pub sky: u32,
        pub padding: [u32; 2],
    }
}

/// The sweeps of all dispatches, indexed by dynamic offset.
#[derive(Debug)]
pub struct Sweeps(Buffer);

impl Sweeps {
    pub fn new(planner: &FramePlanner, sweeps: &[Sweep]) -> Result<Self> {
        let mut bytes = vec![0; sweeps.len().max(1) * STEP_BYTES as usize];
        for (sweep, bytes) in sweeps.iter().zip(bytes.chunks_exact_mut(STEP_BYTES as usize)) {
            bytes[..size_of::<Sweep>()].copy_from_slice(bytemuck::bytes_of(sweep));
        }
        Ok(Self(planner.filled("sweeps", BufferUsages::UNIFORM, &bytes)?))
    }

    pub fn binding(&self) -> BindingResource<'_> {
        let size = NonZeroU64::new(size_of::<Sweep>() as u64);
        BindingResource::Buffer(BufferBinding { buffer: &self.0, offset: 0, size })
    }
}
