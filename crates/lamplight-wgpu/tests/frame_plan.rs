//! Frames as data: an executor that knows nothing but the plan, on a device of its own, finds the same light.

// SPIR-V is handed to the driver as it is.
#![allow(unsafe_code)]

mod common;

use common::{adapter, cells, device, lighting, open, recorded};
use lamplight::settings::Variant;
use lamplight::{
    BorderPlace, Bounces, Cells, Cookie, CookiePixels, Inflow, Lamp, Method, Panorama, Settings,
    Sky,
};
use lamplight_wgpu::frame_plan::{
    FramePlan, PlannedBinding, PlannedGroups, PlannedProgram, TextureSource,
};
use lamplight_wgpu::read_back::read_back;
use lamplight_wgpu::{FrameInput, Lighting, Tier, required_limits};
use std::borrow::Cow;
use std::collections::HashMap;
use wgpu::{
    Backends, BindGroupDescriptor, BindGroupEntry, BindGroupLayoutDescriptor, BindGroupLayoutEntry,
    BindingResource, Buffer, BufferBinding, BufferDescriptor, BufferUsages, ComputePipeline,
    ComputePipelineDescriptor, Device, DeviceDescriptor, ExperimentalFeatures, Features, Instance,
    InstanceDescriptor, NoopBackendOptions, PassthroughShaderEntryPoint,
    PipelineCompilationOptions, PipelineLayoutDescriptor, Queue, RequestAdapterOptions,
    ShaderModule, ShaderModuleDescriptor, ShaderModuleDescriptorPassthrough, ShaderSource,
    ShaderStages, TextureUsages, TextureView,
};

#[path = "common/textures.rs"]
mod textures;

const SIZE: [u32; 2] = [61, 43];

/// Runs plans on a device of its own.
struct Executor {
    device: Device,
    queue: Queue,
    /// True if it compiles SPIR-V.
    spirv: bool,
    programs: HashMap<u64, ComputePipeline>,
    buffers: HashMap<u64, Buffer>,
    textures: HashMap<u64, TextureView>,
}

impl Executor {
    fn new((device, queue): (Device, Queue), spirv: bool) -> Self {
        Self {
            device,
            queue,
            spirv,
            programs: HashMap::new(),
            buffers: HashMap::new(),
            textures: HashMap::new(),
        }
    }

    fn module(&self, program: &PlannedProgram) -> ShaderModule {
        if self.spirv {
            let words = program.spirv().unwrap();
            let descriptor = ShaderModuleDescriptorPassthrough {
                label: Some(program.shader),
                entry_points: Cow::Owned(vec![PassthroughShaderEntryPoint {
                    name: program.entry.into(),
                    // Not used of SPIR-V.
                    workgroup_size: (0, 0, 0),
                }]),
                spirv: Some(Cow::Owned(words)),
                ..Default::default()
            };
            // SAFETY: it is naga's translation of a valid shader.
            return unsafe { self.device.create_shader_module_passthrough(descriptor) };
        }
        self.device.create_shader_module(ShaderModuleDescriptor {
            label: Some(program.shader),
            source: ShaderSource::Wgsl(program.wgsl.as_str().into()),
        })
    }

