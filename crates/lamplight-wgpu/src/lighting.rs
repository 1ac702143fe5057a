//! The middleware: what a host makes once, prepares and records every frame.

use crate::frame::Frame;
use crate::grid::{self, Grid};
use crate::kernel::Dispatch;
use crate::matter::{Textures, Upload};
use crate::pipelines::Pipelines;
use crate::plan::Plan;
use crate::{Error, Result};
use lamplight::settings::BounceBy;
use lamplight::{Bounces, Cells, Method, Settings, Sky};
use wgpu::{
    Buffer, CommandEncoder, ComputePassDescriptor, Device, Queue, TextureFormat, TextureUsages,
    TextureView,
};

/// Finds light on the host's device.
///
/// Pipelines are built by [`Self::new`], buffers by [`Self::prepare`] when the size of the grid
/// changes; in the steady state nothing is created. Any number of them can share a device.
#[derive(Debug)]
pub struct Lighting {
    settings: Settings,
    pipelines: Pipelines,
    grid: Option<Grid>,
    upload: Option<Upload>,
    output: Option<Dispatch>,
    number: u32,
}

/// What can be read back ([`crate::read_back`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Seed map, `u32` a cell; made by [`Lighting::record_fields`].
    Seeds,
    /// Voronoi map, `u32` a cell; made by [`Lighting::record_fields`].
    Nearest,
    /// Distance field, `f32` a cell, `f32::MAX` in a grid without matter; made by
    /// [`Lighting::record_fields`].
    Distance,
    /// Clear squares, four bytes a cell, one a quadrant.
    Clearance,
    /// The answer: four `f32` a cell, linear RGB and 1.
    Light,
}

impl Lighting {
    /// Checks the settings and builds the pipelines.
    pub fn new(device: &Device, queue: &Queue, settings: Settings) -> Result<Self> {
        check(&settings)?;
        let pipelines = Pipelines::new(device, queue, &settings);
        Ok(Self { settings, pipelines, grid: None, upload: None, output: None, number: 0 })
    }

    /// Takes over the cells of the next frame.
    pub fn prepare(&mut self, device: &Device, queue: &Queue, cells: &Cells) -> Result<()> {
        cells.check()?;
        self.settings.method.suits(cells)?;
        let size = [cells.width(), cells.height()];
        let upload = match self.upload.take() {
            Some(upload) if upload.textures.size()? == size => upload,
            _ => {
                // Before anything is made for it.
                grid::check(device, size, &self.settings)?;
                Upload::new(device, size)
            }
        };
        let upload = self.upload.insert(upload);
        upload.write(queue, &cells.drawn());
        let textures = upload.textures.clone();
        self.prepare_textures(device, queue, &textures, cells.sky())
    }

    /// Takes over the host's textures for the next frame. Views that are equal to those of the frame
    /// before cost nothing; others are bound anew.
    pub fn prepare_textures(
        &mut self,
        device: &Device,
        queue: &Queue,
        textures: &Textures,
        sky: Sky,
    ) -> Result<()> {
        sky.check()?;
        let grid = match self.grid.take() {
            Some(grid) if grid.textures == *textures => grid,
            _ => {
                // It belongs to other textures.
                self.output = None;
                Grid::new(device, textures.clone(), &self.pipelines, &self.settings)?
            }
        };
        let grid = self.grid.insert(grid);
        let frame = Frame::new(grid.size, sky, &self.settings, self.number);
        queue.write_buffer(&self.pipelines.constant.frame, 0, bytemuck::bytes_of(&frame));
        self.number = self.number.wrapping_add(1);
        Ok(())
    }

    /// Has [`Self::record`] write the light into a texture of the host's too, linear RGB and 1: of the
    /// format `Rgba16Float`, with the usage `STORAGE_BINDING`, as large as the grid last prepared. It
    /// stays so until textures change.
    pub fn write_to(&mut self, device: &Device, picture: &TextureView) -> Result<()> {
        let Some(grid) = &self.grid else {
            return Err(wrong_output("comes before the first cells or textures".into()));
        };
        let texture = picture.texture();
        if texture.format() != TextureFormat::Rgba16Float {
            let format = texture.format();
            return Err(wrong_output(format!("has the format {format:?}, not Rgba16Float")));
        }
        if !texture.usage().contains(TextureUsages::STORAGE_BINDING) {
            return Err(wrong_output("lacks the usage STORAGE_BINDING".into()));
        }
        let ([w, h], [width, height]) = ([texture.width(), texture.height()], grid.size);
        if [w, h] != grid.size {
            return Err(wrong_output(format!("is {w}×{h}, but the grid is {width}×{height}")));
        }
        let Grid { textures, buffers, .. } = grid;
        let plan = Plan { device, pipelines: &self.pipelines, textures, buffers };
        self.output = Some(plan.output(picture));
        Ok(())
    }

    /// Records what turns the cells last prepared into light; nothing before the first.
    pub fn record(&self, encoder: &mut CommandEncoder) {
        let frame = self.grid.iter().flat_map(|grid| &grid.frame);
        self.run(encoder, "lamplight", frame.chain(&self.output));
    }

    /// Records the seed map, jump flood and distance field of the cells last prepared, for hosts that
    /// want them; a frame that needs them makes them itself.
    pub fn record_fields(&self, encoder: &mut CommandEncoder) {
        self.run(encoder, "lamplight fields", self.grid.iter().flat_map(|grid| &grid.fields));
    }

    fn run<'a>(
        &'a self,
        encoder: &mut CommandEncoder,
        label: &str,
        runs: impl Iterator<Item = &'a Dispatch>,
    ) {
        let Some(grid) = &self.grid else { return };
        let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor {
            label: Some(label),
            timestamp_writes: None,
        });
        for dispatch in runs {
            dispatch.record(&mut pass, grid.size);
        }
    }

    /// Where a stage's result lies, row by row; none before the first [`Self::prepare`].
    pub fn stage(&self, stage: Stage) -> Option<&Buffer> {
        let Grid { size, buffers, .. } = self.grid.as_ref()?;
        Some(match stage {
            Stage::Seeds => &buffers.seeds,
            Stage::Nearest => buffers.nearest(*size),
            Stage::Distance => &buffers.distance,
            Stage::Clearance => buffers.squares(),
            Stage::Light => &buffers.light,
        })
    }
}

/// Refuses settings that are out of range, and what only the CPU can do so far.
pub fn check(settings: &Settings) -> Result<()> {
    settings.check()?;
    let missing = match () {
        () if settings.method != Method::Raymarch => {
            format!("the method {}", settings.method.name())
        }
        () if settings.bounces == Bounces::Converged => "`bounces` = converged".to_owned(),
        () if settings.bounces != Bounces::Count(0)
            && settings.raymarch.bounce == BounceBy::Feedback =>
        {
            "`raymarch.bounce` = feedback".to_owned()
        }
        () if settings.temporal.frames > 1 => "the mean over frames".to_owned(),
        () if settings.denoise.passes > 0 => "denoising".to_owned(),
        () => return Ok(()),
    };
    Err(Error::NotYet { what: missing })
}

fn wrong_output(problem: String) -> Error {
    Error::Texture { name: "output", problem }
}
