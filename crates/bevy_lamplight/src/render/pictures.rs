//! Pictures as shaders see them: every one as an array of layers, so that sprites and tile sets are
//! drawn alike.

use super::stage::Pipelines;
use bevy::asset::AssetId;
use bevy::image::Image;
use bevy::platform::collections::HashMap;
use bevy::prelude::Resource;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_resource::{TextureId, TextureViewDescriptor};
use bevy::render::texture::GpuImage;
use lamplight_wgpu::wgpu::{
    BindGroup, Device, TextureDimension, TextureSampleType, TextureUsages, TextureViewDimension,
};

/// Bound pictures.
#[derive(Resource, Default)]
pub struct PictureBindings(HashMap<AssetId<Image>, Bound>);

struct Bound {
    texture: TextureId,
    /// None where shaders cannot read it.
    group: Option<BindGroup>,
}

impl PictureBindings {
    /// Forgets pictures that are no more.
    pub fn sweep(&mut self, images: &RenderAssets<GpuImage>) {
        self.0.retain(|&id, bound| {
            images.get(id).is_some_and(|image| image.texture.id() == bound.texture)
        });
    }

    /// Binds a picture that is loaded.
    pub fn bind(
        &mut self,
        device: &Device,
        pipelines: &Pipelines,
        id: AssetId<Image>,
        images: &RenderAssets<GpuImage>,
    ) {
        let Some(image) = images.get(id) else { return };
        self.0.entry(id).or_insert_with(|| Bound {
            texture: image.texture.id(),
            group: is_readable(device, image).then(|| {
                let view = image.texture.create_view(&TextureViewDescriptor {
                    dimension: Some(TextureViewDimension::D2Array),
                    ..TextureViewDescriptor::default()
                });
                pipelines.bind_picture(device, &view, &image.sampler)
            }),
        });
    }

    /// A picture that is bound.
    pub fn get(&self, id: AssetId<Image>) -> Option<&BindGroup> {
        self.0.get(&id)?.group.as_ref()
    }
}

/// Whether shaders can read and filter it.
fn is_readable(device: &Device, image: &GpuImage) -> bool {
    let sampled = image.texture.format().sample_type(None, Some(device.features()));
    image.texture.dimension() == TextureDimension::D2
        && image.texture.sample_count() == 1
        && image.texture.usage().contains(TextureUsages::TEXTURE_BINDING)
        && sampled == Some(TextureSampleType::Float { filterable: true })
}
