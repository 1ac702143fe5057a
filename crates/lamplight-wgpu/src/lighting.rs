//! The middleware: what a host makes once, prepares and records every frame.

use crate::compiled::{Compiled, alike};
use crate::cost::Cost;
use crate::frame::{Frame, Memory, Place};
use crate::guarded::guarded;
use crate::kernel::Dispatch;
use crate::known::Known;
use crate::lamps::{Lamps, Room};
use crate::matter::{self, Textures, Upload};
use crate::methods;
use crate::options::Options;
use crate::shared::Shared;
use crate::site::{FOUR, Kept, Run, Site, fits};
use crate::stages::carry::Carry;
use crate::stages::fields::Fields;
use crate::stages::output::Output;
use crate::stages::walls::Walls;
use crate::timing::Timer;
use crate::{Error, Result};
use lamplight::{Cells, Lamp, Settings, Sky};
use std::sync::Arc;
use wgpu::{
    Buffer, CommandEncoder, ComputePassDescriptor, Device, Queue, TextureFormat, TextureUsages,
    TextureView,
};

/// Finds light on the host's device.
///
/// Pipelines are built by [`Self::new`], buffers by [`Self::prepare`] when the size of the grid
/// changes; in the steady state nothing is created. Any number of them can share a device; each stays
/// with the device and the queue it was made with.
///
/// What a device refuses while things are made, such as a texture of another device, comes back as
/// [`Error::Device`]; in a browser, where it says so only later, it goes to the host's handler of
/// uncaptured errors. So do a queue of another device and a texture that was destroyed, which show
/// themselves only when they are used, in every frame. A texture of another [`wgpu::Instance`] cannot
/// be told from one of this. A device that was lost does nothing: prepare and record go on as if it
/// were there, and [`crate::read_back`] gives an error.
#[derive(Debug)]
pub struct Lighting {
    settings: Settings,
    options: Options,
    shared: Shared,
    compiled: Compiled,
    method: Arc<methods::Method>,
    walls: Walls,
    carry: Carry,
    output: Output,
    grid: Option<Grid>,
    /// What other settings made of it, until the next frame is prepared.
    next: Option<Grid>,
    upload: Option<Upload>,
    lamps: Vec<Lamp>,
    list: Lamps,
    origin: [i32; 2],
    number: u32,
    /// Size, origin and sky of the frame before.
    before: Option<([u32; 2], [i32; 2], Sky)>,
}

/// What there is to show.
pub struct Lit<'a> {
    pub size: [u32; 2],
    pub textures: &'a Textures,
    pub light: &'a Buffer,
    pub frame: &'a Buffer,
}

/// Everything that depends on the host's textures.
#[derive(Debug)]
struct Grid {
    size: [u32; 2],
    textures: Textures,
    known: Known,
    room: Room,
    light: Buffer,
    frame: Run,
    memory: u64,
    kept: Vec<Kept>,
    /// Moves what is kept along with the grid; made when that first moves.
    carry: Option<Vec<Dispatch>>,
    /// Whether it has moved since the frame before.
    moved: bool,
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

impl Grid {
    /// What a frame runs, in order.
    fn dispatches(&self) -> impl Iterator<Item = &Dispatch> {
        let carry = self.carry.iter().flatten().filter(|_| self.moved);
        carry.chain(&self.frame.dispatches).chain(&self.output)
    }
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
        settings.check()?;
        options.check()?;
        let mut compiled = Compiled::default();
        let method = compiled.method(device, queue, &settings)?;
        guarded(device, || {
            Ok(Self {
                shared: Shared::new(device, queue),
                compiled,
                method,
                walls: Walls::new(device),
                carry: Carry::new(device),
                output: Output::new(device),
                settings,
                options,
                grid: None,
                next: None,
                upload: None,
                lamps: Vec::new(),
                list: Lamps::default(),
                origin: [0; 2],
                number: 0,
                before: None,
            })
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
                guarded(device, || Upload::new(device, size))?
            }
        };
        let upload = self.upload.insert(upload);
        upload.write(queue, cells, !self.settings.method.lights_lamps());
        let textures = upload.textures.clone();
        self.lamps.clear();
        self.lamps.extend_from_slice(cells.lamps());
        let known = Known::of(cells, self.settings.bounces);
        self.take_over(device, queue, (&textures, known), cells.sky())
    }

