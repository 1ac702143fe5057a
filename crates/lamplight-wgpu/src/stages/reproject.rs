//! Reprojection of history when the grid moves over the world, or changes its size.

use crate::compiler::Compiler;
use crate::error::Result;
use crate::grid_size::GridSize;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, HistoryBuffer, scattered_of, whole};
use crate::programs;
use wgpu::Buffer;

/// The entry of [`programs::REPROJECT`] that copies to the present place of each cell.
const BACK: usize = 1;

/// The pipelines.
#[derive(Debug)]
pub struct Reproject(ComputePipelines);

impl Reproject {
    pub fn new(compiler: &Compiler) -> Self {
        Self(compiler.program(&programs::REPROJECT, &[]))
    }

    /// Plans the move of all history, buffer by buffer: to a copy, and back to the present place of each cell.
    pub fn plan(&self, planner: &FramePlanner, history: &[HistoryBuffer]) -> Result<Vec<Dispatch>> {
        let mut dispatches = Vec::new();
        for HistoryBuffer { label, buffer } in history {
            let words = words(buffer, planner.size);
            let copy = planner.buffer_of_bytes(label, buffer.size())?;
            for (entry, [from, to]) in [[buffer, &copy], [&copy, buffer]].into_iter().enumerate() {
                dispatches.push(self.copy(planner, entry, words, [from, to]));
            }
        }
        Ok(dispatches)
    }

    /// Plans the move of scattered radiance from a grid of another size, if both have it in the same form. Other
    /// history ends there, as on the CPU.
    pub fn plan_resized(
        &self,
        planner: &FramePlanner,
        (size_before, before): (GridSize, &[HistoryBuffer]),
        now: &[HistoryBuffer],
    ) -> Option<Dispatch> {
        let (from, to) = (scattered_of(before)?, scattered_of(now)?);
        let [old, new] = [words(from, size_before), words(to, planner.size)];
        (old == new).then(|| self.copy(planner, BACK, new, [from, to]))
    }

    /// Plans copying `words` per cell.
    fn copy(
        &self,
        planner: &FramePlanner,
        entry: usize,
        words: u64,
        [from, to]: [&Buffer; 2],
    ) -> Dispatch {
        let resources = [planner.shared.step(), whole(from), whole(to)];
        let bound = planner.bind(&self.0, &resources);
        planner.over_cells(&self.0, entry, &bound, Some(words as u32))
    }
}

/// Words per cell of a history buffer.
fn words(buffer: &Buffer, size: GridSize) -> u64 {
    buffer.size() / (size.cells() * size_of::<u32>() as u64)
}
