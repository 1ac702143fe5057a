//! The planner of a frame: makes the buffers for a grid and binds them to pipelines.

use crate::cookies::CookieAtlas;
use crate::error::Result;
use crate::found_light::{FoundLight, TO_LIGHT, TO_SCATTERED};
use crate::grid_size::GridSize;
use crate::hints::SceneHints;
use crate::lamps::{Capacity, LampList, RAY_BYTES};
use crate::matter::Textures;
use crate::options::LightingOptions;
use crate::pipeline::{BoundResources, ComputePipelines, Dispatch};
use crate::shared::{Shared, filled};
use lamplight::Settings;
use std::cell::{Cell, RefCell};
use wgpu::{BindingResource, Buffer, BufferDescriptor, BufferUsages, Device, TextureView};

/// The grid that stages and methods are planned for.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a> {
    pub size: GridSize,
    pub textures: &'a Textures,
    pub hints: SceneHints,
}

/// A grid, and the buffers made for it so far.
#[derive(Debug)]
pub struct FramePlanner<'a> {
    pub device: &'a Device,
    pub shared: &'a Shared,
    pub settings: &'a Settings,
    pub options: LightingOptions,
    pub size: GridSize,
    pub textures: &'a Textures,
    pub hints: SceneHints,
    pub capacity: Capacity,
    /// The sky, if it is a panorama, or what takes its place.
    strips: Option<&'a TextureView>,
    /// Columns of the inflow, if light enters by place.
    pub inflow_columns: Option<u32>,
    /// The cookies of lamps, if there are any.
    cookies: Option<&'a TextureView>,
    /// The direct light of suns and exact lamps, if there are any.
    direct: Option<FoundLight<'a>>,
    /// Bytes of the buffers and textures made so far.
    memory: Cell<u64>,
    /// History of the plan before, for a grid of this size.
    before: &'a [HistoryBuffer],
    history: RefCell<Vec<HistoryBuffer>>,
}

/// The label of the scattered radiance that bounces by feedback keep.
const SCATTERED: &str = "scattered";

/// A labelled buffer that persists across frames.
#[derive(Clone, Debug)]
pub struct HistoryBuffer {
    pub label: &'static str,
    pub buffer: Buffer,
}

/// Returns the scattered radiance of history, if bounces by feedback have kept it.
pub fn scattered_of(history: &[HistoryBuffer]) -> Option<&Buffer> {
    history.iter().find(|known| known.label == SCATTERED).map(|known| &known.buffer)
}

impl<'a> FramePlanner<'a> {
    /// Creates a planner without capacity for lamps and without history.
    pub fn new(
        shared: &'a Shared,
        settings: &'a Settings,
        options: LightingOptions,
        Grid { size, textures, hints }: Grid<'a>,
    ) -> Self {
        Self {
            device: &shared.device,
            shared,
            settings,
            options,
            size,
            textures,
            hints,
            capacity: Capacity::default(),
            strips: None,
            inflow_columns: None,
            cookies: None,
            direct: None,
            memory: Cell::default(),
            before: &[],
            history: RefCell::default(),
        }
    }

    /// Adds capacity for lamps: `present`, or more if that is needed.
    ///
    /// # Errors
    /// If the device cannot hold that many lamps.
    pub fn with_capacity(self, present: Capacity, needed: Capacity) -> Result<Self> {
        let bytes = self.max_buffer_bytes();
        let lamps = LampList::max_lamps(bytes);
        let rays = bytes / RAY_BYTES;
        // A sun takes no more bytes than a lamp.
        let most = Capacity { lamps, rays, exact_lamps: lamps, suns: lamps };
        if !most.holds(needed) {
            let lights = needed.lamps.max(needed.exact_lamps).max(needed.suns);
            let wanted = LampList::bytes(lights).max(needed.rays * RAY_BYTES);
            return Err(self.size.too_large("bytes for the rays of its lamps", wanted, bytes));
        }
        Ok(Self { capacity: present.grown(needed, most), ..self })
    }

    /// Continues the history of frames of the same size.
    pub fn after(self, before: &'a [HistoryBuffer]) -> Self {
        Self { before, ..self }
    }

