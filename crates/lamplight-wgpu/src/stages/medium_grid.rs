//! The medium grid of `raymarch` and `cascades`.

use crate::compiler::Compiler;
use crate::error::Result;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::programs;
use lamplight::internals::MAX_OPTICAL_DEPTH;
use wgpu::Buffer;

/// The pipelines.
#[derive(Debug)]
pub struct MediumGridPipelines(ComputePipelines);

/// The buffers of the grid.
#[derive(Debug)]
pub struct MediumGrid {
    /// Emitted radiance of each cell, and its class.
    pub source: Buffer,
    /// Extinction per px.
    pub extinction: Buffer,
}

impl MediumGridPipelines {
    /// Compiles the pipelines. With `apart`, rays skip no two cells of media that scatter: squares are then
    /// right whatever the media are going to scatter.
    pub fn new(compiler: &Compiler, apart: bool) -> Self {
        let constants =
            [("MAX_OPTICAL_DEPTH", f64::from(MAX_OPTICAL_DEPTH)), ("APART", f64::from(apart))];
        Self(compiler.program(&programs::MEDIUM_GRID, &constants))
    }

    /// Creates the buffers.
    pub fn buffers(&self, planner: &FramePlanner) -> Result<MediumGrid> {
        Ok(MediumGrid {
            source: planner.buffer::<[f32; 4]>("source", planner.cells())?,
            extinction: planner.buffer::<[f32; 4]>("extinction", planner.cells())?,
        })
    }

    /// Plans reading the host's textures into the grid.
    pub fn read(&self, planner: &FramePlanner, grid: &MediumGrid, scattered: &Buffer) -> Dispatch {
        self.plan(planner, 0, grid, scattered)
    }

    /// Plans adding to the emission of media what they scatter.
    pub fn light_media(
        &self,
        planner: &FramePlanner,
        grid: &MediumGrid,
        scattered: &Buffer,
    ) -> Dispatch {
        self.plan(planner, 1, grid, scattered)
    }

    fn plan(
        &self,
        planner: &FramePlanner,
        entry: usize,
        grid: &MediumGrid,
        scattered: &Buffer,
    ) -> Dispatch {
        let resources = [
            view(&planner.textures.emission),
            view(&planner.textures.tint_opacity),
            whole(&grid.source),
            whole(&grid.extinction),
            whole(scattered),
            view(&planner.textures.albedo),
        ];
        planner.over_cells(&self.0, entry, &planner.bind(&self.0, &resources), None)
    }
}
