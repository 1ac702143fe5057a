//! Textures as hosts have them, and their contents.

// Each test program uses its own part of this.
#![allow(dead_code)]

use lamplight_wgpu::read_back::read_back;
use wgpu::{
    BufferDescriptor, BufferUsages, Device, Extent3d, Queue, TexelCopyBufferInfo,
    TexelCopyBufferLayout, Texture, TextureDescriptor, TextureDimension, TextureFormat,
    TextureUsages, TextureView,
};

pub fn texture(
    device: &Device,
    [width, height]: [u32; 2],
    format: TextureFormat,
    usage: TextureUsages,
) -> Texture {
    device.create_texture(&TextureDescriptor {
        label: None,
        size: Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format,
        usage: usage | TextureUsages::COPY_DST | TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

pub fn view(texture: &Texture) -> TextureView {
    texture.create_view(&Default::default())
}

/// A texture with contents, which shaders may read.
pub fn filled(
    device: &Device,
    queue: &Queue,
    size: [u32; 2],
    format: TextureFormat,
    bytes: &[u8],
) -> TextureView {
    let texture = texture(device, size, format, TextureUsages::TEXTURE_BINDING);
    let row = bytes.len() as u32 / size[1];
    let layout =
        TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None };
    queue.write_texture(texture.as_image_copy(), bytes, layout, texture.size());
    view(&texture)
}

/// All bytes of a texture, row by row.
pub fn fetch(device: &Device, queue: &Queue, texture: &Texture) -> Vec<u8> {
    let row = texture.width() * texture.format().block_copy_size(None).unwrap();
    // Rows of a copy are padded to a multiple of this.
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&BufferDescriptor {
        label: None,
        size: u64::from(padded * texture.height()),
        usage: BufferUsages::COPY_SRC | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let layout =
        TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: None };
    let mut encoder = device.create_command_encoder(&Default::default());
    let target = TexelCopyBufferInfo { buffer: &buffer, layout };
    encoder.copy_texture_to_buffer(texture.as_image_copy(), target, texture.size());
    queue.submit([encoder.finish()]);
    let bytes: Vec<u8> = read_back(device, queue, &buffer).unwrap();
    bytes.chunks(padded as usize).flat_map(|padded| &padded[..row as usize]).copied().collect()
}

/// A half float of 0 or more that is not tiny.
pub fn float(half: u16) -> f32 {
    if half == 0 {
        return 0.0;
    }
    f32::from(half & 0x3ff | 0x400) / 1024.0 * 2f32.powi(i32::from(half >> 10) - 15)
}
