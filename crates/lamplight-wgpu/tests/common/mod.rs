//! A device for tests, and cells to light.

// Each test program uses its own part of this.
#![allow(dead_code)]

use lamplight::settings::Raymarch;
use lamplight::{Cells, Matter, Rgb, Settings};
use lamplight_wgpu::read_back::read_back;
use lamplight_wgpu::{
    Backend, FrameInput, Lighting, LightingOptions, Stage, Tier, required_features, required_limits,
};
use std::sync::{LazyLock, Mutex, PoisonError};
use wgpu::{
    Adapter, Backends, Device, DeviceDescriptor, Features, Instance, InstanceDescriptor, Limits,
    PowerPreference, Queue, RequestAdapterOptions,
};

/// The settings of `raymarch`, to be changed.
pub fn raymarch_of(settings: &mut Settings) -> &mut Raymarch {
    settings.method.as_raymarch_mut().expect("settings of raymarch")
}

/// One for all tests of a program: devices of different ones are not told apart.
static INSTANCE: LazyLock<Instance> = LazyLock::new(|| {
    let mut descriptor = InstanceDescriptor::new_without_display_handle();
    descriptor.backends = Backends::PRIMARY;
    Instance::new(descriptor)
});

/// The machine's best GPU, a software one if there is no other. Without any the test fails:
/// `cargo xtask test` installs a software one.
pub fn adapter() -> Adapter {
    let options = RequestAdapterOptions {
        power_preference: PowerPreference::HighPerformance,
        ..RequestAdapterOptions::default()
    };
    let adapter = pollster::block_on(INSTANCE.request_adapter(&options))
        .expect("no GPU; on Debian: apt-get install mesa-vulkan-drivers");
    println!("{:?}", adapter.get_info());
    adapter
}

/// A device with the features and limits of a tier.
pub fn device_of(tier: Tier) -> (Device, Queue) {
    open(&adapter(), tier)
}

/// A device of an adapter.
pub fn open(adapter: &Adapter, tier: Tier) -> (Device, Queue) {
    let features = required_features(tier, adapter);
    open_with(adapter, features, required_limits(tier, adapter))
}

fn open_with(
    adapter: &Adapter,
    required_features: Features,
    required_limits: Limits,
) -> (Device, Queue) {
    let descriptor =
        DeviceDescriptor { required_features, required_limits, ..DeviceDescriptor::default() };
    pollster::block_on(adapter.request_device(&descriptor)).unwrap()
}

/// The device of the tests of a program, and an instance whose pipelines the others share: to compile them is most of the
/// time of a small frame.
static SHARED: LazyLock<((Device, Queue), Mutex<Lighting>)> = LazyLock::new(|| {
    let (device, queue) = device_of(Tier::Web);
    let lighting = Lighting::new(&device, &queue, &on_gpu()).unwrap();
    ((device, queue), Mutex::new(lighting))
});

/// A device with no more than the web grants.
pub fn device() -> (Device, Queue) {
    SHARED.0.clone()
}

/// A device with less than the web grants.
pub fn device_with(lower: impl Fn(&mut Limits)) -> (Device, Queue) {
    let mut limits = Limits::default();
    lower(&mut limits);
    open_with(&adapter(), Features::empty(), limits)
}

/// A [`Lighting`] on the device, also if that is software.
pub fn lighting(device: &Device, queue: &Queue) -> Lighting {
    let ((shared, _), beside) = &*SHARED;
    if device == shared {
        beside.lock().unwrap_or_else(PoisonError::into_inner).beside(&on_gpu()).unwrap()
    } else {
        Lighting::new(device, queue, &on_gpu()).unwrap()
    }
}

/// The GPU, without threads beside the test.
pub fn on_gpu() -> LightingOptions {
    LightingOptions { compile_ahead: Some(false), ..LightingOptions::on(Backend::Gpu) }
}

/// Records and submits the frame prepared last, and fetches the light.
pub fn recorded(device: &Device, queue: &Queue, lighting: &Lighting) -> Vec<[f32; 4]> {
    let mut encoder = device.create_command_encoder(&Default::default());
    lighting.record(&mut encoder).unwrap();
    queue.submit([encoder.finish()]);
    read_back(device, queue, lighting.stage(Stage::Light).unwrap()).unwrap()
}

/// Lights cells, and fetches the light without its first moment.
pub fn frame(
    device: &Device,
    queue: &Queue,
    lighting: &mut Lighting,
    settings: &Settings,
    cells: &Cells,
) -> Vec<[f32; 4]> {
    lighting.prepare(&FrameInput::of_cells(settings, cells)).unwrap();
    let mut light = recorded(device, queue, lighting);
    light.truncate(cells.len());
    light
}

/// A random number generator with this seed, printed so that a failure can be repeated.
pub fn seeded(seed: u64) -> fastrand::Rng {
    println!("seed {seed}");
    fastrand::Rng::with_seed(seed)
}

/// Random walls, lights, fog and glass, in blocks and alone, under a sky.
pub fn cells(width: u32, height: u32, seed: u64) -> Cells {
    let mut random = seeded(seed);
    let mut cells = Cells::new(width, height).unwrap();
    cells.set_sky(lamplight::Sky::Uniform([0.1, 0.2, 0.3]));
    let count = (width * height / 60).max(1);
    for _ in 0..count {
        let colour: Rgb = std::array::from_fn(|_| random.f32());
        let matter = match random.u32(..5) {
            0 => Matter { emission: colour.map(|v| 8.0 * v), opacity: 1.0, ..Matter::EMPTY },
            1 => Matter { opacity: 0.1, emission: colour, albedo: [0.5; 3], ..Matter::EMPTY },
            2 => Matter { tint: colour, ..Matter::EMPTY },
            _ => Matter { opacity: 1.0, albedo: colour, ..Matter::EMPTY },
        };
        let [x, y] = [random.u32(..width), random.u32(..height)];
        let [w, h] = [1 + random.u32(..6), 1 + random.u32(..3)];
        for y in y..(y + h).min(height) {
            for x in x..(x + w).min(width) {
                cells.set(x, y, matter);
            }
        }
    }
    cells
}