    /// Takes over the lamps that light the host's textures ([`Self::prepare_textures`]) from the next
    /// frame on, for the methods that light lamps by rule (`flood` and `polar`); for the others a lamp
    /// is what glows in the textures. Without any, they find no light of lamps. [`Self::prepare`] takes
    /// those of its cells instead.
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
        self.take_over(device, queue, (textures, Known::NOTHING), sky)
    }

    fn take_over(
        &mut self,
        device: &Device,
        queue: &Queue,
        (textures, known): (&Textures, Known),
        sky: Sky,
    ) -> Result<()> {
        sky.check()?;
        self.method.take(&self.lamps, textures.size()?, &self.settings, &mut self.list);
        let need = self.list.need();
        let serves = |grid: &Grid| {
            grid.textures == *textures && grid.known.serves(known) && grid.room.holds(need)
        };
        let planned = self.next.as_ref().or(self.grid.as_ref());
        let fresh = match planned.is_some_and(serves) {
            true => None,
            false => Some(self.plan(device, (textures, known), planned)?),
        };
        let taken = fresh.as_ref().or(self.next.as_ref());
        if let Some(lamps) = taken.or(self.grid.as_ref()).and_then(|grid| grid.frame.lamps.as_ref())
        {
            match taken {
                // A device that was lost says now that there is no such buffer.
                Some(_) => guarded(device, || {
                    self.list.write(queue, lamps);
                    Ok(())
                })?,
                None => self.list.write(queue, lamps),
            }
        }
        let next = self.next.take();
        self.grid = fresh.or(next).or(self.grid.take());
        let Some(grid) = &mut self.grid else { return Ok(()) };
        let (memory, from) = match self.before {
            Some((size, origin, ref old)) if size == grid.size => {
                let other = self.settings.temporal.reject && *old != sky;
                (if other { Memory::Sent } else { Memory::All }, origin)
            }
            _ => (Memory::Nothing, self.origin),
        };
        let moved = [0, 1].map(|a| self.origin[a].saturating_sub(from[a]));
        grid.moved = moved != [0; 2];
        if grid.moved && grid.carry.is_none() {
            let matter = (&grid.textures, grid.known);
            let site = Site::new(device, &self.shared, &self.settings, self.options, matter)?;
            grid.carry = Some(guarded(device, || self.carry.plan(&site, &grid.kept))?);
            grid.memory += site.memory();
        }
        self.before = Some((grid.size, self.origin, sky));
        let place = Place { size: grid.size, origin: self.origin, moved };
        let frame = Frame::new(place, sky, &self.settings, self.number, memory);
        queue.write_buffer(&self.shared.frame, 0, bytemuck::bytes_of(&frame));
        self.number = self.number.wrapping_add(1);
        Ok(())
    }

    /// Says which cell of the host's world is the grid's left and top one ([`crate::Placed::origin`]),
    /// from the next frame prepared on: noise then stays with the world when the grid moves over it, and
    /// with it the light. What is left is rounding: a cell in ten thousand has a ray that passes a corner
    /// within a millionth of a px, on the other side. What frames hand on moves along; what comes into the
    /// grid starts afresh. (0, 0) at first.
    pub fn set_origin(&mut self, origin: [i32; 2]) {
        self.origin = origin;
    }

    /// Makes buffers, and plans what runs on them. While the size is the same, what frames hand on stays,
    /// and the light too: until the next frame it is still there to show.
    fn plan(
        &self,
        device: &Device,
        (textures, known): (&Textures, Known),
        before: Option<&Grid>,
    ) -> Result<Grid> {
        let had = before.map_or(Room::default(), |grid| grid.room);
        let size = textures.size()?;
        let before = before.filter(|grid| grid.size == size);
        let Self { shared, settings, options, list, .. } = self;
        guarded(device, || {
            let site = Site::new(device, shared, settings, *options, (textures, known))?
                .with_room(had, list.need())?
                .after(before.map_or(&[], |grid| &grid.kept));
            let (light, output) = match before {
                Some(grid) => (site.counted(grid.light.clone()), grid.output.clone()),
                None => (site.buffer("light", site.cells() * FOUR)?, None),
            };
            let mut frame = self.method.plan(&site, &light)?;
            frame.dispatches.extend(self.walls.plan(&site, &light)?);
            let (room, memory) = (site.room, site.memory());
            let (textures, kept) = (textures.clone(), site.into_kept());
            Ok(Grid {
                size,
                textures,
                known,
                room,
                light,
                frame,
                memory,
                kept,
                carry: None,
                moved: false,
                fields: None,
                output,
            })
        })
    }

    /// Forgets the frames before: the next one starts afresh, as after a cut or a jump of the view.
    pub fn reset(&mut self) {
        self.number = 0;
        self.before = None;
    }

    /// The settings at hand.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Builds the pipelines of settings that are to come, so that [`Self::set_settings`] need not when they
    /// do, in the middle of a game. Those of the sixteen settings announced or used last are kept.
    pub fn precompile(
        &mut self,
        device: &Device,
        queue: &Queue,
        settings: &Settings,
    ) -> Result<()> {
        settings.check()?;
        self.compiled.method(device, queue, settings)?;
        Ok(())
    }

    /// Takes over other settings, from the next frame prepared on; one that is prepared already is recorded
    /// as it is. The cells or textures last prepared stay, and so does what was recorded before. Free where nothing changes but the seed; another depth of walls
    /// makes buffers, anything else pipelines too, which takes as long as [`Self::new`], where these
    /// settings were not used before or announced ([`Self::precompile`]).
    ///
    /// After an error everything is as before.
    pub fn set_settings(
        &mut self,
        device: &Device,
        queue: &Queue,
        settings: Settings,
    ) -> Result<()> {
        settings.check()?;
        let planned =
            alike(&settings, &self.settings) && settings.wall_depth == self.settings.wall_depth;
        let method = self.compiled.method(device, queue, &settings)?;
        let before = std::mem::replace(&mut self.settings, settings);
        let method = std::mem::replace(&mut self.method, method);
        let grid = self.next.as_ref().or(self.grid.as_ref());
        let Some(grid) = grid.filter(|_| !planned) else { return Ok(()) };
        self.method.take(&self.lamps, grid.size, &self.settings, &mut self.list);
        let known = grid.known.under(self.settings.bounces);
        match self.plan(device, (&grid.textures, known), Some(grid)) {
            Ok(planned) => self.next = Some(planned),
            Err(error) => {
                self.settings = before;
                self.method = method;
                return Err(error);
            }
        }
        Ok(())
    }

    /// Has [`Self::record`] write the light into a texture of the host's too, linear RGB and 1: of the
    /// format `Rgba16Float`, with the usage `STORAGE_BINDING`, as large as the grid last prepared. It
    /// stays so until that size changes.
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
        let ([w, h], [width, height]) = (matter::single("output", picture)?, grid.size);
        if [w, h] != grid.size {
            return Err(wrong_output(format!("is {w}×{h}, but the grid is {width}×{height}")));
        }
        let matter = (&grid.textures, grid.known);
        let site = Site::new(device, &self.shared, &self.settings, self.options, matter)?;
        let output = guarded(device, || Ok(self.output.plan(&site, &grid.light, picture)))?;
        if let Some(next) = &mut self.next {
            next.output = Some(output.clone());
        }
        grid.output = Some(output);
        Ok(())
    }

    /// Records what turns the cells last prepared into light; nothing before the first.
    pub fn record(&self, encoder: &mut CommandEncoder) {
        let Some(grid) = &self.grid else { return };
        run(encoder, "lamplight", grid.dispatches());
    }

    /// As [`Self::record`], and times each stage, which is then a pass by itself.
    pub fn record_timed(&self, encoder: &mut CommandEncoder, timer: &mut Timer) {
        let Some(grid) = &self.grid else { return };
        timer.record(encoder, grid.dispatches());
    }

    /// Records the seed map, jump flood and distance field of the cells last prepared, for hosts that
    /// want them; a frame that needs them makes them itself. The first time it makes their pipelines
    /// and buffers.
    pub fn record_fields(&mut self, device: &Device, encoder: &mut CommandEncoder) -> Result<()> {
        let Some(grid) = &mut self.grid else { return Ok(()) };
        let fields = match grid.fields.take() {
            Some(fields) => fields,
            None => {
                let matter = (&grid.textures, grid.known);
                let site = Site::new(device, &self.shared, &self.settings, self.options, matter)?;
                guarded(device, || Ok(Fields::new(device).plan(&site)?.run))?
            }
        };
        run(encoder, "lamplight fields", grid.fields.insert(fields).dispatches.iter());
        Ok(())
    }

    /// Where a stage's result lies, row by row; none where the method does not make it, and before the
    /// first [`Self::prepare`].
    pub fn stage(&self, stage: Stage) -> Option<&Buffer> {
        let Grid { frame, fields, .. } = self.grid.as_ref()?;
        // First what was asked for: a frame that makes its own fields may never have been recorded.
        let mut stages = fields.iter().flat_map(|run| &run.stages).chain(&frame.stages);
        stages.find(|(name, _)| *name == stage).map(|(_, buffer)| buffer)
    }

    /// What there is to show; none before the first [`Self::prepare`].
    pub(crate) fn lit(&self) -> Option<Lit<'_>> {
        let Grid { size, textures, light, .. } = self.grid.as_ref()?;
        Some(Lit { size: *size, textures, light, frame: &self.shared.frame })
    }

    /// What a frame of the grid last prepared takes; nothing before the first.
    pub fn cost(&self) -> Option<Cost> {
        let grid = self.grid.as_ref()?;
        Some(Cost::new(grid.dispatches(), grid.memory))
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

fn wrong_output(problem: String) -> Error {
    Error::Texture { name: "output", problem }
}
