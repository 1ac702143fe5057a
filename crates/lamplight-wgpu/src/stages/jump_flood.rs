//! The jump flood: the nearest seed of every cell.

use crate::compiler::Compiler;
use crate::error::Result;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, whole};
use crate::programs;
use lamplight::internals::jump_flood::passes;
use lamplight::internals::seed::NONE;
use wgpu::Buffer;

/// Passes of offset 1 after the jump flood, where the CPU goes on until nothing changes. It needed at most 4
/// over the example scenes and 9 over 400 random grids of up to 400 px a side. With fewer, single cells would
/// find a seed that is not quite the nearest.
const SETTLING: u32 = 12;

/// The pipeline.
#[derive(Debug)]
pub struct JumpFlood(ComputePipelines);

impl JumpFlood {
    pub fn new(compiler: &Compiler) -> Self {
        let constants = [("NO_SEED", f64::from(NONE))];
        Self(compiler.program(&programs::JUMP_FLOOD, &constants))
    }

    /// Plans all passes from a seed map on. Returns the buffer that the last one writes.
    pub fn plan(&self, planner: &FramePlanner, seeds: &Buffer) -> Result<(Buffer, Vec<Dispatch>)> {
        let halves = planner.pair::<u32>("jump flood", planner.cells())?;
        let [width, height] = planner.size.into();
        let mut before = seeds;
        let mut dispatches = Vec::new();
        let offsets = (0..passes(width, height)).rev().chain((0..SETTLING).map(|_| 0));
        for (i, offset) in offsets.enumerate() {
            let nearest = &halves[i % 2];
            let resources = [planner.shared.step(), whole(before), whole(nearest)];
            let bound = planner.bind(&self.0, &resources);
            dispatches.push(planner.over_cells(&self.0, 0, &bound, Some(offset)));
            before = nearest;
        }
        Ok((before.clone(), dispatches))
    }
}
