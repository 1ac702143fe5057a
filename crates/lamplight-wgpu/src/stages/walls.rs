//! Light that sinks into walls.

use crate::Result;
use crate::kernel::{Dispatch, Kernels, Slot};
use crate::shaders;
use crate::site::{ONE, Site, view, whole};
use wgpu::{Buffer, Device};

/// The pipelines.
#[derive(Debug)]
pub struct Walls(Kernels);

impl Walls {
    pub fn new(device: &Device) -> Self {
        use Slot::{Read, Step, Texture, Uniform, Write};
        let slots = [Uniform, Texture, Step, Texture, Read, Write, Write];
        Self(Kernels::new(device, &shaders::WALLS, &["begin", "sink", "finish"], &slots, &[]))
    }

    pub fn plan(&self, site: &Site, light: &Buffer) -> Result<Vec<Dispatch>> {
        let rings = site.pair("walls", site.cells() * ONE)?;
        let bind = |to: usize| {
            let resources = [
                view(&site.textures.tint_opacity),
                site.shared.step(),
                view(&site.textures.emission),
                whole(&rings[1 - to]),
                whole(&rings[to]),
                whole(light),
            ];
            site.bind(&self.0, &resources)
        };
        let depth = site.settings.wall_depth.ceil() as u32;
        Ok(site.ping_pong(&self.0, [bind(0), bind(1)], depth))
    }
}
