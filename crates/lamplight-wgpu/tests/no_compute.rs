//! Light on devices without compute shaders and storage buffers, as under WebGL 2: the CPU finds it.

mod common;
#[path = "common/textures.rs"]
mod textures;

use common::{adapter, cells};
use lamplight::{Cells, Direct, Display, Lamp, Method, Relief, Settings, Sight, Solver};
use lamplight_wgpu::error::PrepareError;
use lamplight_wgpu::{
    Backend, Compose, ComposeParams, FrameInput, Lighting, LightingOptions, Lights, Stage,
    Textures, Tier, read_back, required_limits,
};
use textures::{fetch, filled, float, texture, view};
use wgpu::{
    Adapter, Backends, Device, DeviceDescriptor, DownlevelFlags, Instance, InstanceDescriptor,
    Limits, Queue, RequestDeviceError, TextureFormat, TextureUsages,
};

const SIZE: [u32; 2] = [67, 41];

fn open(adapter: &Adapter) -> Result<(Device, Queue), RequestDeviceError> {
    let required_limits = Limits::downlevel_webgl2_defaults();
    let descriptor = DeviceDescriptor { required_limits, ..DeviceDescriptor::default() };
    pollster::block_on(adapter.request_device(&descriptor))
}

/// A device that grants no more than WebGL 2 does, so that it rejects compute shaders and storage buffers.
fn limited() -> (Device, Queue) {
    open(&adapter()).unwrap()
}

/// A device of OpenGL, with the limits of WebGL 2; `None` on machines whose OpenGL gives none without a window.
fn opengl() -> Option<(Device, Queue)> {
    let mut descriptor = InstanceDescriptor::new_without_display_handle();
    descriptor.backends = Backends::GL;
    let instance = Instance::new(descriptor);
    let adapter = pollster::block_on(instance.request_adapter(&Default::default())).ok()?;
    println!("{:?}", adapter.get_info());
    open(&adapter).ok()
}

/// The settings of direct light with its first moment, which normals need.
fn settings() -> Settings {
    let direct = Settings::direct(Method::Holographic);
    Settings { wall_depth: 3.0, moment: true, elevation: 0.6, ..direct }
}

fn normals(cells: &mut Cells) {
    for (i, normal) in cells.normals_mut().iter_mut().enumerate() {
        *normal = if i % 3 == 0 { [0.6, 0.0, 0.8] } else { [0.0, 0.0, 1.0] };
    }
}

/// 8-bit steps by which pictures may differ: rounding of values that lie between two.
const STEP: u8 = 1;
/// The relative error of a half float.
const HALF: f32 = 1.0 / 2048.0;

/// Checks the picture and the output texture of a device against the CPU's.
fn shows_the_cpus_light((device, queue): &(Device, Queue)) {
    for with_normals in [false, true] {
        let mut cells = cells(SIZE[0], SIZE[1], 17);
        if with_normals {
            normals(&mut cells);
        }
        let settings = settings();
        let right = Solver::new(settings.clone()).unwrap().solve(&cells).unwrap().clone();
        let mut lighting = Lighting::new(device, queue, &LightingOptions::default()).unwrap();
        assert_eq!(lighting.backend(), Backend::Cpu);
        lighting.precompile(&settings).unwrap();
        let output =
            texture(device, SIZE, TextureFormat::Rgba16Float, TextureUsages::TEXTURE_BINDING);
        let output_view = view(&output);
        let input =
            FrameInput { output: Some(&output_view), ..FrameInput::of_cells(&settings, &cells) };
        let display = Display { relief: Relief::default(), ..Display::default() };
        let mut compose = Compose::new(device, queue).unwrap();
        let format = TextureFormat::Rgba8Unorm;
        let target = texture(device, SIZE, format, TextureUsages::RENDER_ATTACHMENT);
        // The second frame reuses what the first has made, under a grid that has moved.
        for origin in [[0; 2], [1, 0]] {
            lighting.prepare(&FrameInput { origin, ..input }).unwrap();
            let params = ComposeParams { display, ..ComposeParams::default() };
            compose.prepare(&lighting, format, &params).unwrap();
            let mut encoder = device.create_command_encoder(&Default::default());
            lighting.record(&mut encoder).unwrap();
            compose.record(&mut encoder, &view(&target)).unwrap();
            queue.submit([encoder.finish()]);
        }
        let picture = right.compose(&cells, &display).unwrap().into_raw();
        let seen = fetch(device, queue, &target);
        for (i, (seen, right)) in seen.chunks(4).zip(picture.chunks(3)).enumerate() {
            let near = seen.iter().zip(right).all(|(s, r)| s.abs_diff(*r) <= STEP);
            assert!(near, "pixel {i} is {seen:?} in place of {right:?}, normals: {with_normals}");
        }
        let bytes = fetch(device, queue, &output);
        let halves: &[[u16; 4]] = bytemuck::cast_slice(&bytes);
        for (seen, right) in halves.iter().zip(right.pixels()) {
            let near = |c: usize| (float(seen[c]) - right[c]).abs() <= HALF * right[c] + 1e-4;
            assert!((0..3).all(near) && float(seen[3]) == 1.0, "{seen:?} for {right:?}");
        }
        let read = read_back::light(&lighting, &cells).unwrap();
        assert_eq!(read.pixels(), right.pixels());
    }
}

