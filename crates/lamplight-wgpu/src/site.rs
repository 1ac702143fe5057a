//! Where a frame is planned: the grid, its matter, and the buffers that are made for it.

use crate::kernel::{Bound, Dispatch, Kernels};
use crate::known::Known;
use crate::lamps::{Lamps, RAY_BYTES, Room};
use crate::lighting::Stage;
use crate::matter::Textures;
use crate::options::Options;
use crate::shared::{Shared, filled};
use crate::{Error, Result};
use lamplight::Settings;
use std::cell::{Cell, RefCell};
use wgpu::{BindingResource, Buffer, BufferDescriptor, BufferUsages, Device, TextureView};

/// Bytes of four floats.
pub const FOUR: u64 = 16;
/// Bytes of one number.
pub const ONE: u64 = 4;

/// What stages and methods are planned on.
#[derive(Debug)]
pub struct Site<'a> {
    pub device: &'a Device,
    pub shared: &'a Shared,
    pub settings: &'a Settings,
    pub options: Options,
    pub textures: &'a Textures,
    pub known: Known,
    pub size: [u32; 2],
    /// For lamps that are lit by rule.
    pub room: Room,
    /// Bytes of the buffers made so far.
    memory: Cell<u64>,
    /// What the plan before kept for a grid of this size.
    before: &'a [Kept],
    kept: RefCell<Vec<Kept>>,
}

