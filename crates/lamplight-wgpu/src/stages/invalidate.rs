//! Cells whose matter changed since the frame before, which invalidate history.

use super::medium_grid::MediumGrid;
use crate::compiler::Compiler;
use crate::error::Result;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::programs;
use wgpu::Buffer;

/// The pipelines.
#[derive(Debug)]
pub struct Invalidate(ComputePipelines);

impl Invalidate {
    pub fn new(compiler: &Compiler) -> Self {
        Self(compiler.program(&programs::INVALIDATE, &[]))
    }

    /// Plans marks in the medium grid. Returns a number that is 1 if any cell changed.
    pub fn plan(
        &self,
        planner: &FramePlanner,
        grid: &MediumGrid,
    ) -> Result<(Buffer, [Dispatch; 2])> {
        let hashes = planner.history::<[u32; 2]>("matter before", planner.cells())?;
        let any = planner.buffer::<u32>("any change", 1)?;
        let resources = [
            view(&planner.textures.emission),
            view(&planner.textures.tint_opacity),
            view(&planner.textures.albedo),
            whole(&hashes),
            whole(&grid.extinction),
            whole(&any),
        ];
        let bound = planner.bind(&self.0, &resources);
        let begin = Dispatch::new(self.0.entry(0), &bound, None, [1, 1, 1]);
        Ok((any, [begin, planner.over_cells(&self.0, 1, &bound, None)]))
    }
}