#[test]
fn a_device_without_compute_shaders_shows_the_cpus_light() {
    shows_the_cpus_light(&limited());
}

#[test]
fn opengl_shows_the_cpus_light() {
    match opengl() {
        Some(gpu) => shows_the_cpus_light(&gpu),
        None => println!("no OpenGL here; on Debian: apt-get install libegl1"),
    }
}

/// The light of a host's textures on a device.
fn light_of_textures((device, queue): &(Device, Queue)) -> Vec<[f32; 4]> {
    let [mut emission, mut tint_opacity, mut albedo, mut masks] = [(); 4].map(|()| Vec::new());
    for i in 0..SIZE[0] * SIZE[1] {
        let [x, y] = [i % SIZE[0], i / SIZE[0]];
        let is_lamp = x.abs_diff(20) < 3 && y.abs_diff(12) < 3;
        let is_wall = x == 40 && y > 5;
        emission.extend(if is_lamp { [255u8, 128, 0, 0] } else { [0; 4] });
        tint_opacity.extend(match (is_lamp || is_wall, x > 50) {
            (true, _) => [255u8; 4],
            (_, true) => [255, 250, 240, 3],
            _ => [255, 255, 255, 0],
        });
        albedo.extend([200u8, 100, 50, 255]);
        masks.push(if y < 20 { 1u8 } else { 2 });
    }
    let rgba = |bytes: &[u8]| filled(device, queue, SIZE, TextureFormat::Rgba8Unorm, bytes);
    let textures = Textures {
        emission: rgba(&emission),
        tint_opacity: rgba(&tint_opacity),
        albedo: rgba(&albedo),
        // Glows everywhere a little.
        glow: Some(rgba(&[3; 4 * (SIZE[0] * SIZE[1]) as usize])),
        masks: Some(filled(device, queue, SIZE, TextureFormat::R8Unorm, &masks)),
    };
    let settings = Settings { moment: true, ..Settings::new(Method::Holographic) };
    let exact = Lamp { position: [8.0, 30.0], direct: Direct::Exact, mask: 1, ..Lamp::default() };
    let lights = Lights { lamps: &[exact], ..Lights::default() };
    let mut lighting = Lighting::new(device, queue, &LightingOptions::on(Backend::Cpu)).unwrap();
    lighting.prepare(&FrameInput::of_textures(&settings, &textures, lights)).unwrap();
    read_back::read_back(device, queue, lighting.stage(Stage::Light).unwrap()).unwrap()
}

#[test]
fn a_hosts_textures_are_lit_without_compute_shaders() {
    let whole = pollster::block_on(adapter().request_device(&DeviceDescriptor::default())).unwrap();
    let right = light_of_textures(&whole);
    assert!(right.iter().any(|light| light[0] > 0.1), "it is dark");
    assert!(light_of_textures(&limited()) == right);
    match opengl() {
        Some(gpu) => assert!(light_of_textures(&gpu) == right),
        None => println!("no OpenGL here; on Debian: apt-get install libegl1"),
    }
}

#[test]
fn what_needs_compute_shaders_is_rejected() {
    let (device, queue) = limited();
    let mut lighting = Lighting::new(&device, &queue, &LightingOptions::default()).unwrap();
    let (settings, cells) = (settings(), cells(SIZE[0], SIZE[1], 17));
    let input = FrameInput::of_cells(&settings, &cells);
    for (input, wanted) in [
        (FrameInput { distance_field: true, ..input }, "the distance field"),
        (FrameInput { sights: &[Sight::default()], ..input }, "sight"),
    ] {
        match lighting.prepare(&input) {
            Err(PrepareError::NoCompute { what }) => assert_eq!(what, wanted),
            other => panic!("{wanted}: {other:?}"),
        }
    }
    lighting.prepare(&input).unwrap();
}

#[test]
fn limits_are_those_of_the_adapter() {
    let adapter = adapter();
    let flags = adapter.get_downlevel_capabilities().flags;
    let limits = required_limits(Tier::Web, &adapter);
    let computes = flags.contains(DownlevelFlags::COMPUTE_SHADERS);
    assert_eq!(limits.max_storage_buffers_per_shader_stage > 0, computes);
}