/// A buffer that frames hand on, by its label.
pub type Kept = (&'static str, Buffer);

/// What runs over a grid, in order, and what it leaves behind.
#[derive(Debug)]
pub struct Run {
    pub dispatches: Vec<Dispatch>,
    /// What can be read back.
    pub stages: Vec<(Stage, Buffer)>,
    /// Where lamps that are lit by rule are written before each frame.
    pub lamps: Option<Buffer>,
}

impl<'a> Site<'a> {
    /// Refuses a grid that the device cannot hold.
    pub fn new(
        device: &'a Device,
        shared: &'a Shared,
        settings: &'a Settings,
        options: Options,
        (textures, known): (&'a Textures, Known),
    ) -> Result<Self> {
        let size = textures.size()?;
        fits(device, size)?;
        let (memory, kept) = Default::default();
        let (room, before) = (Room::default(), &[]);
        Ok(Self {
            device,
            shared,
            settings,
            options,
            textures,
            known,
            size,
            room,
            memory,
            before,
            kept,
        })
    }

    /// The same with room for lamps: as much as there was, or more; refuses more lamps than the device
    /// can hold.
    pub fn with_room(self, had: Room, need: Room) -> Result<Self> {
        let largest = self.most_bytes();
        let most = Room { lamps: Lamps::most(largest), rays: largest / RAY_BYTES };
        if !most.holds(need) {
            let needed = Lamps::bytes(need.lamps).max(need.rays * RAY_BYTES);
            return Err(too_large(self.size, "bytes for the rays of its lamps", needed, largest));
        }
        Ok(Self { room: had.grown(need, most), ..self })
    }

    /// Takes over what frames of the same size before it handed on.
    pub fn after(self, before: &'a [Kept]) -> Self {
        Self { before, ..self }
    }

    /// So many workgroups, in rows as long as the device allows.
    pub fn groups(&self, count: u64) -> [u32; 3] {
        let most = u64::from(self.device.limits().max_compute_workgroups_per_dimension);
        let rows = count.div_ceil(most).max(1);
        // Both fit: no buffer holds more rays than 2³² bytes do.
        [count.div_ceil(rows) as u32, rows as u32, 1]
    }

    /// Cells of the grid.
    pub fn cells(&self) -> u64 {
        u64::from(self.size[0]) * u64::from(self.size[1])
    }

    /// Bytes of a buffer at most.
    pub fn most_bytes(&self) -> u64 {
        let limits = self.device.limits();
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    }

    /// Makes a buffer for the GPU's use; refuses one that the device cannot hold.
    pub fn buffer(&self, label: &str, bytes: u64) -> Result<Buffer> {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        self.buffer_for(label, bytes, usage)
    }

    /// Makes a buffer of a kind of its own.
    pub fn buffer_for(&self, label: &str, bytes: u64, usage: BufferUsages) -> Result<Buffer> {
        self.allows(bytes)?;
        self.memory.set(self.memory.get() + bytes);
        Ok(self.device.create_buffer(&BufferDescriptor {
            label: Some(label),
            size: bytes,
            usage,
            mapped_at_creation: false,
        }))
    }

    /// A buffer that is there already, counted among those made.
    pub fn counted(&self, buffer: Buffer) -> Buffer {
        self.memory.set(self.memory.get() + buffer.size());
        buffer
    }

    /// A buffer that each frame finds as the one before left it, also after the host's textures
    /// changed; all 0 at first.
    pub fn kept(&self, label: &'static str, bytes: u64) -> Result<Buffer> {
        let known = self.before.iter().find(|(name, _)| *name == label);
        let buffer = match known {
            Some((_, buffer)) if buffer.size() == bytes => self.counted(buffer.clone()),
            _ => self.buffer(label, bytes)?,
        };
        self.kept.borrow_mut().push((label, buffer.clone()));
        Ok(buffer)
    }

    /// What the next plan may take over.
    pub fn into_kept(self) -> Vec<Kept> {
        self.kept.into_inner()
    }

    /// Makes a buffer with something in it that shaders only read.
    pub fn filled(&self, label: &str, usage: BufferUsages, contents: &[u8]) -> Result<Buffer> {
        let bytes = contents.len() as u64;
        self.allows(bytes)?;
        self.memory.set(self.memory.get() + bytes);
        Ok(filled(self.device, &self.shared.queue, label, usage, contents))
    }

    /// Refuses a buffer that the device cannot hold.
    pub fn allows(&self, bytes: u64) -> Result<()> {
        let most = self.most_bytes();
        if bytes > most {
            return Err(too_large(self.size, "bytes a buffer", bytes, most));
        }
        Ok(())
    }

    /// The halves of a ping-pong.
    pub fn pair(&self, label: &str, bytes: u64) -> Result<[Buffer; 2]> {
        Ok([self.buffer(label, bytes)?, self.buffer(label, bytes)?])
    }

    /// Bytes of the buffers made so far.
    pub fn memory(&self) -> u64 {
        self.memory.get()
    }

    /// Binds the frame and these resources.
    pub fn bind(&self, kernels: &Kernels, resources: &[BindingResource]) -> Bound {
        let mut all = vec![self.shared.frame.as_entire_binding()];
        all.extend_from_slice(resources);
        kernels.bind(self.device, &all)
    }

    /// A run of an entry point over every cell.
    pub fn over_cells(
        &self,
        kernels: &Kernels,
        entry: usize,
        bound: &Bound,
        step: Option<u32>,
    ) -> Dispatch {
        Dispatch::over(self.size, &kernels.entries[entry], bound, step)
    }

    /// Runs that go to and fro between two halves, bound by which they write: to begin, into the
    /// first; so many times, told which; and to finish.
    pub fn ping_pong(&self, kernels: &Kernels, halves: [Bound; 2], times: u32) -> Vec<Dispatch> {
        let entry = |step: u32| match step {
            0 => 0,
            step if step <= times => 1,
            _ => 2,
        };
        let run =
            |step| self.over_cells(kernels, entry(step), &halves[step as usize % 2], Some(step));
        (0..times + 2).map(run).collect()
    }
}

/// Refuses a grid that the device's textures cannot hold.
pub fn fits(device: &Device, size: [u32; 2]) -> Result<()> {
    let (side, most) = (size[0].max(size[1]), device.limits().max_texture_dimension_2d);
    if side > most {
        return Err(too_large(size, "px a side", side.into(), most.into()));
    }
    Ok(())
}

/// More than the device allows.
pub fn too_large(
    [width, height]: [u32; 2],
    what: &'static str,
    needed: u64,
    allowed: u64,
) -> Error {
    Error::TooLarge { width, height, what, needed, allowed }
}

/// Binds a whole buffer.
pub fn whole(buffer: &Buffer) -> BindingResource<'_> {
    buffer.as_entire_binding()
}

/// Binds a texture.
pub fn view(view: &TextureView) -> BindingResource<'_> {
    BindingResource::TextureView(view)
}
