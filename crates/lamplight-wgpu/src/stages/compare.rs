//! The change of scattered radiance in a bounce, over four faces per cell.

use crate::compiler::Compiler;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, whole};
use crate::programs;
use wgpu::Buffer;

/// The pipeline.
#[derive(Debug)]
pub struct Compare(ComputePipelines);

impl Compare {
    pub fn new(compiler: &Compiler) -> Self {
        Self(compiler.program(&programs::COMPARE, &[]))
    }

    /// Plans the replacement of `scattered` radiance by that of the `next` bounce, and the measurement of the
    /// change. In step 0, the first bounce, there is no scattered radiance before.
    pub fn plan(
        &self,
        planner: &FramePlanner,
        next: &Buffer,
        scattered: &Buffer,
        changes: &Buffer,
        step: u32,
    ) -> Dispatch {
        let resources = [planner.shared.step(), whole(next), whole(scattered), whole(changes)];
        planner.over_cells(&self.0, 0, &planner.bind(&self.0, &resources), Some(step))
    }
}
