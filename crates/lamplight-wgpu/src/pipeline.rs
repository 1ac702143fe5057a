//! Compute pipelines, the resources bound to them, and their dispatches.

use crate::programs::{Binding, Program};
use crate::shader_module::shader_module;
use crate::shaders;
use crate::traffic::Traffic;
use std::num::NonZeroU64;
use std::sync::Arc;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor,
    BindingResource, Buffer, ComputePass, ComputePipelineDescriptor, Device,
    PipelineCompilationOptions, PipelineLayoutDescriptor, ShaderStages, TextureView,
};

/// Side of a workgroup, in cells, of shaders that run over cells.
pub const WORKGROUP: u32 = 8;

/// Bytes between two entries of a buffer for [`Binding::Step`]: an offset that every device supports.
pub const STEP_BYTES: u32 = 256;

/// A compiled entry point of a shader.
#[derive(Clone, Debug)]
pub struct ComputePipeline {
    /// The shader's name in timings.
    pub label: &'static str,
    pub entry: &'static str,
    /// Its source, for [`crate::frame_plan`].
    pub program: Program,
    /// The values of the shader's overrides.
    pub constants: Arc<[(String, f64)]>,
    pub pipeline: wgpu::ComputePipeline,
}

/// The compiled entry points of a program, and their bindings.
#[derive(Debug)]
pub struct ComputePipelines {
    label: &'static str,
    layout: BindGroupLayout,
    bindings: &'static [(&'static str, Binding)],
    pub entries: Vec<ComputePipeline>,
}

impl ComputePipelines {
    /// Compiles a program. `constants` are the values of the shader's overrides.
    pub fn new(device: &Device, program: &Program, constants: &[(&str, f64)]) -> Self {
        let label = shaders::label(program.shader);
        let slots = (0..).zip(program.bindings);
        let slots = slots.map(|(slot, (_, binding))| binding.entry(slot, ShaderStages::COMPUTE));
        let layout = device.create_bind_group_layout(&BindGroupLayoutDescriptor {
            label: Some(label),
            entries: &slots.collect::<Vec<_>>(),
        });
        let pipeline_layout = device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        #[cfg(not(test))]
        let text = shaders::text(program.shader);
        #[cfg(test)]
        let text = crate::poison::text(program);
        let module = shader_module(device, label, text);
        let named = constants.iter().map(|&(name, value)| (name.to_owned(), value));
        let named: Arc<[_]> = named.collect();
        let compile = |&entry: &&'static str| ComputePipeline {
            label,
            entry,
            program: *program,
            constants: named.clone(),
            pipeline: device.create_compute_pipeline(&ComputePipelineDescriptor {
                label: Some(label),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry),
                compilation_options: PipelineCompilationOptions {
                    constants,
                    zero_initialize_workgroup_memory: !program.writes_first(),
                },
                cache: None,
            }),
        };
        let entries = program.entries.iter().map(compile).collect();
        Self { label, layout, bindings: program.bindings, entries }
    }

    /// Binds resources to the slots, in the order of the program's declaration.
    ///
    /// Browsers drop a whole frame if one of its dispatches has a buffer in two slots that are written, used or not
    /// (WebGPU, "Encoder Bind Groups Alias a Writable Resource"). wgpu accepts it, so tests find it here.
    pub fn bind(&self, device: &Device, resources: &[BindingResource]) -> BoundResources {
        let slots = self.bindings.iter().zip(resources);
        let written = slots.clone().filter(|((_, binding), _)| binding.is_written());
        let twice = shared(written.filter_map(|((name, _), resource)| match resource {
            BindingResource::Buffer(part) => Some((*name, part.buffer)),
            _ => None,
        }));
        debug_assert_eq!(twice, None, "{}: slots that are written share a buffer", self.label);
        let entries: Vec<_> = (0..)
            .zip(resources)
            .map(|(binding, resource)| BindGroupEntry { binding, resource: resource.clone() })
            .collect();
        let group = device.create_bind_group(&BindGroupDescriptor {
            label: Some(self.label),
            layout: &self.layout,
            entries: &entries,
        });
        let traffic = slots.map(|((_, binding), resource)| traffic(*binding, resource)).sum();
        let resources = resources.iter().filter_map(BoundResource::new).collect();
        BoundResources { group, traffic, resources }
    }
}

/// A resource in a slot.
#[derive(Clone, Debug)]
pub enum BoundResource {
    /// Some bytes of a buffer.
    Buffer { buffer: Buffer, offset: u64, bytes: u64 },
    /// A texture.
    Texture(TextureView),
}

