//! Reprojection of history when the grid moves over the world.

use crate::error::Result;
use crate::pipeline::{ComputePipelines, Dispatch};
use crate::planner::{FramePlanner, HistoryBuffer, whole};
use crate::programs;
use wgpu::Device;

/// The pipelines.
#[derive(Debug)]
pub struct Reproject(ComputePipelines);

impl Reproject {
    pub fn new(device: &Device) -> Self {
        Self(ComputePipelines::new(device, &programs::REPROJECT, &[]))
    }

    /// Plans the move of all history, buffer by buffer: to a copy, and back to the present place of each cell.
    pub fn plan(&self, planner: &FramePlanner, history: &[HistoryBuffer]) -> Result<Vec<Dispatch>> {
        let mut dispatches = Vec::new();
        for HistoryBuffer { label, buffer } in history {
            let words = buffer.size() / (planner.cells() * size_of::<u32>() as u64);
            let copy = planner.buffer_of_bytes(label, buffer.size())?;
            for (entry, [from, to]) in [[buffer, &copy], [&copy, buffer]].into_iter().enumerate() {
                let resources = [planner.shared.step(), whole(from), whole(to)];
                let bound = planner.bind(&self.0, &resources);
                dispatches.push(planner.over_cells(&self.0, entry, &bound, Some(words as u32)));
            }
        }
        Ok(dispatches)
    }
}
