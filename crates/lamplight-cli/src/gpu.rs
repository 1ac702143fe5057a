//! Light found on the GPU.

use crate::args::{Backend, Renderer};
use crate::device_info::{AdapterInfo, DeviceInfo};
use crate::error::{CliError, Result};
use crate::frame_cost::{FrameCost, KernelCost};
use crate::json::to_json;
use crate::lit::Lit;
use crate::stage::Fields;
use crate::stderr;
use lamplight::{Cells, Light, Method, Settings};
use lamplight_wgpu::error::{CreateError, PrepareError, ReadBackError, RecordError};
use lamplight_wgpu::read_back::{self, read_back};
use lamplight_wgpu::wgpu::{
    Adapter, Backends, Buffer, Device, DeviceDescriptor, DeviceType, Features, Instance,
    InstanceDescriptor, PollType, PowerPreference, Queue, RequestAdapterOptions,
};
use lamplight_wgpu::{
    Cost, FrameInput, Lighting, LightingOptions, PipelineCost, Stage, Tier, Timer,
    required_features, required_limits,
};
use std::time::{Duration, Instant};

/// The options of light on the device, also if that is software: the user has chosen it.
fn on_gpu() -> LightingOptions {
    LightingOptions {
        compile_ahead: Some(false),
        ..LightingOptions::on(lamplight_wgpu::Backend::Gpu)
    }
}

/// An open device.
pub struct Gpu {
    device: Device,
    queue: Queue,
    name: String,
}

impl Gpu {
    /// The GPU to light scenes on, or none if the CPU does.
    pub fn choose(backend: Backend) -> Result<Option<Self>> {
        match backend {
            Backend::Cpu => Ok(None),
            Backend::Gpu => Self::open().map(Some),
            // A GPU that fails is no reason to stop.
            Backend::Auto => Ok(stderr::captured(|| Self::request(Candidates::Hardware)).0.ok()),
        }
    }

    /// The best GPU, a software one if there is no other.
    pub fn open() -> Result<Self> {
        let (gpu, printed) = stderr::captured(|| Self::request(Candidates::All));
        // Messages of the driver matter if it fails.
        gpu.inspect_err(|_| printed.lines().for_each(|line| eprintln!("driver: {line}")))
    }

    fn request(candidates: Candidates) -> Result<Self> {
        let options = RequestAdapterOptions {
            power_preference: PowerPreference::HighPerformance,
            ..RequestAdapterOptions::default()
        };
        let none = || {
            CliError::failed("there is no GPU here that Vulkan, Metal or DirectX 12 knows")
                .hint("`lamplight info` lists what is found; --backend cpu needs none")
        };
        let adapter =
            pollster::block_on(instance().request_adapter(&options)).map_err(|_| none())?;
        let info = adapter.get_info();
        if candidates == Candidates::Hardware && info.device_type == DeviceType::Cpu {
            return Err(none());
        }
        let wanted = DeviceDescriptor {
            required_features: required_features(Tier::Native, &adapter),
            required_limits: required_limits(Tier::Native, &adapter),
            ..DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&wanted))
            .map_err(|e| CliError::failed(format_args!("cannot open {}: {e}", info.name)))?;
        Ok(Self { device, queue, name: info.name })
    }

    /// The name of the adapter.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Adapter information for reports.
    pub fn device_info(&self) -> DeviceInfo {
        let has_clock = self.device.features().contains(Features::TIMESTAMP_QUERY);
        DeviceInfo::Gpu { adapter: self.name.clone(), has_clock }
    }

    /// Frames to be timed, and the cost of each as planned.
    pub fn frames<'a>(
        &'a self,
        cells: &'a Cells,
        settings: Settings,
    ) -> Result<(GpuFrames<'a>, FrameCost)> {
        let (device, queue) = (&self.device, &self.queue);
        let mut lighting = Lighting::new(device, queue, &on_gpu())?;
        lighting.prepare(&FrameInput::of_cells(&settings, cells))?;
        let cost = lighting.cost().ok_or_else(|| CliError::failed("no frame was planned"))?;
        // This one is never run: the next is the first.
        lighting.reset();
        let timer = Timer::new(device, queue);
        Ok((GpuFrames { gpu: self, cells, settings, lighting, timer }, frame_cost(&cost)))
    }

    /// Solves some frames and returns the light of the last.
    pub fn solve(&self, cells: &Cells, settings: Settings, frames: u32) -> Result<Lit> {
        let renderer = Renderer::Method(settings.method());
        let settings_json = to_json(&settings)?;
        let (device, queue) = (&self.device, &self.queue);
        let mut lighting = Lighting::new(device, queue, &on_gpu())?;
        lighting.precompile(&settings)?;
        let mut timer = Timer::new(device, queue);
        let start = Instant::now();
        for frame in 1..=frames {
            lighting.prepare(&FrameInput::of_cells(&settings, cells))?;
            let mut encoder = device.create_command_encoder(&Default::default());
            match &mut timer {
                Some(timer) if frame == frames => lighting.record_timed(&mut encoder, timer)?,
                _ => lighting.record(&mut encoder)?,
            }
            queue.submit([encoder.finish()]);
        }
        let light = read_back::light(&lighting, cells)?;
        let total = start.elapsed();
        let stages = stages(timer.as_mut(), total);
        let device_info = self.device_info();
        Ok(Lit {
            light,
            renderer,
            device: device_info,
            stages,
            total,
            frames,
            settings: settings_json,
        })
    }

    /// Finds the nearest occupied cell of each cell, and the distance to it.
    pub fn fields(&self, cells: &Cells, settings: Settings) -> Result<Fields> {
        let (device, queue) = (&self.device, &self.queue);
        let mut lighting = Lighting::new(device, queue, &on_gpu())?;
        let input = FrameInput::of_cells(&settings, cells);
        lighting.prepare(&FrameInput { distance_field: true, ..input })?;
        let mut encoder = device.create_command_encoder(&Default::default());
        lighting.record(&mut encoder)?;
        queue.submit([encoder.finish()]);
        let nearest = read_back(device, queue, buffer_of(&lighting, Stage::Nearest)?)?;
        let distance: Vec<f32> = read_back(device, queue, buffer_of(&lighting, Stage::Distance)?)?;
        // Shaders do without infinity, which is the distance in a grid without matter.
        let far = |d| if d == f32::MAX { f32::INFINITY } else { d };
        let distance = distance.into_iter().map(far).collect();
        Ok(Fields { nearest, distance, device: self.device_info() })
    }
}

