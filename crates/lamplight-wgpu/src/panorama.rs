//! The panorama of a frame, as shaders/shared/sky.wgsl reads it.

use crate::matter::{strips_texture, write_texels};
use lamplight::{Panorama, Sky};
use wgpu::{Device, Queue, TextureView};

/// A texture with a texel per column.
#[derive(Debug)]
pub struct PanoramaTexture {
    pub view: TextureView,
    written: Option<Panorama>,
}

impl PanoramaTexture {
    pub fn new(device: &Device, panorama: &Panorama) -> Self {
        let columns = panorama.columns().len() as u32;
        Self { view: strips_texture(device, [columns, 1]), written: None }
    }

    /// Returns whether a panorama has as many columns.
    pub fn holds(&self, panorama: &Panorama) -> bool {
        self.view.texture().width() as usize == panorama.columns().len()
    }

    /// Writes a sky that is a panorama, unless the texture has it already.
    pub fn write(&mut self, queue: &Queue, sky: &Sky) {
        let Sky::Panorama(panorama) = sky else { return };
        if self.written.as_ref() != Some(panorama) {
            write_texels(queue, &self.view, &texels(panorama));
            self.written = Some(panorama.clone());
        }
    }

    /// The texels that were written last.
    pub fn texels(&self) -> Vec<[f32; 4]> {
        self.written.as_ref().map(texels).unwrap_or_default()
    }
}

fn texels(panorama: &Panorama) -> Vec<[f32; 4]> {
    panorama.columns().iter().map(|&[r, g, b]| [r, g, b, 0.0]).collect()
}
