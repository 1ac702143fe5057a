//! The contents of a buffer on the CPU.

use crate::error::ReadBackError;
use crate::error_scope::with_error_scope;
use bytemuck::Pod;
use std::marker::PhantomData;
use std::sync::Mutex;
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

/// A transfer of a buffer from the GPU.
#[derive(Debug)]
pub struct Fetch<T> {
    device: Device,
    copy: Buffer,
    /// Behind a lock, so that hosts can share what holds it.
    mapped: Mutex<Receiver<Result<(), BufferAsyncError>>>,
    values: PhantomData<T>,
}

impl<T: Pod> Fetch<T> {
    /// Starts the transfer of a whole buffer, as everything that was submitted before leaves it.
    ///
    /// # Errors
    /// If the device was lost, or the buffer belongs to another device.
    pub fn new(device: &Device, queue: &Queue, buffer: &Buffer) -> Result<Self, ReadBackError> {
        with_error_scope(device, || {
            let copy = device.create_buffer(&BufferDescriptor {
                label: Some("read back"),
                size: buffer.size(),
                usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
                mapped_at_creation: false,
            });
            let mut encoder = device.create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
            queue.submit([encoder.finish()]);
            Ok(Self::map(device, copy))
        })
    }

    /// Starts the transfer of a buffer that the CPU can read. Until it is over, nothing may be written to it.
    pub(crate) fn map(device: &Device, copy: Buffer) -> Self {
        let (sender, mapped) = channel();
        copy.map_async(MapMode::Read, .., move |result| {
            // The receiver is gone if the fetch was dropped.
            let _ = sender.send(result);
        });
        Self { device: device.clone(), copy, mapped: Mutex::new(mapped), values: PhantomData }
    }

    /// Returns the values if they have arrived; `None` while the transfer is in progress. Does not wait.
    pub fn take(&self) -> Result<Option<Vec<T>>, ReadBackError> {
        let has_arrived = self.has_arrived()?;
        has_arrived.then(|| self.read(<[T]>::to_vec)).transpose()
    }

    /// Waits for the values.
    pub fn wait(self) -> Result<Vec<T>, ReadBackError> {
        self.wait_until_arrived()?;
        self.read(<[T]>::to_vec)
    }

    /// Returns whether the values have arrived, once.
    pub(crate) fn has_arrived(&self) -> Result<bool, ReadBackError> {
        self.device.poll(PollType::Poll).map_err(failed)?;
        match self.mapped.lock().map_err(failed)?.try_recv() {
            Ok(mapped) => mapped.map(|()| true).map_err(failed),
            Err(TryRecvError::Empty) => Ok(false),
            Err(gone) => Err(failed(gone)),
        }
    }

    /// Waits until the values have arrived.
    pub(crate) fn wait_until_arrived(&self) -> Result<(), ReadBackError> {
        self.device.poll(PollType::wait_indefinitely()).map_err(failed)?;
        self.mapped.lock().map_err(failed)?.recv().map_err(failed)?.map_err(failed)
    }

    /// Reads the values that have arrived. Then the buffer can be written to again.
    pub(crate) fn read<R>(&self, read: impl FnOnce(&[T]) -> R) -> Result<R, ReadBackError> {
        let values = self.copy.get_mapped_range(..).map_err(failed)?;
        let read = read(bytemuck::cast_slice(&values));
        drop(values);
        self.copy.unmap();
        Ok(read)
    }
}

fn failed(why: impl std::fmt::Display) -> ReadBackError {
    ReadBackError::Failed(why.to_string())
}
