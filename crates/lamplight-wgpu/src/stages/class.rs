//! The classes of cells, packed for rays of lamps.

use crate::compiler::Compiler;
use crate::error::Result;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, view, whole};
use crate::programs;
use wgpu::Buffer;

/// Side, in cells, of a block whose classes share a word.
const BLOCK: u32 = 4;

/// The pipeline.
#[derive(Debug)]
pub struct ClassPipeline(ComputePipelines);

/// The result of the stage.
#[derive(Debug)]
pub struct Classes {
    /// The class of each cell, two bits, a block per word.
    pub classes: Buffer,
    /// A counter that starts at 0 in every frame.
    pub used: Buffer,
    pub dispatch: Dispatch,
}

impl ClassPipeline {
    pub fn new(compiler: &Compiler) -> Self {
        Self(compiler.program(&programs::CLASS, &[]))
    }

    /// Plans the classification.
    pub fn plan(&self, planner: &FramePlanner) -> Result<Classes> {
        let blocks = <[u32; 2]>::from(planner.size).map(|side| side.div_ceil(BLOCK));
        let words = u64::from(blocks[0]) * u64::from(blocks[1]);
        let classes = planner.buffer::<u32>("classes", words)?;
        let used = planner.buffer::<u32>("used", 1)?;
        let resources = [view(&planner.textures.tint_opacity), whole(&classes), whole(&used)];
        let bound = planner.bind(&self.0, &resources);
        let dispatch = Dispatch::over(blocks, self.0.entry(0), &bound, None);
        Ok(Classes { classes, used, dispatch })
    }
}
