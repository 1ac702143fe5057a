//! A frame as data, for engines that own their device.
//!
//! An engine with a graphics API of its own (Godot's `RenderingDevice`, Vulkan, Metal) cannot hand wgpu its device.
//! It can run the same shaders all the same: [`Lighting::frame_plan`](crate::Lighting::frame_plan) lists what
//! [`Lighting::record`](crate::Lighting::record) records, as programs in WGSL or SPIR-V, buffers, textures and
//! dispatches. The lists need no GPU: a device of wgpu's `noop` backend (a feature of that crate) plans without one, with
//! the limits that you request of it.
//!
//! ```
//! use lamplight::{Cells, Method, Settings};
//! use lamplight_wgpu::{Backend, FrameInput, Lighting, LightingOptions, Tier, required_limits, wgpu};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
//! descriptor.backends = wgpu::Backends::NOOP;
//! descriptor.backend_options.noop.enable = true;
//! let instance = wgpu::Instance::new(descriptor);
//! let adapter = pollster::block_on(instance.request_adapter(&Default::default()))?;
//! let required_limits = required_limits(Tier::Web, &adapter);
//! let descriptor = wgpu::DeviceDescriptor { required_limits, ..Default::default() };
//! let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))?;
//!
//! let mut lighting = Lighting::new(&device, &queue, &LightingOptions::on(Backend::Gpu))?;
//! // Every frame:
//! let (settings, cells) = (Settings::new(Method::Holographic), Cells::new(64, 64)?);
//! lighting.prepare(&FrameInput::of_cells(&settings, &cells))?;
//! let plan = lighting.frame_plan()?;
//! for dispatch in &plan.dispatches {
//!     let program = &plan.programs[dispatch.program];
//!     println!("{} {}: {:?}", program.shader, program.entry, dispatch.groups);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! To run a frame, in this order:
//!
//! 1. Compile the programs and create the resources whose `id` is new. Buffers begin with zeros. A resource keeps its id
//!    as long as every plan lists it.
//! 2. Write the [`contents`](PlannedBuffer::contents) of buffers, and the textures, which may be new in each frame.
//! 3. Run the dispatches. Each sees everything that those before it wrote: between two that share a resource which one
//!    of them writes, most APIs want a barrier.
//!
//! Everything that dispatches write stays until the next frame: some of it is history. Drop resources that a plan no
//! longer lists; programs may come back.

// Handles of wgpu are compared by what they stand for, which does not change.
#![allow(clippy::mutable_key_type)]

use crate::error::ReadBackError;
use crate::pipeline::{BoundResource, Dispatch};
use crate::programs::Binding;
use crate::shaders;
use std::collections::{HashMap, HashSet};
use std::hash::{DefaultHasher, Hash, Hasher};
use wgpu::{
    BindingType, Buffer, BufferUsages, ComputePipeline, ShaderStages, TextureFormat, TextureView,
};

/// A frame as data.
#[derive(Clone, Debug, PartialEq)]
pub struct FramePlan {
    /// The programs that dispatches run.
    pub programs: Vec<PlannedProgram>,
    /// The buffers that dispatches use.
    pub buffers: Vec<PlannedBuffer>,
    /// The textures that dispatches use.
    pub textures: Vec<PlannedTexture>,
    /// The dispatches, in order.
    pub dispatches: Vec<PlannedDispatch>,
    /// The index of the buffer with the light after the last dispatch: four `f32` per cell, row by row from the top.
    pub light: usize,
}

/// An entry point of a shader with the values of its constants.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedProgram {
    /// A number that stands for the shader, the entry point and the constants, the same in every frame.
    pub id: u64,
    /// The shader's name.
    pub shader: &'static str,
    /// The entry point.
    pub entry: &'static str,
    /// Plain WGSL, without extensions.
    pub wgsl: String,
    /// The values of the shader's `override` declarations.
    pub constants: Vec<(String, f64)>,
    /// The slots of bind group 0, from slot 0 on.
    pub slots: Vec<PlannedSlot>,
    /// True if workgroup memory has to be zero at first, as WGSL has it. Other programs write it before they read it.
    pub clears_workgroup_memory: bool,
}

/// A slot of a program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlannedSlot {
    /// The shader's variable.
    pub name: &'static str,
    /// The kind of its resource.
    pub kind: BindingType,
}

