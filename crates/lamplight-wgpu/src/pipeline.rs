//! Compute pipelines, the resources bound to them, and their dispatches.

use crate::error::DeviceError;
use crate::error_scope::with_error_scope;
use crate::programs::{Binding, Program};
use crate::shader_module::shader_module;
use crate::shaders;
use crate::traffic::Traffic;
use std::num::NonZeroU64;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindGroupLayoutDescriptor,
    BindingResource, Buffer, ComputePass, ComputePipelineDescriptor, Device,
    PipelineCompilationOptions, PipelineLayout, PipelineLayoutDescriptor, ShaderModule,
    ShaderStages, TextureView,
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

/// A program with the values of its overrides. Each entry point is compiled when it is first used, or ahead
/// ([`crate::ahead`]). Clones share what is compiled.
#[derive(Clone, Debug)]
pub struct ComputePipelines(Arc<Compiled>);

/// A program, and what is compiled of it.
#[derive(Debug)]
struct Compiled {
    device: Device,
    program: Program,
    constants: Arc<[(String, f64)]>,
    layouts: OnceLock<Layouts>,
    entries: Mutex<Entries>,
    /// The count of pipelines that were compiled when they were first used.
    waits: Arc<AtomicUsize>,
}

#[derive(Debug)]
struct Layouts {
    group: BindGroupLayout,
    pipeline: PipelineLayout,
}

/// Entry points.
#[derive(Debug)]
struct Entries {
    pipelines: Vec<Option<wgpu::ComputePipeline>>,
    /// The shader, until all of them are compiled.
    module: Option<ShaderModule>,
}

impl ComputePipelines {
    /// A program of which nothing is compiled. `constants` are the values of the shader's overrides.
    pub fn uncompiled(
        device: &Device,
        program: &Program,
        constants: &[(&str, f64)],
        waits: &Arc<AtomicUsize>,
    ) -> Self {
        let named = constants.iter().map(|&(name, value)| (name.to_owned(), value));
        let pipelines = vec![None; program.entries.len()];
        Self(Arc::new(Compiled {
            device: device.clone(),
            program: *program,
            constants: named.collect(),
            layouts: OnceLock::new(),
            entries: Mutex::new(Entries { pipelines, module: None }),
            waits: waits.clone(),
        }))
    }

    /// Returns whether it is this program with these constants.
    pub fn is(&self, program: &Program, constants: &[(&str, f64)]) -> bool {
        let own = self.0.constants.iter().map(|(name, value)| (name.as_str(), value.to_bits()));
        let others = constants.iter().map(|(name, value)| (*name, value.to_bits()));
        let known = &self.0.program;
        (known.shader, known.entries) == (program.shader, program.entries) && own.eq(others)
    }

    /// Returns whether there is no clone of it.
    pub fn is_unshared(&self) -> bool {
        Arc::strong_count(&self.0) == 1
    }

    /// The number of entry points.
    pub fn entries(&self) -> usize {
        self.0.program.entries.len()
    }

    /// An entry point, which is compiled now if it is not yet.
    pub fn entry(&self, entry: usize) -> ComputePipeline {
        let mut entries = self.0.lock();
        if entries.pipelines[entry].is_none() {
            self.0.waits.fetch_add(1, Ordering::Relaxed);
        }
        let pipeline = self.0.compiled(&mut entries, entry);
        let Compiled { program, constants, .. } = &*self.0;
        let (label, entry) = (shaders::label(program.shader), program.entries[entry]);
        ComputePipeline { label, entry, program: *program, constants: constants.clone(), pipeline }
    }

    /// Compiles an entry point ahead. If the device fails to, it is compiled when it is used, where errors are
    /// returned.
    pub fn compile_ahead(&self, entry: usize) -> Result<(), DeviceError> {
        let mut entries = self.0.lock();
        let compile = || Ok(self.0.compiled(&mut entries, entry));
        let compiled: Result<_, DeviceError> = with_error_scope(&self.0.device, compile);
        if compiled.is_err() {
            entries.pipelines[entry] = None;
        }
        compiled.map(|_| ())
    }

    /// Forgets what is compiled.
    pub fn forget(&self) {
        self.0.lock().pipelines.fill(None);
    }

