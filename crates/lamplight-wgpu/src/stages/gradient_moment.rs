//! The first moment of light by its gradient, for methods that find no light by direction.

use crate::compiler::Compiler;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::{programs, shaders};
use lamplight::internals::gradient_moment::HALF;
use wgpu::Buffer;

/// The pipeline.
#[derive(Debug)]
pub struct GradientMoment(ComputePipelines);

impl GradientMoment {
    pub fn new(compiler: &Compiler) -> Self {
        let constants = [&[("HALF", f64::from(HALF))][..], &shaders::LUMINANCE].concat();
        Self(compiler.program(&programs::GRADIENT_MOMENT, &constants))
    }

    /// Plans the moment of open cells from the light of all.
    pub fn plan(&self, planner: &FramePlanner, light: &Buffer) -> Dispatch {
        let resources = [view(&planner.textures.tint_opacity), whole(light)];
        let bound = planner.bind(&self.0, &resources);
        planner.over_cells(&self.0, 0, &bound, None)
    }
}
