//! The middleware: what a host makes once, prepares and records every frame.

use crate::cost::Cost;
use crate::frame::{Frame, Memory};
use crate::kernel::Dispatch;
use crate::lamps::{Lamps, Room};
use crate::matter::{Textures, Upload};
use crate::methods;
use crate::options::Options;
use crate::shared::Shared;
use crate::site::{FOUR, Kept, Run, Site, fits};
use crate::stages::fields::Fields;
use crate::stages::output::Output;
use crate::stages::walls::Walls;
use crate::{Error, Result};
use lamplight::{Bounces, Cells, Lamp, Method, Settings, Sky};
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
    options: Options,
    shared: Shared,
    method: methods::Method,
    walls: Walls,
    output: Output,
    grid: Option<Grid>,
    upload: Option<Upload>,
    lamps: Vec<Lamp>,
    list: Lamps,
    number: u32,
    /// Size and sky of the frame before.
    before: Option<([u32; 2], Sky)>,
}

/// Everything that depends on the host's textures.
#[derive(Debug)]
struct Grid {
    size: [u32; 2],
    textures: Textures,
    tinted: bool,
    room: Room,
    light: Buffer,
    frame: Run,
    memory: u64,
    kept: Vec<Kept>,
    /// Made when they are first asked for.
    fields: Option<Run>,
    output: Option<Dispatch>,
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
    /// `raymarch`, `cascades`: clear squares, four bytes a cell, one a quadrant.
    Clearance,
    /// The answer: four `f32` a cell, linear RGB and 1.
    Light,
}

impl Lighting {
    /// Checks the settings and builds the pipelines.
    pub fn new(device: &Device, queue: &Queue, settings: Settings) -> Result<Self> {
        Self::with_options(device, queue, settings, Options::default())
    }

    /// The same, told how to go about it.
    pub fn with_options(
        device: &Device,
        queue: &Queue,
        settings: Settings,
        options: Options,
    ) -> Result<Self> {
        check(&settings)?;
        options.check()?;
        Ok(Self {
            shared: Shared::new(device, queue),
            method: methods::Method::new(device, queue, &settings)?,
            walls: Walls::new(device),
            output: Output::new(device),
            settings,
            options,
            grid: None,
            upload: None,
            lamps: Vec::new(),
            list: Lamps::default(),
            number: 0,
            before: None,
        })
    }

    /// Takes over the cells of the next frame. Each call is the next frame, to be recorded and
    /// submitted: noise moves on, history and feedback grow.
    pub fn prepare(&mut self, device: &Device, queue: &Queue, cells: &Cells) -> Result<()> {
        cells.check()?;
        self.settings.method.suits(cells)?;
        let size = [cells.width(), cells.height()];
        let upload = match self.upload.take() {
            Some(upload) if upload.textures.size()? == size => upload,
            _ => {
                // Before anything is made for it.
                fits(device, size)?;
                Upload::new(device, size)
            }
        };
        let upload = self.upload.insert(upload);
        if self.settings.method.lights_lamps() {
            upload.write(queue, cells);
        } else {
            upload.write(queue, &cells.drawn());
        }
        let textures = upload.textures.clone();
        self.lamps.clear();
        self.lamps.extend_from_slice(cells.lamps());
        let tinted = cells.tint().iter().any(|[r, g, b]| r != g || g != b);
        self.take_over(device, queue, (&textures, tinted), cells.sky())
    }

    /// Takes over the lamps that light the host's textures ([`Self::prepare_textures`]) from the next
    /// frame on, for the methods that light lamps by rule (`flood` and `polar`); for the others a lamp
    /// is what glows in the textures. [`Self::prepare`] takes those of its cells instead.
    pub fn set_lamps(&mut self, lamps: &[Lamp]) -> Result<()> {
        for (i, lamp) in lamps.iter().enumerate() {
            lamp.check(&format_args!("lamp[{i}]"))?;
        }
        self.lamps.clear();
        self.lamps.extend_from_slice(lamps);
        Ok(())
    }

    /// Takes over the host's textures for the next frame, as [`Self::prepare`] does with cells. Views
    /// that are equal to those of the frame before cost nothing; others are bound anew, and where
    /// their size is the same history goes on.
    pub fn prepare_textures(
        &mut self,
        device: &Device,
        queue: &Queue,
        textures: &Textures,
        sky: Sky,
    ) -> Result<()> {
        self.take_over(device, queue, (textures, true), sky)
    }

    fn take_over(
        &mut self,
        device: &Device,
        queue: &Queue,
        (textures, tinted): (&Textures, bool),
        sky: Sky,
    ) -> Result<()> {
        sky.check()?;
        self.settings.method.suits_lamps(&self.lamps)?;
        self.method.take(&self.lamps, textures.size()?, &self.settings, &mut self.list);
        let need = self.list.need();
        let before = self.before.take();
        let grid = match self.grid.take() {
            Some(grid)
                if grid.textures == *textures && grid.tinted == tinted && grid.room.holds(need) =>
            {
                grid
            }
            grid => self.plan(device, (textures, tinted), grid)?,
        };
        let grid = self.grid.insert(grid);
        if let Some(lamps) = &grid.frame.lamps {
            self.list.write(queue, lamps);
        }
        let memory = match before {
            Some((size, _)) if size != grid.size => Memory::Nothing,
            Some((_, old)) if self.settings.temporal.reject && old != sky => Memory::Sent,
            Some(_) => Memory::All,
            None => Memory::Nothing,
        };
        self.before = Some((grid.size, sky));
        let frame = Frame::new(grid.size, sky, &self.settings, self.number, memory);
        queue.write_buffer(&self.shared.frame, 0, bytemuck::bytes_of(&frame));
        self.number = self.number.wrapping_add(1);
        Ok(())
    }

