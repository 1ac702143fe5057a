//! The seed map.

use crate::compiler::Compiler;
use crate::error::Result;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::programs;
use lamplight::internals::seed::NONE;
use wgpu::Buffer;

/// The pipeline.
#[derive(Debug)]
pub struct Seed(ComputePipelines);

impl Seed {
    pub fn new(compiler: &Compiler) -> Self {
        let constants = [("NO_SEED", f64::from(NONE))];
        Self(compiler.program(&programs::SEED, &constants))
    }

    /// Plans the seed map.
    pub fn plan(&self, planner: &FramePlanner) -> Result<(Buffer, Dispatch)> {
        let seeds = planner.buffer::<u32>("seeds", planner.cells())?;
        let resources = [view(&planner.textures.tint_opacity), whole(&seeds)];
        let bound = planner.bind(&self.0, &resources);
        Ok((seeds, planner.over_cells(&self.0, 0, &bound, None)))
    }
}