/// A buffer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlannedBuffer {
    /// A number that stands for this buffer in every frame of a [`Lighting`](crate::Lighting).
    pub id: u64,
    /// The variable of the first program that uses it.
    pub name: &'static str,
    /// Its size.
    pub bytes: u64,
    /// `UNIFORM`, `STORAGE`, `INDIRECT`, or several of them.
    pub usage: BufferUsages,
    /// Its bytes in this frame; `None` if dispatches write it, before they read it or in the frame before.
    pub contents: Option<Vec<u8>>,
}

/// A texture with two dimensions, one layer and one mip level.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlannedTexture {
    /// A number that stands for this texture in every frame of a [`Lighting`](crate::Lighting).
    pub id: u64,
    /// The variable of the first program that uses it.
    pub name: &'static str,
    /// Columns and rows.
    pub size: [u32; 2],
    /// The format in which it was planned. Those of matter may have another one with floats or normalised integers.
    pub format: TextureFormat,
    /// Its contents.
    pub source: TextureSource,
}

/// The contents of a texture.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TextureSource {
    /// [`Textures::emission`](crate::Textures::emission).
    Emission,
    /// [`Textures::tint_opacity`](crate::Textures::tint_opacity).
    TintOpacity,
    /// [`Textures::albedo`](crate::Textures::albedo).
    Albedo,
    /// [`Textures::glow`](crate::Textures::glow).
    Glow,
    /// [`Textures::masks`](crate::Textures::masks).
    Masks,
    /// These texels, row by row.
    Texels(Vec<u8>),
    /// Dispatches write it before they read it.
    Written,
    /// Dispatches write the light to it ([`FrameInput::output`](crate::FrameInput::output)).
    Output,
}

/// A dispatch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlannedDispatch {
    /// The index of its program.
    pub program: usize,
    /// The resource of each slot.
    pub bindings: Vec<PlannedBinding>,
    /// The number of workgroups.
    pub groups: PlannedGroups,
}

/// The resource of a slot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlannedBinding {
    /// A part of a buffer.
    Buffer {
        /// The buffer's index.
        buffer: usize,
        /// Its first byte.
        offset: u64,
        /// The number of bytes.
        bytes: u64,
    },
    /// A texture, by its index.
    Texture(usize),
}

/// A number of workgroups.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlannedGroups {
    /// Columns, rows and layers of workgroups.
    Count([u32; 3]),
    /// Three `u32` in a buffer, which a dispatch before writes.
    Indirect {
        /// The buffer's index.
        buffer: usize,
        /// The byte at which they begin.
        offset: u64,
    },
}

/// The numbers by which hosts know resources again.
#[derive(Debug, Default)]
pub struct PlanIds {
    known: HashMap<Handle, KnownResource>,
    next: u64,
}

#[derive(Clone, Copy, Debug)]
struct KnownResource {
    id: u64,
    /// True once a dispatch has written it: its contents are then the host's.
    is_written: bool,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
enum Handle {
    Buffer(Buffer),
    Texture(TextureView),
    Pipeline(ComputePipeline),
}

impl PlanIds {
    fn of(&mut self, handle: Handle) -> u64 {
        let known = self.known.entry(handle).or_insert_with(|| {
            self.next += 1;
            KnownResource { id: self.next, is_written: false }
        });
        known.id
    }
}

/// The places of resources and programs in the lists of a plan.
#[derive(Default)]
struct PlanIndices(HashMap<Handle, usize>);

impl FramePlan {
    /// Lists dispatches. `source` tells what a texture holds that no dispatch writes, `contents` reads a buffer.
    pub(crate) fn new<'a>(
        dispatches: impl Iterator<Item = &'a Dispatch> + Clone,
        light: &Buffer,
        ids: &mut PlanIds,
        source: impl Fn(&TextureView) -> Option<TextureSource>,
        contents: impl Fn(&Buffer) -> Result<Vec<u8>, ReadBackError>,
    ) -> Result<Self, ReadBackError> {
        let written: HashSet<Handle> = dispatches.clone().flat_map(written_by).collect();
        let mut plan = Self {
            programs: Vec::new(),
            buffers: Vec::new(),
            textures: Vec::new(),
            dispatches: Vec::new(),
            light: 0,
        };
        let mut indices = PlanIndices::default();
        for dispatch in dispatches {
            let program = plan.add_program(dispatch, &mut indices);
            let slots = dispatch.pipeline.program.bindings.iter().zip(&*dispatch.resources);
            let mut bindings = Vec::with_capacity(slots.len());
            for (&(name, binding), resource) in slots {
                bindings.push(match resource {
                    BoundResource::Buffer { buffer, offset, bytes } => {
                        let usage = match binding {
                            Binding::Uniform | Binding::Step => BufferUsages::UNIFORM,
                            _ => BufferUsages::STORAGE,
                        };
                        let index = plan.add_buffer(name, buffer, usage, &mut indices, ids);
                        let step = dispatch.offset.filter(|_| binding == Binding::Step);
                        let offset = offset + u64::from(step.unwrap_or(0));
                        PlannedBinding::Buffer { buffer: index, offset, bytes: *bytes }
                    }
                    BoundResource::Texture(view) => {
                        let handle = Handle::Texture(view.clone());
                        let index = indices.of(&handle, || {
                            let texture = view.texture();
                            plan.textures.push(PlannedTexture {
                                id: ids.of(handle.clone()),
                                name,
                                size: [texture.width(), texture.height()],
                                format: texture.format(),
                                source: source(view).unwrap_or(TextureSource::Written),
                            });
                            plan.textures.len() - 1
                        });
                        PlannedBinding::Texture(index)
                    }
                });
            }
            let groups = match &dispatch.indirect {
                None => PlannedGroups::Count(dispatch.groups),
                Some((buffer, offset)) => {
                    let usage = BufferUsages::INDIRECT;
                    let buffer = plan.add_buffer("groups", buffer, usage, &mut indices, ids);
                    PlannedGroups::Indirect { buffer, offset: *offset }
                }
            };
            plan.dispatches.push(PlannedDispatch { program, bindings, groups });
        }
        plan.light = plan.add_buffer("light", light, BufferUsages::STORAGE, &mut indices, ids);
        ids.known.retain(|handle, known| {
            known.is_written |= written.contains(handle);
            indices.0.contains_key(handle)
        });
        for (handle, &index) in &indices.0 {
            let is_written = ids.known.get(handle).is_some_and(|known| known.is_written);
            if let Handle::Buffer(buffer) = handle
                && !is_written
            {
                plan.buffers[index].contents = Some(contents(buffer)?);
            }
        }
        Ok(plan)
    }

