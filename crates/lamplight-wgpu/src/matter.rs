//! The grid of matter as pictures on the GPU.

use lamplight::Cells;
use wgpu::{
    Device, Extent3d, Origin3d, Queue, TexelCopyBufferLayout, TexelCopyTextureInfo, Texture,
    TextureAspect, TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, TextureView,
};

/// Bytes of a texel: four floats.
const TEXEL: u32 = 16;

/// Emission, tint with opacity, and albedo, uploaded from cells.
#[derive(Debug)]
pub struct Matter {
    emission: Texture,
    tint_opacity: Texture,
    albedo: Texture,
    pub emission_view: TextureView,
    pub tint_opacity_view: TextureView,
    pub albedo_view: TextureView,
    /// Texels on their way.
    texels: Vec<[f32; 4]>,
}

impl Matter {
    pub fn new(device: &Device, [width, height]: [u32; 2]) -> Self {
        let texture = |label| {
            device.create_texture(&TextureDescriptor {
                label: Some(label),
                size: Extent3d { width, height, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: TextureDimension::D2,
                format: TextureFormat::Rgba32Float,
                usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
                view_formats: &[],
            })
        };
        let (emission, tint_opacity) = (texture("emission"), texture("tint and opacity"));
        let albedo = texture("albedo");
        Self {
            emission_view: emission.create_view(&Default::default()),
            tint_opacity_view: tint_opacity.create_view(&Default::default()),
            albedo_view: albedo.create_view(&Default::default()),
            emission,
            tint_opacity,
            albedo,
            texels: Vec::new(),
        }
    }

    /// Takes the cells over.
    pub fn upload(&mut self, queue: &Queue, cells: &Cells) {
        for (texture, rgb) in [(&self.emission, cells.emission()), (&self.albedo, cells.albedo())] {
            self.texels.clear();
            self.texels.extend(rgb.iter().map(|&[r, g, b]| [r, g, b, 0.0]));
            write(queue, texture, &self.texels);
        }
        self.texels.clear();
        let tints = cells.tint().iter().zip(cells.opacity());
        self.texels.extend(tints.map(|(&[r, g, b], &opacity)| [r, g, b, opacity]));
        write(queue, &self.tint_opacity, &self.texels);
    }
}

fn write(queue: &Queue, texture: &Texture, texels: &[[f32; 4]]) {
    let target = TexelCopyTextureInfo {
        texture,
        mip_level: 0,
        origin: Origin3d::ZERO,
        aspect: TextureAspect::All,
    };
    let rows = TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(texture.width() * TEXEL),
        rows_per_image: None,
    };
    queue.write_texture(target, bytemuck::cast_slice(texels), rows, texture.size());
}
