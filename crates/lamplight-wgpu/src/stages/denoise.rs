//! The edge-aware blur.

use crate::compiler::Compiler;
use crate::error::Result;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::{programs, shaders};
use lamplight::internals::denoise::{
    DEVIATIONS, KERNEL, TRANSMITTANCE, WALL_REACH, WALL_SPREAD, WIDE_DEVIATIONS,
};
use lamplight::internals::distance::MARGIN;
use lamplight::internals::empty_space::LONGEST;
use lamplight::settings::{Hit, Raymarch};
use wgpu::Buffer;

/// The pipelines.
#[derive(Debug)]
pub struct Denoise {
    pipelines: ComputePipelines,
    passes: u32,
}

impl Denoise {
    pub fn new(compiler: &Compiler, settings: &Raymarch, moment: bool) -> Self {
        let by_distance = settings.hit == Hit::Distance;
        let constants = [
            ("MAX_SKIP", f64::from(LONGEST)),
            ("MARGIN", f64::from(MARGIN)),
            ("KERNEL_0", f64::from(KERNEL[0])),
            ("KERNEL_1", f64::from(KERNEL[1])),
            ("KERNEL_2", f64::from(KERNEL[2])),
            ("DEVIATIONS", f64::from(DEVIATIONS * settings.denoise.strength)),
            ("WIDE_DEVIATIONS", f64::from(WIDE_DEVIATIONS * settings.denoise.strength)),
            ("TRANSMITTANCE", f64::from(TRANSMITTANCE)),
            ("WALL_SPREAD", WALL_SPREAD as f64),
            ("WALL_REACH", WALL_REACH as f64),
            ("BY_DISTANCE", f64::from(by_distance)),
            shaders::moment(moment),
        ];
        let constants = [&constants[..], &shaders::LUMINANCE].concat();
        let pipelines = compiler.program(&programs::DENOISE, &constants);
        Self { pipelines, passes: settings.denoise.passes }
    }

    /// Plans the blur of the light of all cells. `near` is the field that rays go by: squares of empty space,
    /// or distances.
    pub fn plan(
        &self,
        planner: &FramePlanner,
        near: &Buffer,
        traced: &Buffer,
        light: &Buffer,
    ) -> Result<Vec<Dispatch>> {
        let noisy = planner.pair::<[f32; 4]>("denoise", planner.light_values())?;
        let bind = |to: usize| {
            let resources = [
                planner.shared.step(),
                view(&planner.textures.tint_opacity),
                whole(near),
                whole(traced),
                whole(&noisy[1 - to]),
                whole(&noisy[to]),
                whole(light),
            ];
            planner.bind(&self.pipelines, &resources)
        };
        Ok(planner.ping_pong(&self.pipelines, [bind(0), bind(1)], self.passes))
    }
}