    /// Splits a count of workgroups into rows that the device allows.
    pub fn groups(&self, count: u64) -> [u32; 3] {
        let most = u64::from(self.device.limits().max_compute_workgroups_per_dimension);
        let rows = count.div_ceil(most).max(1);
        // Both fit: no buffer holds more rays than 2³² bytes do.
        [count.div_ceil(rows) as u32, rows as u32, 1]
    }

    /// The number of cells of the grid.
    pub fn cells(&self) -> u64 {
        self.size.cells()
    }

    /// The number of values of light: one per cell, and two of its first moment if that is found.
    pub fn light_values(&self) -> u64 {
        self.cells() * if self.settings.moment { 3 } else { 1 }
    }

    /// The largest size of a buffer, in bytes.
    pub fn max_buffer_bytes(&self) -> u64 {
        let limits = self.device.limits();
        if !self.shared.has_compute {
            return limits.max_buffer_size;
        }
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    }

    /// Creates a buffer of `count` values.
    ///
    /// # Errors
    /// If the device cannot hold it. The same goes for all functions here that create buffers.
    pub fn buffer<T>(&self, label: &str, count: u64) -> Result<Buffer> {
        self.buffer_of_bytes(label, count * size_of::<T>() as u64)
    }

    /// Creates a buffer of a number of bytes.
    pub fn buffer_of_bytes(&self, label: &str, bytes: u64) -> Result<Buffer> {
        let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        self.buffer_for(label, bytes, usage)
    }

    /// Creates a buffer with a usage of its own.
    pub fn buffer_for(&self, label: &str, bytes: u64, usage: BufferUsages) -> Result<Buffer> {
        self.check_bytes(bytes)?;
        self.memory.set(self.memory.get() + bytes);
        Ok(self.device.create_buffer(&BufferDescriptor {
            label: Some(label),
            size: bytes,
            usage,
            mapped_at_creation: false,
        }))
    }

    /// Reads other textures from here on.
    pub fn with_textures(self, textures: &'a Textures) -> Self {
        Self { textures, ..self }
    }

