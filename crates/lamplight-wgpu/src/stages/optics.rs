//! The grid as rays of `raymarch` and `cascades` see it.

use crate::Result;
use crate::kernel::{Dispatch, Kernels, Slot};
use crate::shaders;
use crate::site::{FOUR, Site, view, whole};
use lamplight::stages::transmittance::LOG_OF_ZERO;
use wgpu::{Buffer, Device};

/// The pipelines.
#[derive(Debug)]
pub struct Optics(Kernels);

/// What it leaves behind.
#[derive(Debug)]
pub struct Seen {
    /// Red, green, blue that cells give off, and what they are.
    pub source: Buffer,
    /// Logarithm of what a px lets through.
    pub logs: Buffer,
}

impl Optics {
    /// With `apart`, rays leap over no two cells of fog that sends light on: squares are then right
    /// whatever it sends.
    pub fn new(device: &Device, apart: bool) -> Self {
        use Slot::{Read, Texture, Uniform, Write};
        let slots = [Uniform, Texture, Texture, Write, Write, Read, Texture];
        let constants = [("LOG_OF_ZERO", f64::from(LOG_OF_ZERO)), ("APART", f64::from(apart))];
        Self(Kernels::new(device, &shaders::OPTICS, &["main", "light_fog"], &slots, &constants))
    }

    pub fn buffers(&self, site: &Site) -> Result<Seen> {
        let bytes = site.cells() * FOUR;
        Ok(Seen {
            source: site.buffer("source", bytes)?,
            logs: site.buffer("log transmittance", bytes)?,
        })
    }

    /// Reads the grid.
    pub fn read(&self, site: &Site, seen: &Seen, sent: &Buffer) -> Dispatch {
        self.run(site, 0, seen, sent)
    }

    /// Adds what fog sends on.
    pub fn light_fog(&self, site: &Site, seen: &Seen, sent: &Buffer) -> Dispatch {
        self.run(site, 1, seen, sent)
    }

    fn run(&self, site: &Site, entry: usize, seen: &Seen, sent: &Buffer) -> Dispatch {
        let resources = [
            view(&site.textures.emission),
            view(&site.textures.tint_opacity),
            whole(&seen.source),
            whole(&seen.logs),
            whole(sent),
            view(&site.textures.albedo),
        ];
        site.over_cells(&self.0, entry, &site.bind(&self.0, &resources), None)
    }
}
