//! Fetching what the GPU computed, for tests and files. It waits: not for a game's frame.

use crate::guarded::guarded;
use crate::{Error, Result};
use bytemuck::Pod;
use std::sync::mpsc::{Receiver, channel};
use wgpu::{
    Buffer, BufferAsyncError, BufferDescriptor, BufferUsages, Device, MapMode, PollType, Queue,
};

/// Copies a whole buffer from the GPU, after everything that was submitted before.
///
/// An error where the device was lost, and where the buffer is one of another device.
pub fn read_back<T: Pod>(device: &Device, queue: &Queue, buffer: &Buffer) -> Result<Vec<T>> {
    let (fetched, told) = guarded(device, || Ok(fetch(device, queue, buffer)))?;
    let failed = |e: &dyn std::fmt::Display| Error::ReadBack(e.to_string());
    device.poll(PollType::wait_indefinitely()).map_err(|e| failed(&e))?;
    told.recv().map_err(|e| failed(&e))?.map_err(|e| failed(&e))?;
    Ok(bytemuck::pod_collect_to_vec(&fetched.get_mapped_range(..)))
}

/// A copy under way, and when it has arrived.
fn fetch(
    device: &Device,
    queue: &Queue,
    buffer: &Buffer,
) -> (Buffer, Receiver<Result<(), BufferAsyncError>>) {
    let fetched = device.create_buffer(&BufferDescriptor {
        label: Some("read back"),
        size: buffer.size(),
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &fetched, 0, buffer.size());
    queue.submit([encoder.finish()]);
    let (tell, told) = channel();
    fetched.map_async(MapMode::Read, .., move |mapped| {
        // Nobody hears it only if waiting failed.
        let _ = tell.send(mapped);
    });
    (fetched, told)
}
