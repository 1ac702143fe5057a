//! Programs that draw one triangle over a target.

use crate::pipeline::{bind, layout_of};
use crate::programs::Program;
use crate::shader_module::shader_module;
use crate::shaders;
use wgpu::{
    BindGroup, BindGroupLayout, BindingResource, CompareFunction, DepthStencilState, Device,
    FragmentState, MultisampleState, PipelineCompilationOptions, PipelineLayoutDescriptor,
    RenderPipeline, RenderPipelineDescriptor, ShaderModule, ShaderStages, TextureFormat,
    VertexState,
};

/// The attachments of a render pass, as far as they affect pipelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Target {
    /// Format of the colour attachment's view.
    pub format: TextureFormat,
    /// Samples per pixel, 1 without multisampling.
    pub samples: u32,
    /// Format of the depth attachment, if the pass has one; it is neither read nor written.
    pub depth: Option<TextureFormat>,
}

impl From<TextureFormat> for Target {
    /// A target with one sample per pixel and no depth.
    fn from(format: TextureFormat) -> Self {
        Self { format, samples: 1, depth: None }
    }
}

/// A compiled shader and its bindings. Its entry points are that of vertices and that of fragments.
#[derive(Debug)]
pub struct DrawProgram {
    program: Program,
    module: ShaderModule,
    layout: BindGroupLayout,
}

impl DrawProgram {
    pub fn new(device: &Device, program: Program) -> Self {
        let shader = program.shader;
        let module = shader_module(device, shaders::label(shader), shaders::text(shader));
        Self { program, module, layout: layout_of(device, &program, ShaderStages::FRAGMENT) }
    }

    /// Binds resources to the slots, in the order of the program's declaration.
    pub fn bind<'a>(
        &self,
        device: &Device,
        resources: impl IntoIterator<Item = BindingResource<'a>>,
    ) -> BindGroup {
        bind(device, &self.program, &self.layout, resources)
    }

    /// Creates the pipeline that draws on a target. `constants` are the values of the shader's overrides.
    pub fn pipeline(
        &self,
        device: &Device,
        target: Target,
        constants: &[(&str, f64)],
    ) -> RenderPipeline {
        let Self { program, module, layout } = self;
        let label = Some(shaders::label(program.shader));
        let layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label,
            bind_group_layouts: &[Some(layout)],
            immediate_size: 0,
        });
        let entry = |number: usize| program.entries.get(number).copied();
        device.create_render_pipeline(&RenderPipelineDescriptor {
            label,
            layout: Some(&layout),
            vertex: VertexState {
                module,
                entry_point: entry(0),
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
                module,
                entry_point: entry(1),
                compilation_options: PipelineCompilationOptions {
                    constants,
                    ..PipelineCompilationOptions::default()
                },
                targets: &[Some(target.format.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}
