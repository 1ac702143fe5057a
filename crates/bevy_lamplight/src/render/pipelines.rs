//! The render pipelines: matter and light layers on the grid, and what glows or has normals on the screen.

use crate::quads::{Quad, QuadMaterial};
use bevy::prelude::{Commands, Resource};
use bytemuck::{Pod, Zeroable};
use lamplight::srgb;
use lamplight_wgpu::wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor,
    BindGroupLayoutEntry, BindingResource, BindingType, BlendComponent, BlendFactor,
    BlendOperation, BlendState, BufferBindingType, ColorTargetState, ColorWrites, Device,
    FragmentState, PipelineCompilationOptions, PipelineLayoutDescriptor, RenderPipeline,
    RenderPipelineDescriptor, Sampler, SamplerBindingType, ShaderModule, ShaderModuleDescriptor,
    ShaderSource, ShaderStages, TextureFormat, TextureSampleType, TextureView,
    TextureViewDimension, VertexAttribute, VertexBufferLayout, VertexFormat, VertexState,
    VertexStepMode,
};
use std::borrow::Cow;
use std::mem::offset_of;
use std::sync::OnceLock;

/// The map from cells to a render target; `TargetTransform` of shaders/quads.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct TargetTransform {
    pub x_axis: [f32; 2],
    pub y_axis: [f32; 2],
    pub origin: [f32; 2],
    /// Pixels of the target.
    pub size: [f32; 2],
    /// World units per cell.
    pub cell: f32,
    /// Padding to 16 bytes, which WebGL 2 needs.
    pub unused: [f32; 3],
}

/// Formats of the sums over everything in a cell: emission, albedo, tint, opacity.
pub const SUMS: [TextureFormat; 4] = [
    TextureFormat::Rgba16Float,
    TextureFormat::Rgba16Float,
    TextureFormat::Rgba16Float,
    TextureFormat::R16Float,
];
/// Formats of matter: emission, tint and opacity, albedo. See [`lamplight_wgpu::Textures`].
pub const MATTER: [TextureFormat; 3] = [TextureFormat::Rgba16Float; 3];
/// Format of the emission coefficient of lamps.
pub const LAMPS: TextureFormat = TextureFormat::Rgba16Float;
/// Format of the texture of what glows on the screen.
pub const GLOW: TextureFormat = TextureFormat::Rgba16Float;
/// Format of the texture of normals on the screen.
pub const NORMALS: TextureFormat = TextureFormat::Rgba16Float;

/// Format of the light layers of cells.
pub const MASKS: TextureFormat = TextureFormat::R8Unorm;

/// The entry point of the vertices of quads.
const PLACE: &str = "place";

/// The attributes of quads and of their materials, instance by instance: `QuadIn` of shaders/quads.wgsl. Vertex buffers,
/// because under WebGL 2 shaders read no others.
const INSTANCES: [Option<VertexBufferLayout>; 2] = [
    Some(VertexBufferLayout {
        array_stride: size_of::<Quad>() as u64,
        step_mode: VertexStepMode::Instance,
        attributes: &[
            attribute(0, offset_of!(Quad, world), VertexFormat::Float32x4),
            attribute(1, offset_of!(Quad, world) + 16, VertexFormat::Float32x4),
            attribute(2, offset_of!(Quad, world) + 32, VertexFormat::Float32x4),
            attribute(3, offset_of!(Quad, color), VertexFormat::Float32x4),
            attribute(4, offset_of!(Quad, shape), VertexFormat::Uint32x2),
            attribute(5, offset_of!(Quad, param), VertexFormat::Float32),
        ],
    }),
    Some(VertexBufferLayout {
        array_stride: size_of::<QuadMaterial>() as u64,
        step_mode: VertexStepMode::Instance,
        attributes: &[
            attribute(6, offset_of!(QuadMaterial, emission), VertexFormat::Float32x4),
            attribute(7, offset_of!(QuadMaterial, tint), VertexFormat::Float32x4),
            attribute(8, offset_of!(QuadMaterial, albedo), VertexFormat::Float32x3),
            attribute(9, offset_of!(QuadMaterial, bits), VertexFormat::Uint32),
        ],
    }),
];

const fn attribute(shader_location: u32, offset: usize, format: VertexFormat) -> VertexAttribute {
    VertexAttribute { format, offset: offset as u64, shader_location }
}

