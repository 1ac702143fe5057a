//! Matter that changed since the frame before.

use super::optics::Seen;
use crate::Result;
use crate::kernel::{Dispatch, Kernels, Slot};
use crate::shaders;
use crate::site::{ONE, Site, view, whole};
use wgpu::{Buffer, Device};

/// The pipelines.
#[derive(Debug)]
pub struct Changes(Kernels);

impl Changes {
    pub fn new(device: &Device) -> Self {
        use Slot::{Texture, Uniform, Write};
        let slots = [Uniform, Texture, Texture, Texture, Write, Write, Write];
        Self(Kernels::new(device, &shaders::CHANGES, &["begin", "main"], &slots, &[]))
    }

    /// Marks the cells that changed in what is seen; gives a number that is 1 where any has.
    pub fn plan(&self, site: &Site, seen: &Seen) -> Result<(Buffer, [Dispatch; 2])> {
        let hashes = site.kept("matter before", site.cells() * 2 * ONE)?;
        let any = site.buffer("any change", ONE)?;
        let resources = [
            view(&site.textures.emission),
            view(&site.textures.tint_opacity),
            view(&site.textures.albedo),
            whole(&hashes),
            whole(&seen.logs),
            whole(&any),
        ];
        let bound = site.bind(&self.0, &resources);
        let begin = Dispatch::new(&self.0.entries[0], &bound, None, [1, 1, 1]);
        Ok((any, [begin, site.over_cells(&self.0, 1, &bound, None)]))
    }
}
