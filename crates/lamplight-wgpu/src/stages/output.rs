//! The light as a picture of the host's.

use crate::kernel::{Dispatch, Kernels, Slot};
use crate::shaders;
use crate::site::{Site, view, whole};
use wgpu::{Buffer, Device, TextureView};

/// The largest half float.
const BRIGHTEST: f32 = 65504.0;

/// The pipeline.
#[derive(Debug)]
pub struct Output(Kernels);

impl Output {
    pub fn new(device: &Device) -> Self {
        use Slot::{Picture, Read, Uniform};
        let constants = [("BRIGHTEST", f64::from(BRIGHTEST))];
        Self(Kernels::new(
            device,
            &shaders::OUTPUT,
            &["main"],
            &[Uniform, Read, Picture],
            &constants,
        ))
    }

    pub fn plan(&self, site: &Site, light: &Buffer, picture: &TextureView) -> Dispatch {
        let bound = site.bind(&self.0, &[whole(light), view(picture)]);
        site.over_cells(&self.0, 0, &bound, None)
    }
}
