//! Empty-space skipping: squares of equal cells.

use super::medium_grid::MediumGrid;
use crate::compiler::Compiler;
use crate::error::Result;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, whole};
use crate::programs;
use lamplight::internals::empty_space::{LONGEST, MATTER};
use wgpu::Buffer;

/// The pipelines.
#[derive(Debug)]
pub struct EmptySpace(ComputePipelines);

impl EmptySpace {
    pub fn new(compiler: &Compiler) -> Self {
        let constants = [("MAX_SKIP", f64::from(LONGEST)), ("HAS_MEDIUM", f64::from(MATTER))];
        Self(compiler.program(&programs::EMPTY_SPACE, &constants))
    }

    /// Plans the squares. Returns their buffer and the dispatches that fill it.
    pub fn plan(
        &self,
        planner: &FramePlanner,
        grid: &MediumGrid,
    ) -> Result<(Buffer, Vec<Dispatch>)> {
        let squares = planner.pair::<u32>("squares", planner.cells())?;
        let bind = |to: usize| {
            let resources = [
                planner.shared.step(),
                whole(&grid.source),
                whole(&grid.extinction),
                whole(&squares[1 - to]),
                whole(&squares[to]),
            ];
            planner.bind(&self.0, &resources)
        };
        // All powers of two up to the longest side are doubled, except the last.
        let doublings = LONGEST.ilog2();
        let dispatches = planner.ping_pong(&self.0, [bind(0), bind(1)], doublings);
        let last = ((doublings + 1) % 2) as usize;
        Ok((squares[last].clone(), dispatches))
    }
}
