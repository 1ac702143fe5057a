//! The quads of a camera on the GPU.

use super::draw::{DrawList, QuadBatch};
use super::image_bindings::ImageBindings;
use super::pipelines::{Pipelines, QuadPass, TargetTransform, bind};
use lamplight_wgpu::Error;
use lamplight_wgpu::error::DeviceError;
use lamplight_wgpu::wgpu::{
    BindGroup, Buffer, BufferDescriptor, BufferUsages, Device, Queue, RenderPass,
};

/// Quads and materials in buffers, and the transforms to both render targets.
#[derive(Default)]
pub struct QuadBuffers {
    lists: Option<QuadLists>,
    transforms: [Option<Buffer>; 2],
    groups: [Option<BindGroup>; 2],
}

struct QuadLists {
    quads: Buffer,
    materials: Buffer,
}

/// A render target of quads.
#[derive(Clone, Copy)]
enum QuadTarget {
    /// The lit grid.
    Grid = 0,
    /// The camera's part of the screen.
    Screen = 1,
}

impl QuadBuffers {
    /// Uploads the quads and the transforms to the grid and to the screen, in this order. Buffers grow
    /// by half and never shrink.
    ///
    /// # Errors
    /// If the device has no buffer of the size needed.
    pub fn write(
        &mut self,
        device: &Device,
        queue: &Queue,
        pipelines: &Pipelines,
        draw: &DrawList,
        transforms: [TargetTransform; 2],
    ) -> Result<(), Error> {
        let lists = [bytemuck::cast_slice(&draw.quads), bytemuck::cast_slice(&draw.materials)];
        let fits = |buffers: &QuadLists| {
            [&buffers.quads, &buffers.materials]
                .iter()
                .zip(lists)
                .all(|(buffer, list)| buffer.size() >= list.len() as u64)
        };
        if !self.lists.as_ref().is_some_and(fits) {
            let max = device.limits().max_buffer_size;
            let list = |label, bytes: &[u8]| {
                let needed = bytes.len() as u64;
                let size = buffer_size(needed, max).ok_or_else(|| {
                    let reason = format!("{label} take {needed} bytes, and its buffers {max}");
                    Error::Device(DeviceError(reason))
                })?;
                Ok::<_, Error>(buffer(device, label, size, BufferUsages::VERTEX))
            };
            self.lists = Some(QuadLists {
                quads: list("lamplight quads", lists[0])?,
                materials: list("lamplight materials", lists[1])?,
            });
        }
        let Some(buffers) = &self.lists else { return Ok(()) };
        queue.write_buffer(&buffers.quads, 0, lists[0]);
        queue.write_buffer(&buffers.materials, 0, lists[1]);
        let own = self.transforms.iter_mut().zip(&mut self.groups);
        for ((own, group), transform) in own.zip(transforms) {
            let own = own.get_or_insert_with(|| {
                let size = size_of::<TargetTransform>() as u64;
                buffer(device, "lamplight transform", size, BufferUsages::UNIFORM)
            });
            queue.write_buffer(own, 0, bytemuck::bytes_of(&transform));
            group.get_or_insert_with(|| {
                let transform = [own.as_entire_binding()];
                bind(device, "lamplight quads", &pipelines.quads_layout, transform)
            });
        }
        Ok(())
    }

    /// Binds the quads and the transform to a target; `None` before they are written.
    fn bind(&self, pass: &mut RenderPass, target: QuadTarget) -> Option<()> {
        let lists = self.lists.as_ref()?;
        pass.set_bind_group(0, self.groups[target as usize].as_ref()?, &[]);
        pass.set_vertex_buffer(0, lists.quads.slice(..));
        pass.set_vertex_buffer(1, lists.materials.slice(..));
        Some(())
    }

    /// Draws batches whose image is loaded; on the screen only what Bevy draws there.
    pub fn draw(
        &self,
        pass: &mut RenderPass,
        (device, pipelines): (&Device, &Pipelines),
        quad_pass: QuadPass,
        batches: &[QuadBatch],
        images: &ImageBindings,
    ) {
        let target = match quad_pass {
            QuadPass::Matter | QuadPass::Lamps | QuadPass::Masks => QuadTarget::Grid,
            QuadPass::Glow => QuadTarget::Screen,
        };
        if self.bind(pass, target).is_none() {
            return;
        }
        let is_on_grid = matches!(target, QuadTarget::Grid);
        for batch in batches.iter().filter(|batch| batch.is_drawn || is_on_grid) {
            let Some(image) = images.get(batch.image) else { continue };
            pass.set_pipeline(pipelines.quads(device, quad_pass, image.layered));
            pass.set_bind_group(1, &image.group, &[]);
            pass.draw(0..6, batch.quads.clone());
        }
    }

    /// Draws the normals of batches on the screen. Those whose normal map is not loaded are flat.
    pub fn draw_normals(
        &self,
        pass: &mut RenderPass,
        (device, pipelines): (&Device, &Pipelines),
        batches: &[QuadBatch],
        images: &ImageBindings,
    ) {
        if self.bind(pass, QuadTarget::Screen).is_none() {
            return;
        }
        for batch in batches.iter().filter(|batch| batch.is_drawn) {
            let Some(image) = images.get(batch.image) else { continue };
            let normals = batch.normals.and_then(|normals| images.get(normals));
            let map_layered = normals.map(|normals| normals.layered);
            pass.set_pipeline(pipelines.normals(device, image.layered, map_layered));
            if let Some(normals) = normals {
                pass.set_bind_group(2, &normals.group, &[]);
            }
            pass.set_bind_group(1, &image.group, &[]);
            pass.draw(0..6, batch.quads.clone());
        }
    }
}

/// The size of a buffer for `needed` bytes, with room to grow; `None` above `max`.
fn buffer_size(needed: u64, max: u64) -> Option<u64> {
    const MIN: u64 = 1 << 12;
    let ample = (needed * 3 / 2).next_multiple_of(MIN).max(MIN);
    (needed <= max).then(|| ample.min(max))
}

fn buffer(device: &Device, label: &str, size: u64, usage: BufferUsages) -> Buffer {
    device.create_buffer(&BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buffers_grow_up_to_the_devices_limit() {
        assert_eq!(buffer_size(0, 1 << 20), Some(1 << 12));
        assert_eq!(buffer_size(8192, 1 << 20), Some(12_288));
        assert_eq!(buffer_size(900_000, 1 << 20), Some(1 << 20));
        assert_eq!(buffer_size((1 << 20) + 1, 1 << 20), None);
    }
}