    fn compile(&self, program: &PlannedProgram) -> ComputePipeline {
        let slots = (0..).zip(&program.slots).map(|(binding, slot)| BindGroupLayoutEntry {
            binding,
            visibility: ShaderStages::COMPUTE,
            ty: slot.kind,
            count: None,
        });
        let layout = self.device.create_bind_group_layout(&BindGroupLayoutDescriptor {
            label: None,
            entries: &slots.collect::<Vec<_>>(),
        });
        let layout = self.device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&layout)],
            immediate_size: 0,
        });
        let constants: Vec<_> =
            program.constants.iter().map(|(name, value)| (name.as_str(), *value)).collect();
        self.device.create_compute_pipeline(&ComputePipelineDescriptor {
            label: Some(program.shader),
            layout: Some(&layout),
            module: &self.module(program),
            entry_point: Some(program.entry),
            compilation_options: PipelineCompilationOptions {
                constants: if self.spirv { &[] } else { &constants },
                zero_initialize_workgroup_memory: program.clears_workgroup_memory,
            },
            cache: None,
        })
    }

    /// Runs a frame of these cells, with their lamps drawn, and returns the light.
    fn run(&mut self, plan: &FramePlan, matter: &Cells) -> Vec<[f32; 4]> {
        let added = plan.programs.iter().filter(|p| !self.programs.contains_key(&p.id));
        let added: Vec<_> = added.map(|program| (program.id, self.compile(program))).collect();
        self.programs.extend(added);
        for planned in &plan.buffers {
            let buffer = self.buffers.entry(planned.id).or_insert_with(|| {
                let copied = BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
                self.device.create_buffer(&BufferDescriptor {
                    label: Some(planned.name),
                    size: planned.bytes,
                    usage: planned.usage | copied,
                    mapped_at_creation: false,
                })
            });
            if let Some(contents) = &planned.contents {
                self.queue.write_buffer(buffer, 0, contents);
            }
        }
        for planned in &plan.textures {
            let Some(bytes) = texels(&planned.source, matter) else {
                self.textures.entry(planned.id).or_insert_with(|| {
                    let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING;
                    let size = planned.size;
                    textures::view(&textures::texture(&self.device, size, planned.format, usage))
                });
                continue;
            };
            let view =
                textures::filled(&self.device, &self.queue, planned.size, planned.format, &bytes);
            self.textures.insert(planned.id, view);
        }
        let mut encoder = self.device.create_command_encoder(&Default::default());
        for dispatch in &plan.dispatches {
            let pipeline = &self.programs[&plan.programs[dispatch.program].id];
            let resource = |binding: &PlannedBinding| match *binding {
                PlannedBinding::Buffer { buffer, offset, bytes } => {
                    BindingResource::Buffer(BufferBinding {
                        buffer: &self.buffers[&plan.buffers[buffer].id],
                        offset,
                        size: bytes.try_into().ok(),
                    })
                }
                PlannedBinding::Texture(texture) => {
                    BindingResource::TextureView(&self.textures[&plan.textures[texture].id])
                }
            };
            let entries = (0..).zip(&dispatch.bindings);
            let entries = entries.map(|(slot, binding)| BindGroupEntry {
                binding: slot,
                resource: resource(binding),
            });
            let group = self.device.create_bind_group(&BindGroupDescriptor {
                label: None,
                layout: &pipeline.get_bind_group_layout(0),
                entries: &entries.collect::<Vec<_>>(),
            });
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &group, &[]);
            match dispatch.groups {
                PlannedGroups::Count([x, y, z]) => pass.dispatch_workgroups(x, y, z),
                PlannedGroups::Indirect { buffer, offset } => {
                    let buffer = &self.buffers[&plan.buffers[buffer].id];
                    pass.dispatch_workgroups_indirect(buffer, offset);
                }
            }
        }
        self.queue.submit([encoder.finish()]);
        let light = &self.buffers[&plan.buffers[plan.light].id];
        read_back(&self.device, &self.queue, light).unwrap()
    }
}

/// The bytes of a texture; none if dispatches write it.
fn texels(source: &TextureSource, matter: &Cells) -> Option<Vec<u8>> {
    let rgb = |values: &[[f32; 3]]| values.iter().flat_map(|&[r, g, b]| [r, g, b, 0.0]).collect();
    let floats: Vec<f32> = match source {
        TextureSource::Emission => rgb(matter.emission()),
        TextureSource::Albedo => rgb(matter.albedo()),
        TextureSource::Glow => rgb(matter.glow().unwrap()),
        TextureSource::TintOpacity => {
            let cells = matter.tint().iter().zip(matter.opacity());
            cells.flat_map(|(&[r, g, b], &opacity)| [r, g, b, opacity]).collect()
        }
        TextureSource::Masks => return Some(matter.masks().unwrap().to_vec()),
        TextureSource::Texels(bytes) => return Some(bytes.clone()),
        _ => return None,
    };
    Some(floats.into_iter().flat_map(f32::to_ne_bytes).collect())
}

