//! The inflow of a frame, as shaders/shared/inflow.wgsl reads it.

use crate::error::Result;
use crate::grid_size::GridSize;
use crate::matter::{strips_texture, write_texels};
use lamplight::Inflow;
use lamplight::internals::inflow::border_cells;
use wgpu::{Device, Queue, TextureView};

/// Strips that lie one below the other; the next lie beside them.
pub const STRIPS: usize = 4096;

/// A texture with a strip of texels for each border cell, a texel per column.
#[derive(Debug)]
pub struct InflowTexture {
    pub view: TextureView,
    size: [u32; 2],
    columns: u32,
    written: Option<Inflow>,
}

impl InflowTexture {
    /// Creates the texture of an inflow.
    ///
    /// # Errors
    /// If the device has no texture that wide.
    pub fn new(device: &Device, inflow: &Inflow) -> Result<Self> {
        let size = texture_size(inflow);
        let most = device.limits().max_texture_dimension_2d;
        if size[0] > most {
            let [width, height] = inflow.size();
            let what = "texels beside each other for the columns of its inflow";
            return Err(GridSize { width, height }.too_large(what, size[0].into(), most.into()));
        }
        let columns = inflow.columns() as u32;
        let view = strips_texture(device, size);
        Ok(Self { view, size: inflow.size(), columns, written: None })
    }

    /// Columns of a strip.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Returns whether an inflow is that of a grid of the same size, of as many columns.
    pub fn holds(&self, inflow: &Inflow) -> bool {
        self.size == inflow.size() && self.columns as usize == inflow.columns()
    }

    /// Writes an inflow, unless the texture has it already.
    pub fn write(&mut self, queue: &Queue, inflow: &Inflow) {
        if self.written.as_ref() != Some(inflow) {
            write_texels(queue, &self.view, &texels(inflow));
            self.written = Some(inflow.clone());
        }
    }

    /// The texels that were written last.
    pub fn texels(&self) -> Vec<[f32; 4]> {
        self.written.as_ref().map(texels).unwrap_or_default()
    }
}

/// Returns columns and rows of the texture of an inflow.
fn texture_size(inflow: &Inflow) -> [u32; 2] {
    let strips = border_cells(inflow.size());
    [inflow.columns() * strips.div_ceil(STRIPS), strips.min(STRIPS)].map(|side| side as u32)
}

fn texels(inflow: &Inflow) -> Vec<[f32; 4]> {
    let [width, height] = texture_size(inflow).map(|side| side as usize);
    let (columns, strips) = (inflow.columns(), border_cells(inflow.size()));
    let mut texels = vec![[0.0; 4]; width * height];
    for strip in 0..strips {
        let at = strip % STRIPS * width + strip / STRIPS * columns;
        for (texel, &[r, g, b]) in texels[at..].iter_mut().zip(inflow.strip(strip)) {
            *texel = [r, g, b, 0.0];
        }
    }
    texels
}