    fn add_program(
        &mut self,
        Dispatch { pipeline, .. }: &Dispatch,
        indices: &mut PlanIndices,
    ) -> usize {
        let handle = Handle::Pipeline(pipeline.pipeline.clone());
        indices.of(&handle, || {
            let mut id = DefaultHasher::new();
            (pipeline.label, pipeline.entry).hash(&mut id);
            for (name, value) in &*pipeline.constants {
                (name, value.to_bits()).hash(&mut id);
            }
            let program = &pipeline.program;
            let slot = |&(name, binding): &(&'static str, Binding)| {
                let mut kind = binding.entry(0, ShaderStages::COMPUTE).ty;
                if let BindingType::Buffer { has_dynamic_offset, .. } = &mut kind {
                    // Offsets are part of each binding.
                    *has_dynamic_offset = false;
                }
                PlannedSlot { name, kind }
            };
            self.programs.push(PlannedProgram {
                id: id.finish(),
                shader: pipeline.label,
                entry: pipeline.entry,
                wgsl: shaders::text(program.shader),
                constants: pipeline.constants.to_vec(),
                slots: program.bindings.iter().map(slot).collect(),
                clears_workgroup_memory: !program.writes_first(),
            });
            self.programs.len() - 1
        })
    }

    fn add_buffer(
        &mut self,
        name: &'static str,
        buffer: &Buffer,
        usage: BufferUsages,
        indices: &mut PlanIndices,
        ids: &mut PlanIds,
    ) -> usize {
        let handle = Handle::Buffer(buffer.clone());
        let index = indices.of(&handle, || {
            self.buffers.push(PlannedBuffer {
                id: ids.of(handle.clone()),
                name,
                bytes: buffer.size(),
                usage,
                contents: None,
            });
            self.buffers.len() - 1
        });
        self.buffers[index].usage |= usage;
        index
    }
}

impl PlanIndices {
    fn of(&mut self, handle: &Handle, add: impl FnOnce() -> usize) -> usize {
        match self.0.get(handle) {
            Some(&index) => index,
            None => {
                let index = add();
                self.0.insert(handle.clone(), index);
                index
            }
        }
    }
}

/// The resources that a dispatch writes.
fn written_by(dispatch: &Dispatch) -> impl Iterator<Item = Handle> {
    let slots = dispatch.pipeline.program.bindings.iter().zip(&*dispatch.resources);
    slots.filter(|((_, binding), _)| binding.is_written()).map(|(_, resource)| match resource {
        BoundResource::Buffer { buffer, .. } => Handle::Buffer(buffer.clone()),
        BoundResource::Texture(view) => Handle::Texture(view.clone()),
    })
}
