//! The grid as rays of lamps see it.

use crate::Result;
use crate::kernel::{Dispatch, Kernels, Slot};
use crate::shaders;
use crate::site::{ONE, Site, view, whole};
use wgpu::{Buffer, Device};

/// Cells along the side of a block, which is one word.
const BLOCK: u32 = 4;

/// The pipeline.
#[derive(Debug)]
pub struct Ground(Kernels);

/// What it leaves behind.
#[derive(Debug)]
pub struct Seen {
    /// What stands in each cell, two bits, a block to a word.
    pub kinds: Buffer,
    /// A number that every frame counts from 0.
    pub used: Buffer,
    pub read: Dispatch,
}

impl Ground {
    pub fn new(device: &Device) -> Self {
        use Slot::{Texture, Uniform, Write};
        Self(Kernels::new(
            device,
            &shaders::GROUND,
            &["main"],
            &[Uniform, Texture, Write, Write],
            &[],
        ))
    }

    pub fn plan(&self, site: &Site) -> Result<Seen> {
        let blocks = site.size.map(|side| side.div_ceil(BLOCK));
        let kinds = site.buffer("ground", u64::from(blocks[0]) * u64::from(blocks[1]) * ONE)?;
        let used = site.buffer("used", ONE)?;
        let resources = [view(&site.textures.tint_opacity), whole(&kinds), whole(&used)];
        let bound = site.bind(&self.0, &resources);
        let read = Dispatch::over(blocks, &self.0.entries[0], &bound, None);
        Ok(Seen { kinds, used, read })
    }
}
