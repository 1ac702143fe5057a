//! Edge-aware blur.

use crate::Result;
use crate::kernel::{Dispatch, Kernels, Slot};
use crate::shaders;
use crate::site::{FOUR, Site, view, whole};
use lamplight::Settings;
use lamplight::settings::Hit;
use lamplight::stages::clearance::LONGEST;
use lamplight::stages::denoise::{DEVIATIONS, KERNEL, OPACITY};
use lamplight::stages::distance::MARGIN;
use wgpu::{Buffer, Device};

/// The pipelines.
#[derive(Debug)]
pub struct Denoise(Kernels);

impl Denoise {
    pub fn new(device: &Device, settings: &Settings) -> Self {
        use Slot::{Read, Step, Texture, Uniform, Write};
        let slots = [Uniform, Step, Texture, Read, Read, Read, Write, Write];
        let by_distance = settings.raymarch.hit == Hit::Distance;
        let constants = [
            ("LONGEST", f64::from(LONGEST)),
            ("MARGIN", f64::from(MARGIN)),
            ("KERNEL_0", f64::from(KERNEL[0])),
            ("KERNEL_1", f64::from(KERNEL[1])),
            ("KERNEL_2", f64::from(KERNEL[2])),
            ("DEVIATIONS", f64::from(DEVIATIONS * settings.denoise.strength)),
            ("OPACITY", f64::from(OPACITY)),
            ("BY_DISTANCE", f64::from(by_distance)),
        ];
        let constants = [&constants[..], &shaders::LUMINANCE].concat();
        let entries = ["begin", "blur", "finish"];
        Self(Kernels::new(device, &shaders::DENOISE, &entries, &slots, &constants))
    }

    /// Blurs the light of open cells; `near` is what rays went by: clear squares or distances.
    pub fn plan(
        &self,
        site: &Site,
        near: &Buffer,
        traced: &Buffer,
        light: &Buffer,
    ) -> Result<Vec<Dispatch>> {
        let noisy = site.pair("denoise", site.cells() * FOUR)?;
        let bind = |to: usize| {
            let resources = [
                site.shared.step(),
                view(&site.textures.tint_opacity),
                whole(near),
                whole(traced),
                whole(&noisy[1 - to]),
                whole(&noisy[to]),
                whole(light),
            ];
            site.bind(&self.0, &resources)
        };
        Ok(site.ping_pong(&self.0, [bind(0), bind(1)], site.settings.denoise.passes))
    }
}