/// A frame of a moving scene with everything that plans list.
fn scene(frame: u32) -> Cells {
    let [w, h] = SIZE;
    let mut cells = cells(w, h, 7);
    let position = [20.0 + 3.0 * frame as f32, 20.0];
    let lamp = Lamp { color: [6.0, 5.0, 4.0], size: 2.5, range: 30.0, ..Lamp::default() };
    let pixels: Vec<_> = (0..8).map(|i| [i as f32 / 8.0; 3]).collect();
    let cookie = Cookie::new(CookiePixels::new([4, 2], &pixels).unwrap(), 30.0);
    let spot = Lamp { position: [40.0, 30.0], cookie: Some(cookie), ..lamp.clone() };
    cells.lamps_mut().extend([Lamp { position, ..lamp }, spot]);
    let columns: Vec<_> = (0..16).map(|i| [0.1, 0.2, i as f32 / 16.0]).collect();
    cells.set_sky(Sky::Panorama(Panorama::new(&columns).unwrap()));
    cells.masks_mut()[..200].fill(2);
    cells
}

/// Settings whose plans differ most: every method, history, bounces of each kind, indirect dispatches.
fn all_settings() -> Vec<Settings> {
    let of = |method, bounces| Settings { bounces, ..Settings::new(method) };
    let mut paper = of(Method::Holographic, Bounces::Count(1));
    paper.method.as_holographic_mut().unwrap().variant = Variant::Paper;
    vec![
        of(Method::Holographic, Bounces::Feedback),
        of(Method::Holographic, Bounces::Converged),
        of(Method::Cascades, Bounces::Count(1)),
        of(Method::Raymarch, Bounces::Feedback),
        of(Method::Polar, Bounces::Count(0)),
        of(Method::Flood, Bounces::Count(0)),
        paper,
    ]
}

/// A frame's plan, and its cells with their lamps drawn. The third has inflow, where the method reads it.
fn planned(lighting: &mut Lighting, settings: &Settings, frame: u32) -> (FramePlan, Cells) {
    let mut cells = scene(frame);
    if frame == 2 && settings.method.takes_inflow().is_ok() {
        let radiance =
            |place: BorderPlace, angle: f64| [0.1, place.at[0] / 60.0, angle as f32 / 8.0];
        cells.set_inflow(Some(Inflow::new(SIZE, 24, radiance).unwrap())).unwrap();
    }
    // The grid moves with its camera, so that history is moved too.
    let input = FrameInput::of_cells(settings, &cells);
    let input = FrameInput { origin: [frame as i32 / 2, 0], ..input };
    lighting.prepare(&input).unwrap();
    let plan = lighting.frame_plan().unwrap();
    settings.method.draw_lamps(&mut cells);
    (plan, cells)
}

/// A device that computes nothing.
fn noop() -> (Device, Queue) {
    let mut descriptor = InstanceDescriptor::new_without_display_handle();
    descriptor.backends = Backends::NOOP;
    descriptor.backend_options.noop = NoopBackendOptions { enable: true, ..Default::default() };
    let instance = Instance::new(descriptor);
    let adapter = instance.request_adapter(&RequestAdapterOptions::default());
    let adapter = pollster::block_on(adapter).unwrap();
    open(&adapter, Tier::Web)
}

/// A device that takes SPIR-V as it is.
fn vulkan() -> Option<(Device, Queue)> {
    let adapter = adapter();
    let features = Features::PASSTHROUGH_SHADERS;
    if !adapter.features().contains(features) {
        println!("skipped: this adapter takes no SPIR-V");
        return None;
    }
    let descriptor = DeviceDescriptor {
        required_features: features,
        required_limits: required_limits(Tier::Web, &adapter),
        // SAFETY: what it runs is naga's translation of valid shaders.
        experimental_features: unsafe { ExperimentalFeatures::enabled() },
        ..DeviceDescriptor::default()
    };
    Some(pollster::block_on(adapter.request_device(&descriptor)).unwrap())
}

/// Returns whether light differs by more than rounding, which also decides whether one more bounce is found until they add
/// less than a thousandth: GPUs may round otherwise in a shader that is compiled with other checks.
fn differs(a: &[[f32; 4]], b: &[[f32; 4]], bounces: Bounces) -> bool {
    assert_eq!(a.len(), b.len());
    let [a, b] = [a, b].map(|light| light.as_flattened());
    let most = if bounces == Bounces::Converged { 1e-3 } else { 1e-5 };
    a.iter().zip(b).any(|(a, b)| (a - b).abs() > most * (1.0 + a.abs()))
}