impl BoundResource {
    /// A resource of a kind that programs declare.
    fn new(resource: &BindingResource) -> Option<Self> {
        match resource {
            BindingResource::Buffer(part) => Some(Self::Buffer {
                buffer: part.buffer.clone(),
                offset: part.offset,
                bytes: part.size.map_or(part.buffer.size() - part.offset, NonZeroU64::get),
            }),
            BindingResource::TextureView(view) => Some(Self::Texture((*view).clone())),
            _ => None,
        }
    }
}

/// Resources that are bound to a pipeline, and the traffic of a dispatch that touches each byte once.
#[derive(Clone, Debug)]
pub struct BoundResources {
    group: BindGroup,
    traffic: Traffic,
    /// Slot by slot.
    resources: Arc<[BoundResource]>,
}

fn traffic(binding: Binding, resource: &BindingResource) -> Traffic {
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
    if binding.is_written() {
        Traffic { read: 0, written: bytes }
    } else {
        Traffic { read: bytes, written: 0 }
    }
}

/// The names of the first two slots with the same resource.
fn shared<'a, T: PartialEq>(
    slots: impl Iterator<Item = (&'a str, T)> + Clone,
) -> Option<[&'a str; 2]> {
    slots.clone().enumerate().find_map(|(i, (name, resource))| {
        let (other, _) = slots.clone().take(i).find(|(_, other)| *other == resource)?;
        Some([other, name])
    })
}

/// One dispatch of a pipeline.
#[derive(Clone, Debug)]
pub struct Dispatch {
    pub pipeline: ComputePipeline,
    bound: BindGroup,
    /// The resources bound, slot by slot.
    pub resources: Arc<[BoundResource]>,
    pub traffic: Traffic,
    /// Dynamic offset of the step, in bytes.
    pub offset: Option<u32>,
    /// Workgroup count; for an indirect dispatch, the largest.
    pub groups: [u32; 3],
    /// Indirect-arguments buffer and byte offset.
    pub indirect: Option<(Buffer, u64)>,
}

impl Dispatch {
    /// Dispatches `groups` workgroups; `step` selects the entry of the dynamic offset.
    pub fn new(
        pipeline: &ComputePipeline,
        bound: &BoundResources,
        step: Option<u32>,
        groups: [u32; 3],
    ) -> Self {
        let offset = step.map(|step| step * STEP_BYTES);
        let BoundResources { group, traffic, resources } = bound.clone();
        Self {
            pipeline: pipeline.clone(),
            bound: group,
            resources,
            traffic,
            offset,
            groups,
            indirect: None,
        }
    }

    /// Dispatches a thread per cell of a grid.
    pub fn over(
        [width, height]: [u32; 2],
        pipeline: &ComputePipeline,
        bound: &BoundResources,
        step: Option<u32>,
    ) -> Self {
        let groups = [width.div_ceil(WORKGROUP), height.div_ceil(WORKGROUP), 1];
        Self::new(pipeline, bound, step, groups)
    }

    /// The variant that moves less than all that is bound.
    pub fn moving(self, traffic: Traffic) -> Self {
        Self { traffic, ..self }
    }

    /// The indirect variant, whose workgroup count lies at a byte offset of `groups`. The dispatch must not
    /// also bind that buffer.
    pub fn indirect(self, groups: &Buffer, offset: u64) -> Self {
        Self { indirect: Some((groups.clone(), offset)), ..self }
    }

    /// Records the dispatch.
    pub fn record(&self, pass: &mut ComputePass) {
        pass.push_debug_group(self.pipeline.label);
        pass.set_pipeline(&self.pipeline.pipeline);
        pass.set_bind_group(0, &self.bound, self.offset.as_slice());
        let [x, y, z] = self.groups;
        match &self.indirect {
            None => pass.dispatch_workgroups(x, y, z),
            Some((buffer, offset)) => pass.dispatch_workgroups_indirect(buffer, *offset),
        }
        pass.pop_debug_group();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_that_share_a_resource_are_named() {
        let slots = [("surface", 1), ("irradiance", 2), ("light", 3)];
        assert_eq!(shared(slots.into_iter()), None);
        let slots = [("surface", 1), ("irradiance", 2), ("light", 2)];
        assert_eq!(shared(slots.into_iter()), Some(["irradiance", "light"]));
    }
}