/// Pipelines and bind group layouts, compiled once.
#[derive(Resource)]
pub struct Pipelines {
    pub quads_layout: BindGroupLayout,
    image_layouts: ByLayers<BindGroupLayout>,
    sums_layout: BindGroupLayout,
    /// The shader of quads.
    modules: ByLayers<OnceLock<ShaderModule>>,
    /// By [`QuadPass`]. Those of most scenes are compiled at once, others when they are first needed.
    quads: [ByLayers<OnceLock<RenderPipeline>>; 4],
    pub resolve: RenderPipeline,
    /// By the layers of the image, and by those of its normal map, after the one without.
    normals: ByLayers<[OnceLock<RenderPipeline>; 3]>,
}

/// Drops the pipelines when Bevy begins to render, which it does again on another device after one was lost.
pub fn forget(mut commands: Commands) {
    commands.remove_resource::<Pipelines>();
}

/// One for images of a single layer, and one for those of several, as of tilesets. Under WebGL 2 no texture is read as both.
type ByLayers<T> = [T; 2];

/// A pass that draws quads with their images alone.
#[derive(Clone, Copy, Debug)]
pub enum QuadPass {
    /// Sums over everything in a cell.
    Matter = 0,
    /// Lamps that glow.
    Lamps = 1,
    /// Emitted light on the screen.
    Glow = 2,
    /// Light layers.
    Masks = 3,
}

impl QuadPass {
    /// The label of its pipelines, the entry point of its fragments, and its targets.
    fn parts(self) -> (&'static str, &'static str, Vec<Option<ColorTargetState>>) {
        match self {
            Self::Matter => {
                ("lamplight matter", "matter", SUMS.map(|of| color_target(of, Some(OVER))).into())
            }
            Self::Lamps => ("lamplight lamps", "lamp", vec![color_target(LAMPS, Some(ADD))]),
            Self::Glow => ("lamplight glow", "glow", vec![color_target(GLOW, Some(OVER))]),
            Self::Masks => ("lamplight masks", "layers", vec![color_target(MASKS, None)]),
        }
    }
}

impl Pipelines {
    /// Compiles what every scene needs.
    pub fn new(device: &Device) -> Self {
        let texture = |filterable, view_dimension| BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable },
            view_dimension,
            multisampled: false,
        };
        let quads_layout = layout(
            device,
            "lamplight quads",
            ShaderStages::VERTEX_FRAGMENT,
            &[BindingType::Buffer {
                ty: BufferBindingType::Uniform,
                has_dynamic_offset: false,
                min_binding_size: None,
            }],
        );
        let image_layouts = [TextureViewDimension::D2, TextureViewDimension::D2Array].map(|of| {
            let sampler = BindingType::Sampler(SamplerBindingType::Filtering);
            let image = [texture(true, of), sampler];
            layout(device, "lamplight image", ShaderStages::FRAGMENT, &image)
        });
        let sums = [texture(false, TextureViewDimension::D2); 4];
        let sums_layout = layout(device, "lamplight sums", ShaderStages::FRAGMENT, &sums);
        let resolve = include_str!("../../shaders/resolve.wgsl").to_owned();
        let resolve = module(device, "resolve", resolve);
        let matter = MATTER.map(|format| color_target(format, None));
        let (label, entries) = ("lamplight resolve", ["cover", "resolve"]);
        let compiled = Self {
            resolve: pipeline(device, label, &[&sums_layout], &resolve, entries, &[], &matter),
            modules: Default::default(),
            quads: Default::default(),
            normals: Default::default(),
            quads_layout,
            image_layouts,
            sums_layout,
        };
        // Nobody waits for these when the first lamp or sign comes into view.
        for pass in [QuadPass::Matter, QuadPass::Lamps, QuadPass::Glow] {
            compiled.quads(device, pass, false);
        }
        compiled
    }

    /// The pipeline of a pass for quads whose image is `layered` or not.
    pub fn quads(&self, device: &Device, pass: QuadPass, layered: bool) -> &RenderPipeline {
        let of_image = usize::from(layered);
        self.quads[pass as usize][of_image].get_or_init(|| {
            let module =
                self.modules[of_image].get_or_init(|| module(device, "quads", quads(layered)));
            let layouts = [&self.quads_layout, &self.image_layouts[of_image]];
            let (label, fragment, targets) = pass.parts();
            pipeline(device, label, &layouts, module, [PLACE, fragment], &[], &targets)
        })
    }

    /// The pipeline of normals for quads whose image, and whose normal map if they have one, is layered or not. The normal map
    /// is the third bind group.
    pub fn normals(
        &self,
        device: &Device,
        image_layered: bool,
        map_layered: Option<bool>,
    ) -> &RenderPipeline {
        let number = map_layered.map_or(0, |layered| 1 + usize::from(layered));
        self.normals[usize::from(image_layered)][number].get_or_init(|| {
            let map = map_layered.unwrap_or(false);
            let text = [
                &quads(image_layered)[..],
                include_str!("../../shaders/normals.wgsl"),
                &sampling(2, "normal_map", map),
            ];
            let module = module(device, "normals", text.concat());
            let srgb = [
                ("STRAIGHT", f64::from(srgb::STRAIGHT)),
                ("SLOPE", f64::from(srgb::SLOPE)),
                ("OFFSET", f64::from(srgb::OFFSET)),
                ("GAMMA", f64::from(srgb::GAMMA)),
            ];
            let target = [color_target(NORMALS, Some(OVER))];
            let [image, map] = [image_layered, map].map(|of| &self.image_layouts[usize::from(of)]);
            let layouts = [&self.quads_layout, image, map];
            let (fragment, groups, constants) = match map_layered {
                Some(_) => ("tilted", 3, &srgb[..]),
                None => ("untilted", 2, &[][..]),
            };
            let entries = [PLACE, fragment];
            let label = "lamplight normals";
            pipeline(device, label, &layouts[..groups], &module, entries, constants, &target)
        })
    }

    /// Binds the sums.
    pub fn bind_sums(&self, device: &Device, sums: &[TextureView; 4]) -> BindGroup {
        let sums = sums.each_ref().map(BindingResource::TextureView);
        bind(device, "lamplight sums", &self.sums_layout, sums)
    }

    /// Binds an image, with a view of all of its layers if it is `layered`.
    pub fn bind_image(
        &self,
        device: &Device,
        view: &TextureView,
        layered: bool,
        sampler: &Sampler,
    ) -> BindGroup {
        let image = [BindingResource::TextureView(view), BindingResource::Sampler(sampler)];
        bind(device, "lamplight image", &self.image_layouts[usize::from(layered)], image)
    }
}

