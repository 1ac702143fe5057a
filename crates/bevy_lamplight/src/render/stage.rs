//! The pipelines that draw pieces: matter on the grid, and what glows on the screen.

use super::draw::Draw;
use super::pictures::PictureBindings;
use bevy::prelude::Resource;
use bytemuck::{Pod, Zeroable};
use lamplight_wgpu::wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor,
    BindGroupLayoutEntry, BindingResource, BindingType, BlendComponent, BlendFactor,
    BlendOperation, BlendState, Buffer, BufferBindingType, BufferDescriptor, BufferUsages,
    ColorTargetState, ColorWrites, Device, FragmentState, PipelineLayoutDescriptor, Queue,
    RenderPass, RenderPipeline, RenderPipelineDescriptor, Sampler, SamplerBindingType,
    ShaderModule, ShaderModuleDescriptor, ShaderSource, ShaderStages, TextureFormat,
    TextureSampleType, TextureView, TextureViewDimension, VertexState,
};
use lamplight_wgpu::{Error, Result};
use std::borrow::Cow;

/// `Stage` of shaders/pieces.wgsl: from cells to a target.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Stage {
    pub x_axis: [f32; 2],
    pub y_axis: [f32; 2],
    pub origin: [f32; 2],
    pub size: [f32; 2],
    pub cell: f32,
    pub unused: f32,
}

/// Sums over what lies in a cell: emission, albedo, tint, opacity.
pub const SUMS: [TextureFormat; 4] = [
    TextureFormat::Rgba16Float,
    TextureFormat::Rgba16Float,
    TextureFormat::Rgba16Float,
    TextureFormat::R16Float,
];
/// Emission, tint and opacity, albedo: as [`lamplight_wgpu::Textures`] wants them.
pub const MATTER: [TextureFormat; 3] = [TextureFormat::Rgba16Float; 3];
/// What glows on the screen.
pub const GLOW: TextureFormat = TextureFormat::Rgba16Float;

/// What is compiled once.
#[derive(Resource)]
pub struct Pipelines {
    stage_layout: BindGroupLayout,
    picture_layout: BindGroupLayout,
    sums_layout: BindGroupLayout,
    pub matter: RenderPipeline,
    pub glow: RenderPipeline,
    pub settle: RenderPipeline,
}

impl Pipelines {
    pub fn new(device: &Device) -> Self {
        let buffer =
            |ty| BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let texture = |filterable, view_dimension| BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable },
            view_dimension,
            multisampled: false,
        };
        let list = buffer(BufferBindingType::Storage { read_only: true });
        let stage_layout = layout(
            device,
            "lamplight stage",
            ShaderStages::VERTEX_FRAGMENT,
            &[buffer(BufferBindingType::Uniform), list, list],
        );
        let picture_layout = layout(
            device,
            "lamplight picture",
            ShaderStages::FRAGMENT,
            &[
                texture(true, TextureViewDimension::D2Array),
                BindingType::Sampler(SamplerBindingType::Filtering),
            ],
        );
        let sums = [texture(false, TextureViewDimension::D2); 4];
        let sums_layout = layout(device, "lamplight sums", ShaderStages::FRAGMENT, &sums);

        let pieces = module(device, "pieces", include_str!("../../shaders/pieces.wgsl"));
        let settle = module(device, "settle", include_str!("../../shaders/settle.wgsl"));
        let of_pieces = [&stage_layout, &picture_layout];
        let sums = SUMS.map(|format| drawn(format, Some(COVERS)));
        let found = MATTER.map(|format| drawn(format, None));
        let pipeline = |label, layouts: &[&BindGroupLayout], module, entries, targets: &[_]| {
            pipeline(device, label, layouts, module, entries, targets)
        };
        Self {
            matter: pipeline("lamplight matter", &of_pieces, &pieces, ["place", "matter"], &sums),
            glow: pipeline(
                "lamplight glow",
                &of_pieces,
                &pieces,
                ["place", "glow"],
                &[drawn(GLOW, Some(COVERS))],
            ),
            settle: pipeline(
                "lamplight settle",
                &[&sums_layout],
                &settle,
                ["cover", "settle"],
                &found,
            ),
            stage_layout,
            picture_layout,
            sums_layout,
        }
    }

    /// Binds the sums.
    pub fn bind_sums(&self, device: &Device, sums: &[TextureView; 4]) -> BindGroup {
        let sums = sums.each_ref().map(BindingResource::TextureView);
        bind(device, "lamplight sums", &self.sums_layout, sums)
    }

    /// Binds a picture.
    pub fn bind_picture(
        &self,
        device: &Device,
        view: &TextureView,
        sampler: &Sampler,
    ) -> BindGroup {
        let picture = [BindingResource::TextureView(view), BindingResource::Sampler(sampler)];
        bind(device, "lamplight picture", &self.picture_layout, picture)
    }
}