    /// Makes buffers, and plans what runs on them. What frames hand on stays where only the host's
    /// textures change; where only lamps have become too many, what the host was told of too: the
    /// light, and where else it is written.
    fn plan(
        &mut self,
        device: &Device,
        (textures, tinted): (&Textures, bool),
        before: Option<Grid>,
    ) -> Result<Grid> {
        let had = before.as_ref().map_or(Room::default(), |grid| grid.room);
        let size = textures.size()?;
        let kept = before.as_ref().filter(|grid| grid.size == size);
        let kept = kept.map_or(Vec::new(), |grid| grid.kept.clone());
        let Self { shared, settings, options, list, .. } = self;
        let site = Site::new(device, shared, settings, *options, (textures, tinted))?
            .with_room(had, list.need())?
            .after(&kept);
        let (light, fields, output) = match before.filter(|grid| grid.textures == *textures) {
            Some(Grid { light, fields, output, .. }) => (site.counted(light), fields, output),
            None => (site.buffer("light", site.cells() * FOUR)?, None, None),
        };
        let mut frame = self.method.plan(&site, &light)?;
        frame.dispatches.extend(self.walls.plan(&site, &light)?);
        let (room, memory) = (site.room, site.memory());
        let (textures, kept) = (textures.clone(), site.into_kept());
        Ok(Grid { size, textures, tinted, room, light, frame, memory, kept, fields, output })
    }

    /// Forgets the frames before: the next one starts afresh, as after a cut or a jump of the view.
    pub fn reset(&mut self) {
        self.number = 0;
        self.before = None;
    }

    /// Has [`Self::record`] write the light into a texture of the host's too, linear RGB and 1: of the
    /// format `Rgba16Float`, with the usage `STORAGE_BINDING`, as large as the grid last prepared. It
    /// stays so until textures change.
    pub fn write_to(&mut self, device: &Device, picture: &TextureView) -> Result<()> {
        let Some(grid) = &mut self.grid else {
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
        let matter = (&grid.textures, grid.tinted);
        let site = Site::new(device, &self.shared, &self.settings, self.options, matter)?;
        grid.output = Some(self.output.plan(&site, &grid.light, picture));
        Ok(())
    }

    /// Records what turns the cells last prepared into light; nothing before the first.
    pub fn record(&self, encoder: &mut CommandEncoder) {
        let Some(grid) = &self.grid else { return };
        run(encoder, "lamplight", grid.frame.dispatches.iter().chain(&grid.output));
    }

    /// Records the seed map, jump flood and distance field of the cells last prepared, for hosts that
    /// want them; a frame that needs them makes them itself. The first time it makes their pipelines
    /// and buffers.
    pub fn record_fields(&mut self, device: &Device, encoder: &mut CommandEncoder) -> Result<()> {
        let Some(grid) = &mut self.grid else { return Ok(()) };
        let fields = match grid.fields.take() {
            Some(fields) => fields,
            None => {
                let matter = (&grid.textures, grid.tinted);
                let site = Site::new(device, &self.shared, &self.settings, self.options, matter)?;
                Fields::new(device).plan(&site)?.run
            }
        };
        run(encoder, "lamplight fields", grid.fields.insert(fields).dispatches.iter());
        Ok(())
    }

    /// Where a stage's result lies, row by row; none where the method does not make it, and before the
    /// first [`Self::prepare`].
    pub fn stage(&self, stage: Stage) -> Option<&Buffer> {
        let Grid { frame, fields, .. } = self.grid.as_ref()?;
        let mut stages = frame.stages.iter().chain(fields.iter().flat_map(|run| &run.stages));
        stages.find(|(name, _)| *name == stage).map(|(_, buffer)| buffer)
    }

    /// What a frame of the grid last prepared takes; nothing before the first.
    pub fn cost(&self) -> Option<Cost> {
        let grid = self.grid.as_ref()?;
        Some(Cost::new(grid.frame.dispatches.iter().chain(&grid.output), grid.memory))
    }
}

fn run<'a>(
    encoder: &mut CommandEncoder,
    label: &str,
    dispatches: impl Iterator<Item = &'a Dispatch>,
) {
    let descriptor = ComputePassDescriptor { label: Some(label), timestamp_writes: None };
    let mut pass = encoder.begin_compute_pass(&descriptor);
    dispatches.for_each(|dispatch| dispatch.record(&mut pass));
}

/// Refuses settings that are out of range, and what only the CPU can do so far.
pub fn check(settings: &Settings) -> Result<()> {
    settings.check()?;
    let converged = settings.bounces == Bounces::Converged;
    let missing = match settings.method {
        Method::Cascades | Method::Holographic if converged => {
            "`bounces` = converged, but by raymarch,"
        }
        _ => return Ok(()),
    };
    Err(Error::NotYet { what: missing.to_owned() })
}

fn wrong_output(problem: String) -> Error {
    Error::Texture { name: "output", problem }
}
