//! What frames hand on, carried along when the grid moves over the world.

use crate::Result;
use crate::kernel::{Dispatch, Kernels, Slot};
use crate::shaders;
use crate::site::{Kept, ONE, Site, whole};
use wgpu::Device;

/// The pipelines.
#[derive(Debug)]
pub struct Carry(Kernels);

impl Carry {
    pub fn new(device: &Device) -> Self {
        use Slot::{Read, Step, Uniform, Write};
        let slots = [Uniform, Step, Read, Write];
        Self(Kernels::new(device, &shaders::CARRY, &["aside", "back"], &slots, &[]))
    }

    /// Carries everything that is kept, buffer by buffer: aside, and back to where its cells are now.
    pub fn plan(&self, site: &Site, kept: &[Kept]) -> Result<Vec<Dispatch>> {
        let mut dispatches = Vec::new();
        for (label, buffer) in kept {
            let words = (buffer.size() / (site.cells() * ONE)) as u32;
            let aside = site.buffer(label, buffer.size())?;
            for (entry, [from, to]) in [[buffer, &aside], [&aside, buffer]].into_iter().enumerate()
            {
                let bound = site.bind(&self.0, &[site.shared.step(), whole(from), whole(to)]);
                dispatches.push(site.over_cells(&self.0, entry, &bound, Some(words)));
            }
        }
        Ok(dispatches)
    }
}
