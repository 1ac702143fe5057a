//! What a dispatch is told of its quadrant and its group of levels.

use crate::Result;
use crate::kernel::STEP_BYTES;
use crate::site::Site;
use bytemuck::{Pod, Zeroable};
#[cfg(test)]
use std::mem::offset_of;
use std::num::NonZeroU64;
use wgpu::{BindingResource, Buffer, BufferBinding, BufferUsages};

/// `Sweep` of shaders/sweep.wgsl, where its fields are explained.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
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
    pub cones_top: u32,
    pub begins: u32,
    pub cones: [u32; 4],
    pub above: u32,
    pub below: u32,
    pub below_far: u32,
    pub below_planes: u32,
    pub bits: u32,
    pub sends: u32,
    pub least: u32,
    pub ways: u32,
    pub rays: u32,
    pub padding: [u32; 3],
}

impl Sweep {
    /// Fields in order, with where they begin.
    #[cfg(test)]
    pub const OFFSETS: [(&'static str, usize); 28] = [
        ("depth", offset_of!(Sweep, depth)),
        ("rows", offset_of!(Sweep, rows)),
        ("axis", offset_of!(Sweep, axis)),
        ("reversed", offset_of!(Sweep, reversed)),
        ("level", offset_of!(Sweep, level)),
        ("levels", offset_of!(Sweep, levels)),
        ("first", offset_of!(Sweep, first)),
        ("far", offset_of!(Sweep, far)),
        ("odd", offset_of!(Sweep, odd)),
        ("odd_first", offset_of!(Sweep, odd_first)),
        ("odd_top", offset_of!(Sweep, odd_top)),
        ("odd_top_first", offset_of!(Sweep, odd_top_first)),
        ("even", offset_of!(Sweep, even)),
        ("even_first", offset_of!(Sweep, even_first)),
        ("even_top", offset_of!(Sweep, even_top)),
        ("even_top_first", offset_of!(Sweep, even_top_first)),
        ("cones_top", offset_of!(Sweep, cones_top)),
        ("begins", offset_of!(Sweep, begins)),
        ("cones", offset_of!(Sweep, cones)),
        ("above", offset_of!(Sweep, above)),
        ("below", offset_of!(Sweep, below)),
        ("below_far", offset_of!(Sweep, below_far)),
        ("below_planes", offset_of!(Sweep, below_planes)),
        ("bits", offset_of!(Sweep, bits)),
        ("sends", offset_of!(Sweep, sends)),
        ("least", offset_of!(Sweep, least)),
        ("ways", offset_of!(Sweep, ways)),
        ("rays", offset_of!(Sweep, rays)),
    ];
}

/// The sweeps of all dispatches; each is told which by its place.
#[derive(Debug)]
pub struct Sweeps(Buffer);

impl Sweeps {
    pub fn new(site: &Site, sweeps: &[Sweep]) -> Result<Self> {
        let mut bytes = vec![0; sweeps.len().max(1) * STEP_BYTES as usize];
        for (sweep, bytes) in sweeps.iter().zip(bytes.chunks_exact_mut(STEP_BYTES as usize)) {
            bytes[..size_of::<Sweep>()].copy_from_slice(bytemuck::bytes_of(sweep));
        }
        Ok(Self(site.filled("sweeps", BufferUsages::UNIFORM, &bytes)?))
    }

    pub fn binding(&self) -> BindingResource<'_> {
        let size = NonZeroU64::new(size_of::<Sweep>() as u64);
        BindingResource::Buffer(BufferBinding { buffer: &self.0, offset: 0, size })
    }
}