    /// The layers of all cells.
    pub fn masks(&self) -> BindingResource<'_> {
        view(self.textures.masks.as_ref().unwrap_or(&self.shared.all_layers))
    }

    /// Sets the panorama of the sky or, with `inflow_columns`, the inflow in its place.
    pub fn with_strips(self, strips: Option<&'a TextureView>, inflow_columns: Option<u32>) -> Self {
        Self { strips, inflow_columns, ..self }
    }

    /// The panorama or the strips of the inflow, or a single texel if there is neither.
    pub fn panorama(&self) -> BindingResource<'_> {
        view(self.strips.unwrap_or(&self.shared.no_panorama))
    }

    /// Returns whether the sky is a panorama that methods read.
    pub fn has_panorama(&self) -> bool {
        self.strips.is_some() && self.inflow_columns.is_none()
    }

    /// Sets the cookies of lamps.
    pub fn with_cookies(self, cookies: Option<&'a TextureView>) -> Self {
        let bytes = cookies.map_or(0, CookieAtlas::bytes);
        self.memory.set(self.memory.get() + bytes);
        Self { cookies, ..self }
    }

    /// The cookies of lamps, or a single texel without any.
    pub fn cookies(&self) -> BindingResource<'_> {
        view(self.cookies.unwrap_or(&self.shared.no_cookies))
    }

    /// Sets the direct light that methods add to theirs.
    pub fn with_direct(self, direct: Option<FoundLight<'a>>) -> Self {
        Self { direct, ..self }
    }

    /// Plans adding direct light, if there is any, to the light of cells.
    pub fn add_direct(&self, light: &Buffer) -> Option<Dispatch> {
        self.add_to(TO_LIGHT, light)
    }

    /// Plans adding what is scattered of direct light, if there is any, to scattered radiance.
    pub fn scatter_direct(&self, scattered: &Buffer) -> Option<Dispatch> {
        self.add_to(TO_SCATTERED, scattered)
    }

    fn add_to(&self, entry: usize, sum: &Buffer) -> Option<Dispatch> {
        let FoundLight { pipelines, found } = self.direct.as_ref()?;
        let resources = [whole(found), view(&self.textures.albedo), whole(sum)];
        let bound = self.bind(pipelines, &resources);
        Some(self.over_cells(pipelines, entry, &bound, None))
    }

    /// The direct light of all faces, or a single value without any.
    pub fn direct_light(&self) -> Result<Buffer> {
        match &self.direct {
            Some(direct) => Ok(direct.found.clone()),
            None => self.buffer::<[f32; 4]>("no direct light", 1),
        }
    }

    /// Counts a texture of four floats per cell among the memory.
    pub fn counted_texture(&self, view: TextureView) -> TextureView {
        self.memory.set(self.memory.get() + self.cells() * size_of::<[f32; 4]>() as u64);
        view
    }

    /// Counts a buffer that exists already among those made.
    pub fn counted(&self, buffer: Buffer) -> Buffer {
        self.memory.set(self.memory.get() + buffer.size());
        buffer
    }

    /// Creates a history buffer of `count` values, or continues the one of that label. Each frame finds it as
    /// the frame before left it, even after the host's textures changed; it is all 0 at first.
    pub fn history<T>(&self, label: &'static str, count: u64) -> Result<Buffer> {
        let bytes = count * size_of::<T>() as u64;
        let known = self.before.iter().find(|known| known.label == label);
        let buffer = match known {
            Some(known) if known.buffer.size() == bytes => self.counted(known.buffer.clone()),
            _ => self.buffer_of_bytes(label, bytes)?,
        };
        self.history.borrow_mut().push(HistoryBuffer { label, buffer: buffer.clone() });
        Ok(buffer)
    }

    /// Creates the history of scattered radiance, `count` values, which bounces by feedback keep.
    pub fn kept_scattered<T>(&self, count: u64) -> Result<Buffer> {
        self.history::<T>(SCATTERED, count)
    }

    /// The history for the next plan.
    pub fn history_planned(&self) -> Vec<HistoryBuffer> {
        self.history.borrow().clone()
    }

    /// Creates a buffer with contents, which shaders only read.
    pub fn filled(&self, label: &str, usage: BufferUsages, contents: &[u8]) -> Result<Buffer> {
        let bytes = contents.len() as u64;
        self.check_bytes(bytes)?;
        self.memory.set(self.memory.get() + bytes);
        Ok(filled(self.device, &self.shared.queue, label, usage, contents))
    }

    /// Rejects a buffer that the device cannot hold.
    pub fn check_bytes(&self, bytes: u64) -> Result<()> {
        let most = self.max_buffer_bytes();
        if bytes > most {
            return Err(self.size.too_large("bytes a buffer", bytes, most));
        }
        Ok(())
    }

    /// Creates the two buffers of a ping-pong.
    pub fn pair<T>(&self, label: &str, count: u64) -> Result<[Buffer; 2]> {
        Ok([self.buffer::<T>(label, count)?, self.buffer::<T>(label, count)?])
    }

    /// Bytes of the buffers made so far.
    pub fn memory(&self) -> u64 {
        self.memory.get()
    }

    /// Binds the frame's uniforms and these resources.
    pub fn bind(
        &self,
        pipelines: &ComputePipelines,
        resources: &[BindingResource],
    ) -> BoundResources {
        let mut all = vec![self.shared.frame.as_entire_binding()];
        all.extend_from_slice(resources);
        pipelines.bind(self.device, &all)
    }

    /// Dispatches a thread per cell.
    pub fn over_cells(
        &self,
        pipelines: &ComputePipelines,
        entry: usize,
        bound: &BoundResources,
        step: Option<u32>,
    ) -> Dispatch {
        Dispatch::over(self.size.into(), pipelines.entry(entry), bound, step)
    }

    /// Dispatches that alternate between two buffers, bound by which they write: entry 0 writes the first,
    /// entry 1 runs `times` times, entry 2 comes last. Their step counts them.
    pub fn ping_pong(
        &self,
        pipelines: &ComputePipelines,
        halves: [BoundResources; 2],
        times: u32,
    ) -> Vec<Dispatch> {
        let entry = |step: u32| match step {
            0 => 0,
            step if step <= times => 1,
            _ => 2,
        };
        let dispatch =
            |step| self.over_cells(pipelines, entry(step), &halves[step as usize % 2], Some(step));
        (0..times + 2).map(dispatch).collect()
    }
}

/// Binds a whole buffer.
pub fn whole(buffer: &Buffer) -> BindingResource<'_> {
    buffer.as_entire_binding()
}

/// Binds a texture.
pub fn view(view: &TextureView) -> BindingResource<'_> {
    BindingResource::TextureView(view)
}
