//! The inflow of a frame, as shaders/shared/inflow.wgsl and shaders/methods/holographic/border.wgsl read it.

use crate::error::Result;
use crate::grid_size::GridSize;
use crate::matter::{strips_texture, write_texels};
use lamplight::Inflow;
use lamplight::internals::inflow::border_cells;
use wgpu::{Device, Queue, TextureView};

/// Strips that lie one below the other; the next lie beside them.
pub const STRIPS: usize = 4096;

/// A texture with a strip of texels for each point along the border, a texel per column.
#[derive(Debug)]
pub struct InflowTexture {
    pub view: TextureView,
    size: [u32; 2],
    columns: u32,
    /// Border cells to a point: a strip is their mean.
    spacing: u32,
    written: Option<Inflow>,
}

impl InflowTexture {
    /// Creates the texture of an inflow, with points `spacing` cells apart.
    ///
    /// # Errors
    /// If the device has no texture that wide.
    pub fn new(device: &Device, inflow: &Inflow, spacing: u32) -> Result<Self> {
        let size = texture_size(inflow, spacing);
        let most = device.limits().max_texture_dimension_2d;
        if size[0] > most {
            let [width, height] = inflow.size();
            let what = "texels beside each other for the columns of its inflow";
            return Err(GridSize { width, height }.too_large(what, size[0].into(), most.into()));
        }
        let columns = inflow.columns() as u32;
        let view = strips_texture(device, size);
        Ok(Self { view, size: inflow.size(), columns, spacing, written: None })
    }

    /// Columns of a strip.
    pub fn columns(&self) -> u32 {
        self.columns
    }

    /// Returns whether an inflow is that of a grid of the same size, of as many columns, and points lie as far apart.
    pub fn holds(&self, inflow: &Inflow, spacing: u32) -> bool {
        let columns = self.columns as usize == inflow.columns();
        columns && (self.size, self.spacing) == (inflow.size(), spacing)
    }

    /// Writes an inflow, unless the texture has it already.
    pub fn write(&mut self, queue: &Queue, inflow: &Inflow) {
        if self.written.as_ref() != Some(inflow) {
            write_texels(queue, &self.view, &texels(inflow, self.spacing));
            self.written = Some(inflow.clone());
        }
    }

    /// The texels that were written last.
    pub fn texels(&self) -> Vec<[f32; 4]> {
        self.written.as_ref().map(|inflow| texels(inflow, self.spacing)).unwrap_or_default()
    }
}

/// Returns columns and rows of the texture of an inflow.
fn texture_size(inflow: &Inflow, spacing: u32) -> [u32; 2] {
    let strips = border_cells(inflow.size().map(|side| side.div_ceil(spacing)));
    [inflow.columns() * strips.div_ceil(STRIPS), strips.min(STRIPS)].map(|side| side as u32)
}

fn texels(inflow: &Inflow, spacing: u32) -> Vec<[f32; 4]> {
    let [width, height] = texture_size(inflow, spacing).map(|side| side as usize);
    let (columns, spacing) = (inflow.columns(), spacing as usize);
    let mut texels = vec![[0.0; 4]; width * height];
    let [w, h] = inflow.size().map(|side| side as usize);
    let (mut first, mut strip) = (0, 0);
    for side in [w, h, w, h] {
        for point in 0..side.div_ceil(spacing) {
            let at = strip % STRIPS * width + strip / STRIPS * columns;
            let texels = &mut texels[at..][..columns];
            for i in 0..spacing {
                // The last point of a side may have fewer cells.
                let cell = first + (spacing * point + i).min(side - 1);
                for (texel, radiance) in texels.iter_mut().zip(inflow.strip(cell)) {
                    (0..3).for_each(|c| texel[c] += radiance[c] / spacing as f32);
                }
            }
            strip += 1;
        }
        first += side;
    }
    texels
}