/// Binds resources in the order of their layout.
fn bind<'a>(
    device: &Device,
    label: &str,
    layout: &BindGroupLayout,
    resources: impl IntoIterator<Item = BindingResource<'a>>,
) -> BindGroup {
    let entries: Vec<_> = (0..)
        .zip(resources)
        .map(|(binding, resource)| BindGroupEntry { binding, resource })
        .collect();
    device.create_bind_group(&BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

/// What is drawn already shows through by what a share leaves of it.
const COVERS: BlendState = {
    let component = BlendComponent {
        src_factor: BlendFactor::One,
        dst_factor: BlendFactor::OneMinusSrcAlpha,
        operation: BlendOperation::Add,
    };
    BlendState { color: component, alpha: component }
};

fn drawn(format: TextureFormat, blend: Option<BlendState>) -> Option<ColorTargetState> {
    Some(ColorTargetState { format, blend, write_mask: ColorWrites::ALL })
}

fn module(device: &Device, label: &str, text: &'static str) -> ShaderModule {
    device.create_shader_module(ShaderModuleDescriptor {
        label: Some(label),
        source: ShaderSource::Wgsl(Cow::Borrowed(text)),
    })
}

fn layout(
    device: &Device,
    label: &str,
    visibility: ShaderStages,
    bindings: &[BindingType],
) -> BindGroupLayout {
    let entries: Vec<_> = (0..)
        .zip(bindings)
        .map(|(binding, &ty)| BindGroupLayoutEntry { binding, visibility, ty, count: None })
        .collect();
    device.create_bind_group_layout(&BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &entries,
    })
}

fn pipeline(
    device: &Device,
    label: &str,
    layouts: &[&BindGroupLayout],
    module: &ShaderModule,
    [vertex, fragment]: [&str; 2],
    targets: &[Option<ColorTargetState>],
) -> RenderPipeline {
    let layouts: Vec<_> = layouts.iter().copied().map(Some).collect();
    let layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
        label: Some(label),
        bind_group_layouts: &layouts,
        immediate_size: 0,
    });
    device.create_render_pipeline(&RenderPipelineDescriptor {
        label: Some(label),
        layout: Some(&layout),
        vertex: VertexState {
            module,
            entry_point: Some(vertex),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: Default::default(),
            targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

/// Pieces on the GPU, for one stage.
#[derive(Default)]
pub struct Staged {
    lists: Option<Lists>,
    stages: [Option<Buffer>; 2],
    groups: [Option<BindGroup>; 2],
}

/// Pieces and substances.
struct Lists {
    pieces: Buffer,
    substances: Buffer,
}

/// Which of the two stages pieces are drawn on.
#[derive(Clone, Copy)]
pub enum On {
    Grid = 0,
    Screen = 1,
}

impl Staged {
    /// Hands over what is drawn and where, the grid first. Buffers grow by half, and stay. An error where
    /// the device binds no buffer as large.
    pub fn write(
        &mut self,
        device: &Device,
        queue: &Queue,
        pipelines: &Pipelines,
        draw: &Draw,
        stages: [Stage; 2],
    ) -> Result<()> {
        let lists = [bytemuck::cast_slice(&draw.pieces), bytemuck::cast_slice(&draw.substances)];
        let holds = |buffers: &Lists| {
            [&buffers.pieces, &buffers.substances]
                .iter()
                .zip(lists)
                .all(|(buffer, list)| buffer.size() >= list.len() as u64)
        };
        if !self.lists.as_ref().is_some_and(holds) {
            let limits = device.limits();
            let most = limits.max_buffer_size.min(limits.max_storage_buffer_binding_size);
            let list = |label, bytes: &[u8]| {
                let needed = bytes.len() as u64;
                let size = room(needed, most).ok_or_else(|| {
                    Error::Device(format!("{label} take {needed} bytes, and it binds {most}"))
                })?;
                Ok::<_, Error>(buffer(device, label, size, BufferUsages::STORAGE))
            };
            self.lists = Some(Lists {
                pieces: list("lamplight pieces", lists[0])?,
                substances: list("lamplight substances", lists[1])?,
            });
            self.groups = [None, None];
        }
        let Some(buffers) = &self.lists else { return Ok(()) };
        queue.write_buffer(&buffers.pieces, 0, lists[0]);
        queue.write_buffer(&buffers.substances, 0, lists[1]);
        for ((own, group), stage) in self.stages.iter_mut().zip(&mut self.groups).zip(stages) {
            let own = own.get_or_insert_with(|| {
                buffer(device, "lamplight stage", size_of::<Stage>() as u64, BufferUsages::UNIFORM)
            });
            queue.write_buffer(own, 0, bytemuck::bytes_of(&stage));
            group.get_or_insert_with(|| {
                let list = [&*own, &buffers.pieces, &buffers.substances];
                let list = list.map(|buffer| buffer.as_entire_binding());
                bind(device, "lamplight stage", &pipelines.stage_layout, list)
            });
        }
        Ok(())
    }

    /// Draws all whose pictures are loaded; on the screen what is seen there.
    pub fn draw(
        &self,
        pass: &mut RenderPass,
        pipeline: &RenderPipeline,
        draw: &Draw,
        pictures: &PictureBindings,
        on: On,
    ) {
        let Some(group) = &self.groups[on as usize] else { return };
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, group, &[]);
        let batches = draw.batches.iter().filter(|batch| batch.is_seen || matches!(on, On::Grid));
        for batch in batches {
            let Some(picture) = pictures.get(batch.image) else { continue };
            pass.set_bind_group(1, picture, &[]);
            pass.draw(0..6, batch.pieces.clone());
        }
    }
}

/// Bytes of a buffer for so many, with room to grow; none where it cannot have as many.
fn room(needed: u64, most: u64) -> Option<u64> {
    const LEAST: u64 = 1 << 12;
    let ample = (needed * 3 / 2).next_multiple_of(LEAST).max(LEAST);
    (needed <= most).then(|| ample.min(most))
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
    fn buffers_grow_up_to_what_the_device_binds() {
        assert_eq!(room(0, 1 << 20), Some(1 << 12));
        assert_eq!(room(8192, 1 << 20), Some(12_288));
        assert_eq!(room(900_000, 1 << 20), Some(1 << 20));
        assert_eq!(room((1 << 20) + 1, 1 << 20), None);
    }
}
