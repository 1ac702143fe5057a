//! The matter of the host's textures as numbers, for the CPU.

use crate::error::Result;
use crate::error_scope::with_error_scope;
use crate::fetch::read_back;
use crate::grid_size::GridSize;
use crate::matter::Textures;
use crate::pipeline::ComputePipelines;
use crate::planner::{FramePlanner, view, whole};
use crate::programs;
use wgpu::Buffer;

/// Vectors per cell.
const VECTORS: u64 = 4;

/// The matter of a cell, as the shader writes it.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct CellValues {
    pub emission: [f32; 4],
    /// Tint, and in the last place the opacity.
    pub tint_opacity: [f32; 4],
    /// Albedo, and in the last place the layers ÷ 255.
    pub albedo_layers: [f32; 4],
    /// The emission coefficient.
    pub glow: [f32; 4],
}

/// The pipeline, and the buffer of the last grid.
#[derive(Debug)]
pub struct MatterValues {
    pipelines: ComputePipelines,
    buffer: Option<(GridSize, Buffer)>,
}

impl MatterValues {
    pub fn new(planner: &FramePlanner) -> Result<Self> {
        with_error_scope(planner.device, || {
            let pipelines = planner.shared.compiler.program(&programs::MATTER_VALUES, &[]);
            Ok(Self { pipelines, buffer: None })
        })
    }

    /// Reads the textures as they are now, after everything that was submitted before. Waits for them.
    pub fn read(&mut self, planner: &FramePlanner, textures: &Textures) -> Result<Vec<CellValues>> {
        let FramePlanner { device, shared, size, .. } = *planner;
        let kept = self.buffer.take().filter(|(known, _)| *known == size);
        let buffer = match kept {
            Some((_, buffer)) => buffer,
            None => with_error_scope(device, || {
                planner.buffer::<[f32; 4]>("matter values", VECTORS * planner.cells())
            })?,
        };
        let resources = [
            view(&textures.emission),
            view(&textures.tint_opacity),
            view(&textures.albedo),
            view(textures.glow.as_ref().unwrap_or(&shared.no_cookies)),
            planner.masks(),
            whole(&buffer),
        ];
        let record = || -> Result<()> {
            let bound = planner.bind(&self.pipelines, &resources);
            let mut encoder = device.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_compute_pass(&Default::default());
            planner.over_cells(&self.pipelines, 0, &bound, None).record(&mut pass);
            drop(pass);
            shared.queue.submit([encoder.finish()]);
            Ok(())
        };
        with_error_scope(device, record)?;
        let values = read_back(device, &shared.queue, &buffer)?;
        self.buffer = Some((size, buffer));
        Ok(values)
    }
}