/// Binds resources in the order of their layout.
pub fn bind<'a>(
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

/// The over operator with premultiplied alpha.
const OVER: BlendState = blend(BlendFactor::OneMinusSrcAlpha);

/// The sum.
const ADD: BlendState = blend(BlendFactor::One);

const fn blend(dst_factor: BlendFactor) -> BlendState {
    let src_factor = BlendFactor::One;
    let component = BlendComponent { src_factor, dst_factor, operation: BlendOperation::Add };
    BlendState { color: component, alpha: component }
}

fn color_target(format: TextureFormat, blend: Option<BlendState>) -> Option<ColorTargetState> {
    Some(ColorTargetState { format, blend, write_mask: ColorWrites::ALL })
}

/// Returns the shader of quads whose images have a single layer, or several.
fn quads(layered: bool) -> String {
    include_str!("../../shaders/quads.wgsl").to_owned() + &sampling(1, "image", layered)
}

/// Returns the declarations of an image in a bind group, and of the function by which shaders sample it.
fn sampling(group: u32, name: &str, layered: bool) -> String {
    let (kind, layer) = if layered { ("texture_2d_array", "layer, ") } else { ("texture_2d", "") };
    format!(
        "@group({group}) @binding(0) var {name}: {kind}<f32>;
        @group({group}) @binding(1) var {name}_sampler: sampler;
        fn {name}_at(at: vec2f, layer: u32) -> vec4f {{
            return textureSampleLevel({name}, {name}_sampler, at, {layer}0.0);
        }}"
    )
}

fn module(device: &Device, label: &str, text: String) -> ShaderModule {
    device.create_shader_module(ShaderModuleDescriptor {
        label: Some(label),
        source: ShaderSource::Wgsl(Cow::Owned(text)),
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
    constants: &[(&str, f64)],
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
            buffers: if vertex == PLACE { &INSTANCES } else { &[] },
        },
        primitive: Default::default(),
        depth_stencil: None,
        multisample: Default::default(),
        fragment: Some(FragmentState {
            module,
            entry_point: Some(fragment),
            compilation_options: PipelineCompilationOptions { constants, ..Default::default() },
            targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}