#[test]
fn a_second_executor_finds_the_same_light() {
    let gpu = device();
    let mut own = Executor::new(device(), false);
    for settings in all_settings() {
        let mut lighting = lighting(&gpu.0, &gpu.1);
        for frame in 0..3 {
            let (plan, cells) = planned(&mut lighting, &settings, frame);
            let light = own.run(&plan, &cells);
            let expected = recorded(&gpu.0, &gpu.1, &lighting);
            let name =
                format!("{}, {:?}, frame {frame}", settings.method().name(), settings.bounces);
            assert!(expected.iter().any(|light| light[0] > 0.0), "{name}: black");
            assert!(!differs(&light, &expected, settings.bounces), "{name}");
            if frame == 0 {
                let mut other = plan.clone();
                let contents = other.buffers.iter_mut().find_map(|buffer| buffer.contents.as_mut());
                contents.unwrap().fill(0);
                let mut executor = Executor::new(device(), false);
                let perturbed = executor.run(&other, &cells);
                assert!(differs(&perturbed, &expected, settings.bounces), "{name}: perturbed");
            }
        }
        own = Executor::new(device(), false);
    }
}

#[test]
fn a_device_that_computes_nothing_plans_the_same() {
    let (noop, gpu) = (noop(), device());
    for settings in all_settings() {
        let [mut by_noop, mut by_gpu] = [&noop, &gpu].map(|(d, q)| lighting(d, q));
        for frame in 0..3 {
            let [(mut ours, _), (theirs, _)] =
                [&mut by_noop, &mut by_gpu].map(|lighting| planned(lighting, &settings, frame));
            // Both list matter in floats of 32 bits; ids are numbers of their own.
            assert_eq!(ours, theirs, "{}, frame {frame}", settings.method().name());
            ours.dispatches.pop();
            assert_ne!(ours, theirs);
        }
    }
}

#[test]
fn programs_in_spirv_find_the_same_light() {
    let Some(vulkan) = vulkan() else { return };
    let gpu = device();
    let mut own = Executor::new(vulkan, true);
    for settings in all_settings() {
        // Without inflow, and with it.
        for frame in [0, 2] {
            let mut lighting = lighting(&gpu.0, &gpu.1);
            let (plan, cells) = planned(&mut lighting, &settings, frame);
            own.programs.clear();
            own.buffers.clear();
            own.textures.clear();
            let light = own.run(&plan, &cells);
            let expected = recorded(&gpu.0, &gpu.1, &lighting);
            assert!(
                !differs(&light, &expected, settings.bounces),
                "{}, frame {frame}",
                settings.method().name()
            );
        }
    }
}

#[test]
fn resources_keep_their_numbers_and_nothing_is_planned_before_a_frame() {
    let gpu = noop();
    let mut lighting = lighting(&gpu.0, &gpu.1);
    assert!(lighting.frame_plan().is_err());
    let settings = Settings::new(Method::Holographic);
    let [(one, _), (two, _)] = [0, 1].map(|frame| planned(&mut lighting, &settings, frame));
    let ids = |plan: &FramePlan| plan.buffers.iter().map(|b| b.id).collect::<Vec<_>>();
    assert_eq!(ids(&one), ids(&two));
}

#[test]
fn history_that_moves_to_a_grid_of_another_size_stays_the_hosts() {
    let gpu = noop();
    let mut lighting = lighting(&gpu.0, &gpu.1);
    let settings = Settings { bounces: Bounces::Feedback, ..Settings::new(Method::Holographic) };
    let mut plan = |width, height| {
        lighting.prepare(&FrameInput::of_cells(&settings, &cells(width, height, 3))).unwrap();
        lighting.frame_plan().unwrap()
    };
    let [before, after] = [plan(48, 32), plan(64, 32)];
    let is_written = |id| before.buffers.iter().any(|own| own.id == id && own.contents.is_none());
    let kept: Vec<_> = after.buffers.iter().filter(|buffer| is_written(buffer.id)).collect();
    assert!(!kept.is_empty(), "no history is moved");
    assert!(kept.iter().all(|buffer| buffer.contents.is_none()), "it would be overwritten");
}