/// The time of each stage of the last frame, or of all as one if the GPU has no clock.
fn stages(timer: Option<&mut Timer>, total: Duration) -> Vec<(&'static str, Duration)> {
    let timed = timer.map_or(&[][..], |timer| timer.read());
    if timed.is_empty() { vec![("gpu", total)] } else { timed.to_vec() }
}

/// The buffer that a stage has filled.
fn buffer_of(lighting: &Lighting, stage: Stage) -> Result<&Buffer> {
    let none = || CliError::failed(format_args!("the GPU has made no {stage:?}"));
    lighting.stage(stage).ok_or_else(none)
}

/// Frames of the same cells, one after the other.
pub struct GpuFrames<'a> {
    gpu: &'a Gpu,
    cells: &'a Cells,
    settings: Settings,
    lighting: Lighting,
    timer: Option<Timer>,
}

impl GpuFrames<'_> {
    /// Runs the next frame and returns the time of each stage or, if the GPU has no clock, of all with
    /// the way there and back.
    pub fn next(&mut self) -> Result<Vec<(&'static str, Duration)>> {
        self.lighting.prepare(&FrameInput::of_cells(&self.settings, self.cells))?;
        self.again()
    }

    /// Runs the same frame again, without cells on their way: while the GPU waits for them, its clock goes down.
    pub fn again(&mut self) -> Result<Vec<(&'static str, Duration)>> {
        let Self { gpu: Gpu { device, queue, .. }, lighting, timer, .. } = self;
        let mut encoder = device.create_command_encoder(&Default::default());
        match timer {
            Some(timer) => lighting.record_timed(&mut encoder, timer)?,
            None => lighting.record(&mut encoder)?,
        }
        let start = Instant::now();
        queue.submit([encoder.finish()]);
        device.poll(PollType::wait_indefinitely()).map_err(CliError::failed)?;
        let total = start.elapsed();
        Ok(stages(timer.as_mut(), total))
    }

    /// Fetches the light of the last frame.
    pub fn light(&self) -> Result<Light> {
        Ok(read_back::light(&self.lighting, self.cells)?)
    }
}

/// The GPUs to choose from.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Candidates {
    All,
    Hardware,
}

/// The methods that it runs.
pub const METHODS: &[Method] = Method::ALL;

/// All GPUs, software ones too.
pub fn adapters() -> Vec<AdapterInfo> {
    let enumerate = || pollster::block_on(instance().enumerate_adapters(Backends::PRIMARY));
    stderr::captured(enumerate).0.iter().map(adapter_info).collect()
}

fn adapter_info(adapter: &Adapter) -> AdapterInfo {
    let info = adapter.get_info();
    AdapterInfo {
        name: info.name,
        api: info.backend.to_str(),
        kind: kind(info.device_type),
        driver: info.driver_info,
        side: adapter.limits().max_texture_dimension_2d,
        times_stages: required_features(Tier::Native, adapter).contains(Features::TIMESTAMP_QUERY),
    }
}

fn kind(device: DeviceType) -> &'static str {
    match device {
        DeviceType::DiscreteGpu => "discrete",
        DeviceType::IntegratedGpu => "integrated",
        DeviceType::VirtualGpu => "virtual",
        DeviceType::Cpu => "software",
        DeviceType::Other => "of another kind",
    }
}

fn frame_cost(cost: &Cost) -> FrameCost {
    let kernel = |pipeline: &PipelineCost| KernelCost {
        shader: pipeline.shader,
        entry: pipeline.entry,
        dispatches: pipeline.dispatches,
        bytes_read: pipeline.traffic.read,
        bytes_written: pipeline.traffic.written,
    };
    FrameCost { kernels: cost.pipelines.iter().map(kernel).collect(), bytes_held: cost.memory }
}

fn instance() -> Instance {
    let mut descriptor = InstanceDescriptor::new_without_display_handle_from_env();
    descriptor.backends &= Backends::PRIMARY;
    Instance::new(descriptor)
}

impl From<CreateError> for CliError {
    fn from(error: CreateError) -> Self {
        match error {
            CreateError::Settings(error) => error.into(),
            _ => Self::bad_input(error),
        }
    }
}

impl From<PrepareError> for CliError {
    fn from(error: PrepareError) -> Self {
        match error {
            PrepareError::Input(error) => error.into(),
            _ => Self::bad_input(error),
        }
    }
}

impl From<RecordError> for CliError {
    fn from(error: RecordError) -> Self {
        Self::failed(error)
    }
}

impl From<ReadBackError> for CliError {
    fn from(error: ReadBackError) -> Self {
        Self::failed(error)
    }
}
