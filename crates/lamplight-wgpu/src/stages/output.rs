//! The light as a texture of the host's.

use crate::compiler::Compiler;
use crate::matter::MAX_HALF;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::programs;
use wgpu::{Buffer, TextureView};

/// The pipeline.
#[derive(Debug)]
pub struct Output(ComputePipelines);

impl Output {
    pub fn new(compiler: &Compiler) -> Self {
        let constants = [("MAX_HALF", f64::from(MAX_HALF))];
        Self(compiler.program(&programs::OUTPUT, &constants))
    }

    /// Plans writing `light` to `picture`.
    pub fn plan(&self, planner: &FramePlanner, light: &Buffer, picture: &TextureView) -> Dispatch {
        let bound = planner.bind(&self.0, &[whole(light), view(picture)]);
        planner.over_cells(&self.0, 0, &bound, None)
    }
}
