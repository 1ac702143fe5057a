//! From light to what is seen: the GPU's `stages/display.rs` of the library.

use crate::shaders;
use bytemuck::{Pod, Zeroable};
use lamplight::stages::display::{
    ACES, ACES_LUMA, ACES_WHITE, AGX_CONTRAST, AGX_GAMMA, AGX_INSET, AGX_OUTSET, AGX_STOPS,
    BRIGHTEST,
};
use lamplight::{Display, Rgb, ToneMap, srgb};
#[cfg(test)]
use std::mem::offset_of;
use wgpu::{
    BindGroupLayout, BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType,
    BufferBindingType, CompareFunction, DepthStencilState, Device, FragmentState, MultisampleState,
    PipelineCompilationOptions, PipelineLayoutDescriptor, RenderPipeline, RenderPipelineDescriptor,
    ShaderModule, ShaderModuleDescriptor, ShaderSource, ShaderStages, TextureFormat,
    TextureSampleType, TextureViewDimension, VertexState,
};

/// `Look` of shaders/display.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Look {
    pub corner: [f32; 2],
    pub right: [f32; 2],
    pub down: [f32; 2],
    gain: f32,
    tonemap: u32,
    pub filter_light: u32,
    pub color_from: u32,
    pub color_glows: u32,
    pub more_light: u32,
    luma: Rgb,
    brightest: f32,
    pub ambient: Rgb,
    pub keep_alpha: u32,
    aces: [f32; 4],
    aces_end: f32,
    aces_white: f32,
    stops: [f32; 2],
    inset: [[f32; 4]; 3],
    outset: [[f32; 4]; 3],
    contrast: [[f32; 4]; 2],
}

impl Look {
    /// Fields in order, with where they begin.
    #[cfg(test)]
    pub const OFFSETS: [(&'static str, usize); 20] = [
        ("corner", offset_of!(Look, corner)),
        ("right", offset_of!(Look, right)),
        ("down", offset_of!(Look, down)),
        ("gain", offset_of!(Look, gain)),
        ("tonemap", offset_of!(Look, tonemap)),
        ("filter_light", offset_of!(Look, filter_light)),
        ("color_from", offset_of!(Look, color_from)),
        ("color_glows", offset_of!(Look, color_glows)),
        ("more_light", offset_of!(Look, more_light)),
        ("luma", offset_of!(Look, luma)),
        ("brightest", offset_of!(Look, brightest)),
        ("ambient", offset_of!(Look, ambient)),
        ("keep_alpha", offset_of!(Look, keep_alpha)),
        ("aces", offset_of!(Look, aces)),
        ("aces_end", offset_of!(Look, aces_end)),
        ("aces_white", offset_of!(Look, aces_white)),
        ("stops", offset_of!(Look, stops)),
        ("inset", offset_of!(Look, inset)),
        ("outset", offset_of!(Look, outset)),
        ("contrast", offset_of!(Look, contrast)),
    ];

    /// All of a grid of this size.
    pub fn new(display: &Display, size: [u32; 2]) -> Self {
        let [a, b, c, d, e] = ACES;
        let [x6, x5, x4, x3, x2, x1, x0] = AGX_CONTRAST;
        Self {
            corner: [0.0; 2],
            right: [size[0] as f32, 0.0],
            down: [0.0, size[1] as f32],
            gain: display.gain(),
            tonemap: match display.tonemap {
                ToneMap::None => 0,
                ToneMap::Reinhard => 1,
                ToneMap::Aces => 2,
                ToneMap::Agx => 3,
            },
            filter_light: 0,
            color_from: 0,
            color_glows: 0,
            more_light: 0,
            luma: ACES_LUMA,
            brightest: BRIGHTEST,
            ambient: [0.0; 3],
            keep_alpha: 0,
            aces: [a, b, c, d],
            aces_end: e,
            aces_white: ACES_WHITE,
            stops: AGX_STOPS,
            inset: columns(&AGX_INSET),
            outset: columns(&AGX_OUTSET),
            contrast: [[x6, x5, x4, x3], [x2, x1, x0, AGX_GAMMA]],
        }
    }

    /// Caps what is shown at what a half float holds; every tone map is flat there.
    pub fn keep_finite(&mut self) {
        self.brightest = HALF_MAX;
    }
}

/// Largest finite half float.
const HALF_MAX: f32 = 65504.0;

/// The columns of a matrix given by rows, each as long as uniforms want it.
fn columns(rows: &[Rgb; 3]) -> [[f32; 4]; 3] {
    std::array::from_fn(|c| [rows[0][c], rows[1][c], rows[2][c], 0.0])
}

/// What a render pass is made of, as far as a pipeline has to know.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Target {
    /// Format of the colour attachment's view.
    pub format: TextureFormat,
    /// Samples a pixel, 1 without multisampling.
    pub samples: u32,
    /// Format of the depth attachment, where the pass has one; it is neither read nor written.
    pub depth: Option<TextureFormat>,
}