    /// Binds resources to the slots, in the order of the program's declaration.
    ///
    /// Browsers drop a whole frame if one of its dispatches has a buffer in two slots that are written, used or not
    /// (WebGPU, "Encoder Bind Groups Alias a Writable Resource"). wgpu accepts it, so tests find it here.
    pub fn bind(&self, device: &Device, resources: &[BindingResource]) -> BoundResources {
        let Compiled { program, .. } = &*self.0;
        let label = shaders::label(program.shader);
        let slots = program.bindings.iter().zip(resources);
        let written = slots.clone().filter(|((_, binding), _)| binding.is_written());
        let twice = shared(written.filter_map(|((name, _), resource)| match resource {
            BindingResource::Buffer(part) => Some((*name, part.buffer)),
            _ => None,
        }));
        debug_assert_eq!(twice, None, "{label}: slots that are written share a buffer");
        let group = bind(device, program, &self.0.layouts().group, resources.iter().cloned());
        let traffic = slots.map(|((_, binding), resource)| traffic(*binding, resource)).sum();
        let resources = resources.iter().filter_map(BoundResource::new).collect();
        BoundResources { group, traffic, resources }
    }
}

impl Compiled {
    fn lock(&self) -> MutexGuard<'_, Entries> {
        self.entries.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn layouts(&self) -> &Layouts {
        self.layouts.get_or_init(|| {
            let group = layout_of(&self.device, &self.program, ShaderStages::COMPUTE);
            let pipeline = self.device.create_pipeline_layout(&PipelineLayoutDescriptor {
                label: Some(shaders::label(self.program.shader)),
                bind_group_layouts: &[Some(&group)],
                immediate_size: 0,
            });
            Layouts { group, pipeline }
        })
    }

    fn compiled(&self, entries: &mut Entries, entry: usize) -> wgpu::ComputePipeline {
        let Entries { pipelines, module } = entries;
        if let Some(known) = &pipelines[entry] {
            return known.clone();
        }
        let label = shaders::label(self.program.shader);
        let module = module.get_or_insert_with(|| {
            #[cfg(not(test))]
            let text = shaders::text(self.program.shader);
            #[cfg(test)]
            let text = crate::poison::text(&self.program);
            shader_module(&self.device, label, text)
        });
        let constants: Vec<_> =
            self.constants.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        let pipeline = self.device.create_compute_pipeline(&ComputePipelineDescriptor {
            label: Some(label),
            layout: Some(&self.layouts().pipeline),
            module,
            entry_point: Some(self.program.entries[entry]),
            compilation_options: PipelineCompilationOptions {
                constants: &constants,
                zero_initialize_workgroup_memory: !self.program.writes_first(),
            },
            cache: None,
        });
        pipelines[entry] = Some(pipeline.clone());
        if pipelines.iter().all(Option::is_some) {
            entries.module = None;
        }
        pipeline
    }
}

/// Creates the layout of a program's slots.
pub fn layout_of(device: &Device, program: &Program, visibility: ShaderStages) -> BindGroupLayout {
    let slots = (0..).zip(program.bindings);
    let slots = slots.map(|(slot, (_, binding))| binding.entry(slot, visibility));
    device.create_bind_group_layout(&BindGroupLayoutDescriptor {
        label: Some(shaders::label(program.shader)),
        entries: &slots.collect::<Vec<_>>(),
    })
}

/// Binds resources to a program's slots, in the order of its declaration.
pub fn bind<'a>(
    device: &Device,
    program: &Program,
    layout: &BindGroupLayout,
    resources: impl IntoIterator<Item = BindingResource<'a>>,
) -> BindGroup {
    let entries = (0..).zip(resources);
    let entries = entries.map(|(binding, resource)| BindGroupEntry { binding, resource });
    device.create_bind_group(&BindGroupDescriptor {
        label: Some(shaders::label(program.shader)),
        layout,
        entries: &entries.collect::<Vec<_>>(),
    })
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
        pipeline: ComputePipeline,
        bound: &BoundResources,
        step: Option<u32>,
        groups: [u32; 3],
    ) -> Self {
        let offset = step.map(|step| step * STEP_BYTES);
        let BoundResources { group, traffic, resources } = bound.clone();
        Self { pipeline, bound: group, resources, traffic, offset, groups, indirect: None }
    }

    /// Dispatches a thread per cell of a grid.
    pub fn over(
        [width, height]: [u32; 2],
        pipeline: ComputePipeline,
        bound: &BoundResources,
        step: Option<u32>,
    ) -> Self {
        let groups = [width.div_ceil(WORKGROUP), height.div_ceil(WORKGROUP), 1];
        Self::new(pipeline, bound, step, groups)
    }

    /// Replaces the traffic of all that is bound by what the dispatch really moves.
    pub fn with_traffic(self, traffic: Traffic) -> Self {
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
