//! The GPU, for commands that light scenes.

use crate::args::{Answer, Backend};
use crate::failure::{Failure, Outcome};
use crate::lighting::{Lit, to_json};
use crate::place::Place;
use crate::stage::Fields;
use lamplight::{Cells, Light, Settings};
use lamplight_wgpu::read_back::{self, read_back};
use lamplight_wgpu::wgpu::{
    Adapter, Backends, Buffer, Device, DeviceDescriptor, DeviceType, Features, Instance,
    InstanceDescriptor, PollType, PowerPreference, Queue, RequestAdapterOptions,
};
use lamplight_wgpu::{Cost, Lighting, Stage, Tier, Timer, required_features, required_limits};
use std::time::{Duration, Instant};

/// An open device.
pub struct Gpu {
    device: Device,
    queue: Queue,
    name: String,
}

impl Gpu {
    /// The GPU to solve on; none: the CPU is to do it.
    pub fn choose(backend: Backend) -> Outcome<Option<Self>> {
        match backend {
            Backend::Cpu => Ok(None),
            Backend::Gpu => Self::open(false).map(Some),
            // A GPU that fails is no reason to stop.
            Backend::Auto => Ok(Self::open(true).ok()),
        }
    }

    /// The best GPU; `hardware`: no software one.
    fn open(hardware: bool) -> Outcome<Self> {
        let options = RequestAdapterOptions {
            power_preference: PowerPreference::HighPerformance,
            ..RequestAdapterOptions::default()
        };
        let none = || {
            Failure::failed("there is no GPU here that Vulkan, Metal or DirectX 12 knows")
                .hint("`lamplight info` lists what is found; --backend cpu needs none")
        };
        let adapter =
            pollster::block_on(instance().request_adapter(&options)).map_err(|_| none())?;
        let info = adapter.get_info();
        if hardware && info.device_type == DeviceType::Cpu {
            return Err(none());
        }
        let wanted = DeviceDescriptor {
            required_features: required_features(Tier::Native, &adapter),
            required_limits: required_limits(Tier::Native, &adapter),
            ..DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&wanted))
            .map_err(|e| Failure::failed(format_args!("cannot open {}: {e}", info.name)))?;
        Ok(Self { device, queue, name: info.name })
    }

    /// The GPU that commands run on that ask for one.
    pub fn best() -> Outcome<Self> {
        Self::open(false)
    }

    /// Which one it is.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where what it computes was computed.
    pub fn place(&self) -> Place {
        let has_clock = self.device.features().contains(Features::TIMESTAMP_QUERY);
        Place::Gpu { adapter: self.name.clone(), has_clock }
    }

    /// Frames to be timed, and what each takes by the code's own account.
    pub fn frames<'a>(
        &'a self,
        cells: &'a Cells,
        settings: Settings,
    ) -> Outcome<(Frames<'a>, Cost)> {
        let (device, queue) = (&self.device, &self.queue);
        let mut lighting = Lighting::new(device, queue, settings)?;
        lighting.prepare(device, queue, cells)?;
        let cost = lighting.cost().ok_or_else(|| Failure::failed("no frame was planned"))?;
        // This one is never run: the next is the first.
        lighting.reset();
        Ok((Frames { gpu: self, cells, lighting, timer: Timer::new(device, queue) }, cost))
    }

    /// Solves some frames and fetches the light of the last.
    pub fn solve(&self, cells: &Cells, settings: Settings, frames: u32) -> Outcome<Lit> {
        let answer = Answer::By(settings.method);
        let told = to_json(&settings)?;
        let (device, queue) = (&self.device, &self.queue);
        let mut lighting = Lighting::new(device, queue, settings)?;
        let mut timer = Timer::new(device, queue);
        let start = Instant::now();
        for frame in 1..=frames {
            lighting.prepare(device, queue, cells)?;
            let mut encoder = device.create_command_encoder(&Default::default());
            match &mut timer {
                Some(timer) if frame == frames => lighting.record_timed(&mut encoder, timer),
                _ => lighting.record(&mut encoder),
            }
            queue.submit([encoder.finish()]);
        }
        let light = read_back::light(device, queue, &lighting, cells)?;
        let total = start.elapsed();
        let stages = stages(timer.as_mut(), total);
        let place = self.place();
        Ok(Lit { light, answer, place, stages, total, frames, settings: told })
    }

    /// Finds the nearest occupied cell of each cell, and how far it is.
    pub fn fields(&self, cells: &Cells, settings: Settings) -> Outcome<Fields> {
        let (device, queue) = (&self.device, &self.queue);
        let mut lighting = Lighting::new(device, queue, settings)?;
        lighting.prepare(device, queue, cells)?;
        let mut encoder = device.create_command_encoder(&Default::default());
        lighting.record_fields(device, &mut encoder)?;
        queue.submit([encoder.finish()]);
        let nearest = read_back(device, queue, made(&lighting, Stage::Nearest)?)?;
        let distance: Vec<f32> = read_back(device, queue, made(&lighting, Stage::Distance)?)?;
        // Where there is no matter: shaders do without infinity.
        let far = |d| if d == f32::MAX { f32::INFINITY } else { d };
        let distance = distance.into_iter().map(far).collect();
        Ok(Fields { nearest, distance, place: self.place() })
    }
}

