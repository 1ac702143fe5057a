//! Bounces by feedback: what surfaces sent on in the frame before.

use super::optics::Seen;
use crate::kernel::{Dispatch, Kernels, Slot};
use crate::shaders;
use crate::site::{Site, view, whole};
use wgpu::{Buffer, Device};

/// The pipeline.
#[derive(Debug)]
pub struct Feedback(Kernels);

impl Feedback {
    pub fn new(device: &Device) -> Self {
        use Slot::{Read, Texture, Uniform, Write};
        let slots = [Uniform, Texture, Read, Read, Write];
        Self(Kernels::new(device, &shaders::FEEDBACK, &["main"], &slots, &[]))
    }

    /// Takes over what was sent `before` by surfaces that still send.
    pub fn take_over(&self, site: &Site, seen: &Seen, before: &Buffer, sent: &Buffer) -> Dispatch {
        let resources =
            [view(&site.textures.albedo), whole(&seen.source), whole(before), whole(sent)];
        site.over_cells(&self.0, 0, &site.bind(&self.0, &resources), None)
    }
}
