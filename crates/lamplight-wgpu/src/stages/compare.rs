//! How much a round changed of what surfaces send on, four faces a cell.

use crate::kernel::{Dispatch, Kernels, Slot};
use crate::shaders;
use crate::site::{Site, whole};
use wgpu::{Buffer, Device};

/// The pipeline.
#[derive(Debug)]
pub struct Compare(Kernels);

impl Compare {
    pub fn new(device: &Device) -> Self {
        use Slot::{Read, Step, Uniform, Write};
        let slots = [Uniform, Step, Read, Write, Write];
        Self(Kernels::new(device, &shaders::COMPARE, &["main"], &slots, &[]))
    }

    /// Colours `received` with those `sent` in the round before, which they replace; more than 0 in
    /// the fourth place where a surface is. In the first round, step 0, nothing was sent before.
    pub fn run(
        &self,
        site: &Site,
        [received, sent]: [&Buffer; 2],
        found: &Buffer,
        step: u32,
    ) -> Dispatch {
        let resources = [site.shared.step(), whole(received), whole(sent), whole(found)];
        site.over_cells(&self.0, 0, &site.bind(&self.0, &resources), Some(step))
    }
}