/// The stages of the last frame; one for all where the GPU tells no times.
fn stages(timer: Option<&mut Timer>, total: Duration) -> Vec<(&'static str, Duration)> {
    let timed = timer.map_or(&[][..], |timer| timer.read());
    if timed.is_empty() { vec![("gpu", total)] } else { timed.to_vec() }
}

/// What a stage has left behind.
fn made(lighting: &Lighting, stage: Stage) -> Outcome<&Buffer> {
    let none = || Failure::failed(format_args!("the GPU has made no {stage:?}"));
    lighting.stage(stage).ok_or_else(none)
}

/// One frame over and over, for who times it.
pub struct Frames<'a> {
    gpu: &'a Gpu,
    cells: &'a Cells,
    lighting: Lighting,
    timer: Option<Timer>,
}

impl Frames<'_> {
    /// Runs the next frame; says what each stage took or, where the GPU tells no times, all of it with
    /// the way there and back.
    pub fn next(&mut self) -> Outcome<Vec<(&'static str, Duration)>> {
        let Self { gpu: Gpu { device, queue, .. }, cells, lighting, timer } = self;
        lighting.prepare(device, queue, cells)?;
        let mut encoder = device.create_command_encoder(&Default::default());
        match timer {
            Some(timer) => lighting.record_timed(&mut encoder, timer),
            None => lighting.record(&mut encoder),
        }
        let start = Instant::now();
        queue.submit([encoder.finish()]);
        device.poll(PollType::wait_indefinitely()).map_err(Failure::failed)?;
        let total = start.elapsed();
        Ok(stages(timer.as_mut(), total))
    }

    /// Fetches the light of the last frame.
    pub fn light(&self) -> Outcome<Light> {
        let Gpu { device, queue, .. } = self.gpu;
        Ok(read_back::light(device, queue, &self.lighting, self.cells)?)
    }
}

/// All GPUs that are found, software ones among them.
pub fn adapters() -> Vec<Adapter> {
    pollster::block_on(instance().enumerate_adapters(Backends::PRIMARY))
}

/// Whether an adapter can tell what each stage takes.
pub fn times_stages(adapter: &Adapter) -> bool {
    required_features(Tier::Native, adapter).contains(Features::TIMESTAMP_QUERY)
}

fn instance() -> Instance {
    let mut descriptor = InstanceDescriptor::new_without_display_handle_from_env();
    descriptor.backends &= Backends::PRIMARY;
    Instance::new(descriptor)
}

impl From<lamplight_wgpu::Error> for Failure {
    fn from(error: lamplight_wgpu::Error) -> Self {
        match error {
            lamplight_wgpu::Error::Refused(error) => error.into(),
            lamplight_wgpu::Error::ReadBack(_) => Self::failed(error),
            _ => Self::bad_input(error),
        }
    }
}
