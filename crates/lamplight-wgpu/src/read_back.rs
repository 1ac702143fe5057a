//! Fetching what the GPU computed: [`read_back`] and [`light`] wait, for tests and files; a [`Fetch`] does
//! not, for a game's frame and for the web, where nothing can wait.

use crate::guarded::guarded;
use crate::{Error, Lighting, Result, Stage};
use bytemuck::Pod;
use lamplight::{Cells, Light};
use std::marker::PhantomData;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use wgpu::{
    Buffer, BufferAsyncError, BufferDescriptor, BufferUsages, Device, MapMode, PollType, Queue,
};

/// Copies a whole buffer from the GPU, after everything that was submitted before.
///
/// An error where the device was lost, and where the buffer is one of another device.
pub fn read_back<T: Pod>(device: &Device, queue: &Queue, buffer: &Buffer) -> Result<Vec<T>> {
    Fetch::new(device, queue, buffer)?.wait(device)
}

/// The light of the last frame of these cells, to be asked as on the CPU: discs of lamps that were
/// drawn in count as walls.
///
/// An error where nothing was lit, or cells of another size, and as [`read_back`].
pub fn light(device: &Device, queue: &Queue, lighting: &Lighting, cells: &Cells) -> Result<Light> {
    let fetch = FetchLight::new(device, queue, lighting, cells)?;
    fetch.matter.light(fetch.numbers.wait(device)?)
}

/// A buffer on its way from the GPU.
#[derive(Debug)]
pub struct Fetch<T> {
    copy: Buffer,
    told: Receiver<Result<(), BufferAsyncError>>,
    values: PhantomData<T>,
}

impl<T: Pod> Fetch<T> {
    /// Asks for a whole buffer, as everything that was submitted before leaves it.
    ///
    /// An error where the device was lost, and where the buffer is one of another device.
    pub fn new(device: &Device, queue: &Queue, buffer: &Buffer) -> Result<Self> {
        guarded(device, || Ok(Self::begin(device, queue, buffer)))
    }

    fn begin(device: &Device, queue: &Queue, buffer: &Buffer) -> Self {
        let copy = device.create_buffer(&BufferDescriptor {
            label: Some("read back"),
            size: buffer.size(),
            usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
        queue.submit([encoder.finish()]);
        let (tell, told) = channel();
        copy.map_async(MapMode::Read, .., move |mapped| {
            // Nobody hears it where the fetch was dropped.
            let _ = tell.send(mapped);
        });
        Self { copy, told, values: PhantomData }
    }

    /// What has come; none as long as it is on its way. Does not wait.
    pub fn take(&self, device: &Device) -> Result<Option<Vec<T>>> {
        device.poll(PollType::Poll).map_err(failed)?;
        match self.told.try_recv() {
            Ok(mapped) => mapped.map(|()| Some(self.values())).map_err(failed),
            Err(TryRecvError::Empty) => Ok(None),
            Err(gone) => Err(failed(gone)),
        }
    }

    /// Waits for it.
    pub fn wait(self, device: &Device) -> Result<Vec<T>> {
        device.poll(PollType::wait_indefinitely()).map_err(failed)?;
        self.told.recv().map_err(failed)?.map_err(failed)?;
        Ok(self.values())
    }

    fn values(&self) -> Vec<T> {
        bytemuck::pod_collect_to_vec(&self.copy.get_mapped_range(..))
    }
}

/// The light of a frame on its way from the GPU.
#[derive(Debug)]
pub struct FetchLight {
    numbers: Fetch<[f32; 4]>,
    matter: Matter,
}

impl FetchLight {
    /// Asks for the light of the last frame of these cells, as [`light`] does.
    pub fn new(device: &Device, queue: &Queue, lighting: &Lighting, cells: &Cells) -> Result<Self> {
        let none = || Error::ReadBack("nothing has been lit".to_owned());
        let buffer = lighting.stage(Stage::Light).ok_or_else(none)?;
        let by_rule = lighting.settings().method.lights_lamps();
        let matter = Matter(if by_rule { cells.clone() } else { cells.drawn().into_owned() });
        Ok(Self { numbers: Fetch::new(device, queue, buffer)?, matter })
    }

    /// What has come; none as long as it is on its way. Does not wait.
    pub fn take(&self, device: &Device) -> Result<Option<Light>> {
        self.numbers.take(device)?.map(|numbers| self.matter.light(numbers)).transpose()
    }
}

/// What was lit.
#[derive(Debug)]
struct Matter(Cells);

impl Matter {
    fn light(&self, numbers: Vec<[f32; 4]>) -> Result<Light> {
        let rgb = numbers.into_iter().map(|[r, g, b, _]| [r, g, b]).collect();
        let other = || Error::ReadBack("the cells that were lit are as many others".to_owned());
        Light::from_pixels(&self.0, rgb).ok_or_else(other)
    }
}

fn failed(why: impl std::fmt::Display) -> Error {
    Error::ReadBack(why.to_string())
}
