//! Fetching what the GPU computed, for tests and files. It waits: not for a game's frame.

use crate::{Error, Result};
use bytemuck::Pod;
use std::sync::mpsc;
use wgpu::{Buffer, BufferDescriptor, BufferUsages, Device, MapMode, PollType, Queue};

/// Copies a whole buffer from the GPU, after everything that was submitted before.
pub fn read_back<T: Pod>(device: &Device, queue: &Queue, buffer: &Buffer) -> Result<Vec<T>> {
    let fetched = device.create_buffer(&BufferDescriptor {
        label: Some("read back"),
        size: buffer.size(),
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, 0, &fetched, 0, buffer.size());
    queue.submit([encoder.finish()]);
    let (tell, told) = mpsc::channel();
    fetched.map_async(MapMode::Read, .., move |mapped| {
        // Nobody hears it only if waiting failed.
        let _ = tell.send(mapped);
    });
    let failed = |e: &dyn std::fmt::Display| Error::ReadBack(e.to_string());
    device.poll(PollType::wait_indefinitely()).map_err(|e| failed(&e))?;
    told.recv().map_err(|e| failed(&e))?.map_err(|e| failed(&e))?;
    Ok(bytemuck::pod_collect_to_vec(&fetched.get_mapped_range(..)))
}
