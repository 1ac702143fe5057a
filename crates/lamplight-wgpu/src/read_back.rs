//! Results of the GPU on the CPU: [`read_back`] and [`light`] wait, for tests and files. [`Fetch`] and
//! [`FetchLight`] do not, for a game's frame and for the web, where waiting is impossible.

use crate::error::ReadBackError;
use crate::error_scope::with_error_scope;
use crate::{Lighting, Stage};
use bytemuck::Pod;
use lamplight::{Cells, Light};
use std::marker::PhantomData;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use wgpu::{
    Buffer, BufferAsyncError, BufferDescriptor, BufferUsages, Device, MapMode, PollType, Queue,
};

/// Copies a whole buffer from the GPU, after everything that was submitted before.
///
/// # Errors
/// If the device was lost, or the buffer belongs to another device.
pub fn read_back<T: Pod>(
    device: &Device,
    queue: &Queue,
    buffer: &Buffer,
) -> Result<Vec<T>, ReadBackError> {
    Fetch::new(device, queue, buffer)?.wait()
}

/// Copies the light of the last frame of these cells, for queries as on the CPU: solid lamps count as solid
/// cells.
///
/// # Errors
/// If nothing was lit, if the cells have another number than those lit, and as [`read_back`].
pub fn light(lighting: &Lighting, cells: &Cells) -> Result<Light, ReadBackError> {
    let fetch = FetchLight::new(lighting, cells)?;
    fetch.cells.light(fetch.numbers.wait()?)
}

/// A transfer of a buffer from the GPU.
#[derive(Debug)]
pub struct Fetch<T> {
    device: Device,
    copy: Buffer,
    mapped: Receiver<Result<(), BufferAsyncError>>,
    values: PhantomData<T>,
}

impl<T: Pod> Fetch<T> {
    /// Starts the transfer of a whole buffer, as everything that was submitted before leaves it.
    ///
    /// # Errors
    /// If the device was lost, or the buffer belongs to another device.
    pub fn new(device: &Device, queue: &Queue, buffer: &Buffer) -> Result<Self, ReadBackError> {
        with_error_scope(device, || Ok(Self::begin(device, queue, buffer)))
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
        let (sender, mapped) = channel();
        copy.map_async(MapMode::Read, .., move |result| {
            // The receiver is gone if the fetch was dropped.
            let _ = sender.send(result);
        });
        Self { device: device.clone(), copy, mapped, values: PhantomData }
    }

    /// Returns the values if they have arrived; `None` while the transfer is in progress. Does not wait.
    pub fn take(&self) -> Result<Option<Vec<T>>, ReadBackError> {
        self.device.poll(PollType::Poll).map_err(failed)?;
        match self.mapped.try_recv() {
            Ok(mapped) => {
                mapped.map_err(failed)?;
                self.values().map(Some)
            }
            Err(TryRecvError::Empty) => Ok(None),
            Err(gone) => Err(failed(gone)),
        }
    }

    /// Waits for the values.
    pub fn wait(self) -> Result<Vec<T>, ReadBackError> {
        self.device.poll(PollType::wait_indefinitely()).map_err(failed)?;
        self.mapped.recv().map_err(failed)?.map_err(failed)?;
        self.values()
    }

    fn values(&self) -> Result<Vec<T>, ReadBackError> {
        let mapped = self.copy.get_mapped_range(..).map_err(failed)?;
        Ok(bytemuck::pod_collect_to_vec(&mapped))
    }
}

/// A transfer of the light of a frame from the GPU.
#[derive(Debug)]
pub struct FetchLight {
    numbers: Fetch<[f32; 4]>,
    cells: LitCells,
}

impl FetchLight {
    /// Starts the transfer of the light of the last frame of these cells, as [`light`] does.
    pub fn new(lighting: &Lighting, cells: &Cells) -> Result<Self, ReadBackError> {
        let buffer = lighting.stage(Stage::Light).ok_or(ReadBackError::NothingLit)?;
        let mut cells = cells.clone();
        if let Some(settings) = lighting.settings() {
            settings.method.draw_lamps(&mut cells);
        }
        let elevation = lighting.settings().filter(|s| s.moment).map(|s| s.elevation);
        let values = buffer.size() as usize / size_of::<[f32; 4]>();
        let lit = if elevation.is_some() { values / 3 } else { values };
        let (device, queue) = lighting.device();
        let cells = LitCells { cells, lit, elevation };
        Ok(Self { numbers: Fetch::new(device, queue, buffer)?, cells })
    }

    /// Returns the light if it has arrived; `None` while the transfer is in progress. Does not wait.
    pub fn take(&self) -> Result<Option<Light>, ReadBackError> {
        self.numbers.take()?.map(|numbers| self.cells.light(numbers)).transpose()
    }
}

/// The cells that were lit.
#[derive(Debug)]
struct LitCells {
    cells: Cells,
    /// The number of values of light, without those of its first moment.
    lit: usize,
    /// The elevation of light, if its first moment was found.
    elevation: Option<f32>,
}

impl LitCells {
    fn light(&self, numbers: Vec<[f32; 4]>) -> Result<Light, ReadBackError> {
        let other = |_| ReadBackError::OtherCells { lit: self.lit, asked: self.cells.len() };
        let (light, moment) = numbers.split_at(self.lit.min(numbers.len()));
        let rgb = |[r, g, b, _]: &[f32; 4]| [*r, *g, *b];
        let light = Light::from_pixels(&self.cells, light.iter().map(rgb).collect());
        let light = light.map_err(other)?;
        let Some(elevation) = self.elevation else { return Ok(light) };
        let (x, y) = moment.split_at(moment.len() / 2);
        let moment = x.iter().zip(y).map(|(x, y)| [rgb(x), rgb(y)]).collect();
        light.with_moment(moment, elevation).map_err(other)
    }
}

fn failed(why: impl std::fmt::Display) -> ReadBackError {
    ReadBackError::Failed(why.to_string())
}
