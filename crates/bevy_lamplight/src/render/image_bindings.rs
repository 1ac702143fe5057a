//! Images bound for shaders.

use super::pipelines::Pipelines;
use bevy::asset::AssetId;
use bevy::image::Image;
use bevy::platform::collections::HashMap;
use bevy::prelude::Resource;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_resource::{SamplerId, TextureId, TextureViewDescriptor};
use bevy::render::texture::GpuImage;
use lamplight_wgpu::wgpu::{
    BindGroup, Device, TextureDimension, TextureSampleType, TextureUsages, TextureViewDimension,
};

/// Bind groups of images.
#[derive(Resource, Default)]
pub struct ImageBindings(HashMap<AssetId<Image>, BoundImage>);

struct BoundImage {
    texture: TextureId,
    sampler: SamplerId,
    /// `None` if shaders cannot read it.
    group: Option<ImageGroup>,
}

/// An image, bound.
pub struct ImageGroup {
    pub group: BindGroup,
    /// True if it has several layers, as tilesets do.
    pub layered: bool,
}

impl ImageBindings {
    /// Drops the bind groups of images that were removed or replaced, or have another sampler.
    pub fn sweep(&mut self, images: &RenderAssets<GpuImage>) {
        self.0.retain(|&id, bound| {
            images.get(id).is_some_and(|image| {
                (image.texture.id(), image.sampler.id()) == (bound.texture, bound.sampler)
            })
        });
    }

    /// Binds an image if it is loaded.
    pub fn bind(
        &mut self,
        device: &Device,
        pipelines: &Pipelines,
        id: AssetId<Image>,
        images: &RenderAssets<GpuImage>,
    ) {
        let Some(image) = images.get(id) else { return };
        self.0.entry(id).or_insert_with(|| BoundImage {
            texture: image.texture.id(),
            sampler: image.sampler.id(),
            group: is_filterable(device, image).then(|| {
                let layered = image.texture.depth_or_array_layers() > 1;
                let of_layers = TextureViewDimension::D2Array;
                let view = image.texture.create_view(&TextureViewDescriptor {
                    dimension: layered.then_some(of_layers),
                    ..TextureViewDescriptor::default()
                });
                let group = pipelines.bind_image(device, &view, layered, &image.sampler);
                ImageGroup { group, layered }
            }),
        });
    }

    /// An image that is bound.
    pub fn get(&self, id: AssetId<Image>) -> Option<&ImageGroup> {
        self.0.get(&id)?.group.as_ref()
    }
}

/// Returns whether shaders can sample an image with a filter.
fn is_filterable(device: &Device, image: &GpuImage) -> bool {
    let sampled = image.texture.format().sample_type(None, Some(device.features()));
    image.texture.dimension() == TextureDimension::D2
        && image.texture.sample_count() == 1
        && image.texture.usage().contains(TextureUsages::TEXTURE_BINDING)
        && sampled == Some(TextureSampleType::Float { filterable: true })
}
