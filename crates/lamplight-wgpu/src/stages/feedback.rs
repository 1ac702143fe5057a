//! Bounces by feedback: the scattered radiance of the frame before.

use super::medium_grid::MediumGrid;
use crate::compiler::Compiler;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::programs;
use wgpu::Buffer;

/// The pipeline.
#[derive(Debug)]
pub struct Feedback(ComputePipelines);

impl Feedback {
    pub fn new(compiler: &Compiler) -> Self {
        Self(compiler.program(&programs::FEEDBACK, &[]))
    }

    /// Plans a copy of the scattered radiance of the frame `before`, where the same scatterer is still there.
    pub fn plan(
        &self,
        planner: &FramePlanner,
        grid: &MediumGrid,
        before: &Buffer,
        scattered: &Buffer,
    ) -> Dispatch {
        let resources =
            [view(&planner.textures.albedo), whole(&grid.source), whole(before), whole(scattered)];
        planner.over_cells(&self.0, 0, &planner.bind(&self.0, &resources), None)
    }
}
