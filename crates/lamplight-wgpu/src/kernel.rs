//! A compute pipeline, what it is bound to, and how often it runs.

use crate::cost::Traffic;
use crate::shaders::Shader;
use std::num::NonZeroU64;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor,
    BindGroupLayoutEntry, BindingResource, BindingType, Buffer, BufferBindingType, ComputePass,
    ComputePipeline, ComputePipelineDescriptor, Device, PipelineCompilationOptions,
    PipelineLayoutDescriptor, ShaderModuleDescriptor, ShaderSource, ShaderStages,
    StorageTextureAccess, TextureFormat, TextureSampleType, TextureViewDimension,
};

/// Side of a workgroup, px, in shaders that run over cells.
pub const WORKGROUP: u32 = 8;

/// What is bound to a place of a shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// A few numbers for a whole frame.
    Uniform,
    /// What a run is told: which of the entries of a buffer, is said when it runs.
    Step,
    /// A picture that is read texel by texel.
    Texture,
    /// A picture of half floats that is written.
    Picture,
    /// A buffer that is read.
    Read,
    /// A buffer that is written, too.
    Write,
}

/// Bytes from one step's number to the next: what every device can bind to.
pub const STEP_BYTES: u32 = 256;

/// A shader's entry point, compiled.
#[derive(Clone, Debug)]
pub struct Kernel {
    pub label: &'static str,
    pub entry: &'static str,
    pipeline: ComputePipeline,
}

/// The entry points of a shader, compiled, and how they are bound.
#[derive(Debug)]
pub struct Kernels {
    label: &'static str,
    layout: BindGroupLayout,
    slots: Vec<Slot>,
    pub entries: Vec<Kernel>,
}

impl Kernels {
    /// Compiles entry points that share their bindings.
    pub fn new(
        device: &Device,
        shader: &Shader,
        entries: &[&'static str],
        slots: &[Slot],
        constants: &[(&str, f64)],
    ) -> Self {
        let label = shader.name;
        let layout = device.create_bind_group_layout(&BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &(0..).zip(slots).map(|(at, &slot)| place(at, slot)).collect::<Vec<_>>(),
        });
        let pipeline_layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let module = device.create_shader_module(ShaderModuleDescriptor {
            label: Some(label),
            source: ShaderSource::Wgsl(shader.text().into()),
        });
        let compile = |&entry: &&'static str| Kernel {
            label,
            entry,
            pipeline: device.create_compute_pipeline(&ComputePipelineDescriptor {
                label: Some(label),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: PipelineCompilationOptions {
                    constants,
                    ..PipelineCompilationOptions::default()
                },
                cache: None,
            }),
        };
        let entries = entries.iter().map(compile).collect();
        Self { label, layout, slots: slots.to_vec(), entries }
    }

    /// Binds resources to the slots, in order.
    pub fn bind(&self, device: &Device, resources: &[BindingResource]) -> Bound {
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| BindGroupEntry { binding, resource: resource.clone() })
            .collect();
        let group = device.create_bind_group(&BindGroupDescriptor {
            label: Some(self.label),
            layout: &self.layout,
            entries: &entries,
        });
        let slots = self.slots.iter().zip(resources);
        Bound { group, traffic: slots.map(|(slot, resource)| traffic(*slot, resource)).sum() }
    }
}

/// What is bound to a kernel, and what a run moves that looks at all of it once.
#[derive(Clone, Debug)]
pub struct Bound {
    group: BindGroup,
    traffic: Traffic,
}

fn traffic(slot: Slot, resource: &BindingResource) -> Traffic {
    let bytes = match resource {
        BindingResource::Buffer(part) => {
            part.size.map_or(part.buffer.size() - part.offset, NonZeroU64::get)
        }
        BindingResource::TextureView(view) => {
            let texture = view.texture();
            let texel = texture.format().block_copy_size(None).unwrap_or(0);
            u64::from(texture.width()) * u64::from(texture.height()) * u64::from(texel)
        }
        _ => 0,
    };
    match slot {
        Slot::Write | Slot::Picture => Traffic { read: 0, written: bytes },
        _ => Traffic { read: bytes, written: 0 },
    }
}

fn place(binding: u32, slot: Slot) -> BindGroupLayoutEntry {
    let buffer = |ty, has_dynamic_offset| BindingType::Buffer {
        ty,
        has_dynamic_offset,
        min_binding_size: None,
    };
    let ty = match slot {
        Slot::Uniform => buffer(BufferBindingType::Uniform, false),
        Slot::Step => buffer(BufferBindingType::Uniform, true),
        Slot::Read => buffer(BufferBindingType::Storage { read_only: true }, false),
        Slot::Write => buffer(BufferBindingType::Storage { read_only: false }, false),
        Slot::Picture => BindingType::StorageTexture {
            access: StorageTextureAccess::WriteOnly,
            format: TextureFormat::Rgba16Float,
            view_dimension: TextureViewDimension::D2,
        },
        Slot::Texture => BindingType::Texture {
            sample_type: TextureSampleType::Float { filterable: false },
            view_dimension: TextureViewDimension::D2,
            multisampled: false,
        },
    };
    BindGroupLayoutEntry { binding, visibility: ShaderStages::COMPUTE, ty, count: None }
}

/// One run of a kernel.
#[derive(Clone, Debug)]
pub struct Dispatch {
    pub kernel: Kernel,
    bound: BindGroup,
    pub traffic: Traffic,
    /// Bytes to the step, or the parameters, that it is told.
    offset: Option<u32>,
    /// In how many workgroups it runs; where the GPU says it, in how many otherwise.
    pub groups: [u32; 3],
    /// The buffer in which the GPU says it, and bytes to there.
    told: Option<(Buffer, u64)>,
}

impl Dispatch {
    /// In so many workgroups; with `step`, told the entry of that number.
    pub fn new(kernel: &Kernel, bound: &Bound, step: Option<u32>, groups: [u32; 3]) -> Self {
        let offset = step.map(|step| step * STEP_BYTES);
        let Bound { group, traffic } = bound.clone();
        Self { kernel: kernel.clone(), bound: group, traffic, offset, groups, told: None }
    }

    /// Over every cell of a grid.
    pub fn over(
        [width, height]: [u32; 2],
        kernel: &Kernel,
        bound: &Bound,
        step: Option<u32>,
    ) -> Self {
        let groups = [width.div_ceil(WORKGROUP), height.div_ceil(WORKGROUP), 1];
        Self::new(kernel, bound, step, groups)
    }

    /// The same in as many workgroups as three numbers say, so many bytes into a buffer that must not
    /// be bound too.
    pub fn told_by(self, groups: &Buffer, offset: u64) -> Self {
        Self { told: Some((groups.clone(), offset)), ..self }
    }

    pub fn record(&self, pass: &mut ComputePass) {
        pass.push_debug_group(self.kernel.label);
        pass.set_pipeline(&self.kernel.pipeline);
        pass.set_bind_group(0, &self.bound, self.offset.as_slice());
        let [x, y, z] = self.groups;
        match &self.told {
            None => pass.dispatch_workgroups(x, y, z),
            Some((buffer, offset)) => pass.dispatch_workgroups_indirect(buffer, *offset),
        }
        pass.pop_debug_group();
    }
}