impl From<TextureFormat> for Target {
    /// One sample a pixel, no depth.
    fn from(format: TextureFormat) -> Self {
        Self { format, samples: 1, depth: None }
    }
}

/// Whether shaders have to encode for a format: it holds what screens show and does not encode by
/// itself. None: a format that pictures cannot be drawn to.
pub fn encodes(format: TextureFormat) -> Option<bool> {
    use TextureFormat::{
        Bgra8Unorm, Bgra8UnormSrgb, Rg11b10Ufloat, Rgb10a2Unorm, Rgba8Unorm, Rgba8UnormSrgb,
        Rgba16Float, Rgba32Float,
    };
    match format {
        Rgba8Unorm | Bgra8Unorm | Rgb10a2Unorm => Some(true),
        Rgba8UnormSrgb | Bgra8UnormSrgb | Rgba16Float | Rgba32Float | Rg11b10Ufloat => Some(false),
        _ => None,
    }
}

/// The shader, compiled, and what it is bound to.
#[derive(Debug)]
pub struct Shading {
    module: ShaderModule,
    pub layout: BindGroupLayout,
}

impl Shading {
    pub fn new(device: &Device) -> Self {
        let shader = &shaders::DISPLAY;
        let module = device.create_shader_module(ShaderModuleDescriptor {
            label: Some(shader.name),
            source: ShaderSource::Wgsl(shader.text().into()),
        });
        let buffer =
            |ty| BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
        let texture = BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable: false },
            view_dimension: TextureViewDimension::D2,
            multisampled: false,
        };
        let uniform = buffer(BufferBindingType::Uniform);
        let light = buffer(BufferBindingType::Storage { read_only: true });
        let entries: Vec<_> = (0..)
            .zip([uniform, uniform, light, texture, texture, texture, texture, texture])
            .map(|(binding, ty)| BindGroupLayoutEntry {
                binding,
                visibility: ShaderStages::FRAGMENT,
                ty,
                count: None,
            })
            .collect();
        let layout = device.create_bind_group_layout(&BindGroupLayoutDescriptor {
            label: Some(shader.name),
            entries: &entries,
        });
        Self { module, layout }
    }

    /// A pipeline for a target whose format is drawn to, told whether to encode.
    pub fn pipeline(&self, device: &Device, target: Target, encode: bool) -> RenderPipeline {
        let label = Some(shaders::DISPLAY.name);
        let layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(&self.layout)],
            immediate_size: 0,
        });
        let constants = [
            ("ENCODE", f64::from(encode)),
            ("STRAIGHT", f64::from(srgb::STRAIGHT)),
            ("SLOPE", f64::from(srgb::SLOPE)),
            ("OFFSET", f64::from(srgb::OFFSET)),
            ("GAMMA", f64::from(srgb::GAMMA)),
        ];
        device.create_render_pipeline(&RenderPipelineDescriptor {
            label,
            layout: Some(&layout),
            vertex: VertexState {
                module: &self.module,
                entry_point: Some("cover"),
                compilation_options: PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: Default::default(),
            depth_stencil: target.depth.map(|format| DepthStencilState {
                format,
                depth_write_enabled: Some(false),
                depth_compare: Some(CompareFunction::Always),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: MultisampleState { count: target.samples, ..MultisampleState::default() },
            fragment: Some(FragmentState {
                module: &self.module,
                entry_point: Some("show"),
                compilation_options: PipelineCompilationOptions {
                    constants: &constants,
                    ..PipelineCompilationOptions::default()
                },
                targets: &[Some(target.format.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
