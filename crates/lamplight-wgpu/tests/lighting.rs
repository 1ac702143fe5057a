//! The middleware as hosts use it.

mod common;
#[path = "common/textures.rs"]
mod textures;

use common::{cells, device, device_of, frame, lighting, on_gpu, raymarch_of, recorded};
use lamplight::surroundings::Surroundings;
use lamplight::world::{World, WorldSettings};
use lamplight::{
    Bounces, Cells, Direct, GridWindow, Inflow, Lamp, Matter, Method, Rgb, Settings, Sky, Solver,
};
use lamplight_wgpu::error::{PrepareError, RecordError};
use lamplight_wgpu::read_back::light;
use lamplight_wgpu::{
    Backend, FrameInput, Lighting, LightingOptions, Lights, Stage, Textures, Tier, Timer,
};
use textures::{fetch, filled, float, texture, view};
use wgpu::{Device, DeviceType, PollType, Queue, TextureFormat, TextureUsages};

fn raymarch() -> Settings {
    Settings::direct(Method::Raymarch)
}

#[test]
fn invalid_settings_options_and_cells_are_rejected_as_on_the_cpu() {
    let (device, queue) = device();
    let mut lighting = lighting(&device, &queue);
    let mut settings = raymarch();
    raymarch_of(&mut settings).rays = 0;
    let good = Cells::new(4, 4).unwrap();
    let error = lighting.prepare(&FrameInput::of_cells(&settings, &good)).unwrap_err().to_string();
    assert!(error.starts_with("`raymarch.rays` is 0"), "{error}");
    let error = lighting.precompile(&settings).unwrap_err().to_string();
    assert!(error.starts_with("`raymarch.rays` is 0"), "{error}");

    let mut dark = good;
    dark.emission_mut()[5] = [f32::NAN; 3];
    let error =
        lighting.prepare(&FrameInput::of_cells(&raymarch(), &dark)).unwrap_err().to_string();
    assert!(error.contains("cell (1, 1)"), "{error}");

    for levels in [0, 3] {
        let fused_levels = Some(levels);
        let options = LightingOptions { fused_levels, ..LightingOptions::default() };
        let error = Lighting::new(&device, &queue, &options).unwrap_err();
        let wanted = format!("the option `fused_levels` is {levels}, not from 1 to 2");
        assert_eq!(error.to_string(), wanted);
    }
}

/// A [`Lighting`] whose light the CPU finds.
fn on_cpu(device: &Device, queue: &Queue) -> Lighting {
    Lighting::new(device, queue, &LightingOptions::on(Backend::Cpu)).unwrap()
}

/// The relative difference, as in tests of parity.
const TOLERANCE: f32 = 1e-3;

#[test]
fn the_faster_backend_goes_on_with_the_same_light() {
    let (device, queue) = device_of(Tier::Native);
    let settings = Settings::direct(Method::Holographic);
    let cells = cells(96, 54, 11);
    let mut lighting =
        Lighting::new(&device, &queue, &LightingOptions::on(Backend::Fastest)).unwrap();
    assert_eq!(lighting.backend(), Backend::Gpu);
    let first = frame(&device, &queue, &mut lighting, &settings, &cells);
    let mean = first.as_flattened().iter().sum::<f32>() / (4 * first.len()) as f32;
    for _ in 0..20 {
        let light = frame(&device, &queue, &mut lighting, &settings, &cells);
        for (one, other) in light.as_flattened().iter().zip(first.as_flattened()) {
            assert!((one - other).abs() <= TOLERANCE * other.max(mean), "light flickers");
        }
    }
    // Also if the host times its frames itself.
    let mut timed = Lighting::new(&device, &queue, &LightingOptions::on(Backend::Fastest)).unwrap();
    let mut timer = Timer::new(&device, &queue).expect("the adapter has timestamps");
    let mut shone_on = cells.clone();
    shone_on.lamps_mut().push(exact_lamp());
    for _ in 0..20 {
        timed.prepare(&FrameInput::of_cells(&settings, &shone_on)).unwrap();
        let mut encoder = device.create_command_encoder(&Default::default());
        timed.record_timed(&mut encoder, &mut timer).unwrap();
        queue.submit([encoder.finish()]);
        device.poll(PollType::wait_indefinitely()).unwrap();
    }
    // Only on a software GPU it is known which is faster.
    if device.adapter_info().device_type == DeviceType::Cpu {
        assert_eq!([lighting.backend(), timed.backend()], [Backend::Cpu; 2]);
        let dispatches = timed.cost().unwrap().dispatches();
        assert_eq!(dispatches, 0, "the GPU goes on with direct light");
    }
    let (device, queue) = device_of(Tier::Web);
    let mut untimed =
        Lighting::new(&device, &queue, &LightingOptions::on(Backend::Fastest)).unwrap();
    for _ in 0..20 {
        frame(&device, &queue, &mut untimed, &settings, &cells);
    }
    assert_eq!(untimed.backend(), Backend::Gpu, "chosen without times");
}

/// A lamp that is lit by its own shadow.
fn exact_lamp() -> Lamp {
    Lamp { position: [20.0, 15.0], range: 40.0, direct: Direct::Exact, ..Lamp::default() }
}

#[test]
fn direct_light_that_returns_has_its_moment() {
    let (device, queue) = device();
    let flat = Settings::direct(Method::Cascades);
    let tilted = Settings { moment: true, ..flat.clone() };
    let dark = cells(41, 31, 5);
    let mut lit = dark.clone();
    lit.lamps_mut().push(exact_lamp());
    let light = |lighting: &mut Lighting, settings: &Settings, cells: &Cells| {
        lighting.prepare(&FrameInput::of_cells(settings, cells)).unwrap();
        recorded(&device, &queue, lighting)
    };
    let [mut one, mut fresh] = [(); 2].map(|()| lighting(&device, &queue));
    for (settings, cells) in [(&flat, &lit), (&flat, &dark), (&tilted, &dark)] {
        light(&mut one, settings, cells);
    }
    let [found, expected] = [&mut one, &mut fresh].map(|own| light(own, &tilted, &lit));
    assert!(found == expected);
    assert!(light(&mut one, &tilted, &dark) != expected, "the lamp lights nothing");
}

#[test]
fn a_grid_beyond_the_devices_limits_is_rejected_and_the_next_one_lit() {
    let (device, queue) = device();
    let limits = device.limits();
    let settings = raymarch();
    let mut one = lighting(&device, &queue);
    let mut error = |settings: &Settings, [width, height]: [u32; 2]| {
        let cells = Cells::new(width, height).unwrap();
        one.prepare(&FrameInput::of_cells(settings, &cells)).unwrap_err().to_string()
    };
    let wide = error(&settings, [limits.max_texture_dimension_2d + 1, 1]);
    assert!(wide.contains("px a side, but this device allows"), "{wide}");
    let large = error(&settings, [4096, 2049]);
    assert!(large.contains("bytes a buffer, but this device allows"), "{large}");
    // Millions of rays.
    let mut cascades = Settings::direct(Method::Cascades);
    (
        cascades.method.as_cascades_mut().unwrap().rays,
        cascades.method.as_cascades_mut().unwrap().interval,
    ) = (64, 0.25);
    let long = error(&cascades, [8192, 1]);
    assert!(long.contains("bytes a buffer, but this device allows"), "{long}");
    assert!(one.stage(Stage::Light).is_none());
    assert_eq!(frame(&device, &queue, &mut one, &settings, &cells(9, 5, 1)).len(), 45);
}

#[test]
fn sizes_may_change_and_many_share_a_device() {
    let (device, queue) = device();
    let settings = raymarch();
    let [mut one, mut other] = [(), ()].map(|()| lighting(&device, &queue));
    for [w, h] in [[31, 17], [8, 8], [31, 17], [97, 3]] {
        let cells = cells(w, h, 2);
        let lit = frame(&device, &queue, &mut one, &settings, &cells);
        assert_eq!(lit.len(), (w * h) as usize);
        assert_eq!(lit, frame(&device, &queue, &mut other, &settings, &cells));
    }
}

#[test]
fn an_instance_beside_another_compiles_nothing_again() {
    // Not the device of the other tests, which compile too.
    let (device, queue) = device_of(Tier::Web);
    let (settings, cells) = (raymarch(), cells(31, 17, 2));
    let mut one = lighting(&device, &queue);
    let right = frame(&device, &queue, &mut one, &settings, &cells);
    assert!(one.compiled() > 0);
    let mut beside = one.beside(&on_gpu()).unwrap();
    assert_eq!(frame(&device, &queue, &mut beside, &settings, &cells), right);
    assert_eq!(beside.compiled(), 0);
    drop(one);
    assert_eq!(frame(&device, &queue, &mut beside, &settings, &cells).len(), right.len());
}

#[test]
fn recording_before_the_first_frame_is_an_error() {
    let (device, queue) = device();
    let lighting = lighting(&device, &queue);
    let mut encoder = device.create_command_encoder(&Default::default());
    assert_eq!(lighting.record(&mut encoder), Err(RecordError::NotPrepared));
    assert!(lighting.stage(Stage::Light).is_none());
    assert!(lighting.settings().is_none() && lighting.cost().is_none());
}

/// A lit room in a game's usual formats: a lamp, a wall, glass.
fn host_textures(device: &Device, queue: &Queue) -> (Textures, Cells) {
    let size = [48, 32];
    let mut cells = Cells::new(48, 32).unwrap();
    for y in 4..28 {
        let wall = Matter { opacity: 1.0, albedo: [1.0, 0.0, 0.0], ..Matter::EMPTY };
        cells.set(30, y, wall);
        cells.set(12, y, Matter { tint: [0.0, 1.0, 0.0], ..Matter::EMPTY });
    }
    cells.set(20, 16, Matter { emission: [8.0, 4.0, 2.0], opacity: 1.0, ..Matter::EMPTY });
    cells.set(5, 8, Matter { glow: [0.5, 0.0, 2.0], ..Matter::EMPTY });
    let half = |v: f32| {
        if v == 0.0 {
            return 0u16;
        }
        (((v.to_bits() >> 23) as u16 - 112) << 10) | (v.to_bits() >> 13 & 0x3ff) as u16
    };
    let halves = |rgb: &[Rgb]| -> Vec<[u16; 4]> {
        rgb.iter().map(|&[r, g, b]| [half(r), half(g), half(b), 0]).collect()
    };
    let (emission, glow) = (halves(cells.emission()), halves(cells.glow().unwrap()));
    let unorm = |v: f32| (v * 255.0) as u8;
    let tints = cells.tint().iter().zip(cells.opacity());
    let tints: Vec<[u8; 4]> =
        tints.map(|(&[r, g, b], &a)| [unorm(r), unorm(g), unorm(b), unorm(a)]).collect();
    let albedo: Vec<[u8; 4]> =
        cells.albedo().iter().map(|&[r, g, b]| [unorm(r), unorm(g), unorm(b), 255]).collect();
    let made = |format, bytes: &[u8]| filled(device, queue, size, format, bytes);
    let textures = Textures {
        emission: made(TextureFormat::Rgba16Float, bytemuck::cast_slice(&emission)),
        tint_opacity: made(TextureFormat::Rgba8Unorm, bytemuck::cast_slice(&tints)),
        albedo: made(TextureFormat::Rgba8Unorm, bytemuck::cast_slice(&albedo)),
        glow: Some(made(TextureFormat::Rgba16Float, bytemuck::cast_slice(&glow))),
        masks: None,
    };
    (textures, cells)
}

#[test]
fn a_hosts_textures_are_lit_into_its_own() {
    let (device, queue) = device();
    let (textures, mut cells) = host_textures(&device, &queue);
    let sky = Sky::Uniform([0.0, 0.0, 0.5]);
    cells.set_sky(sky.clone());
    let settings = Settings { bounces: Bounces::Count(1), ..raymarch() };
    let right = frame(&device, &queue, &mut lighting(&device, &queue), &settings, &cells);

    let mut lighting = lighting(&device, &queue);
    let format = TextureFormat::Rgba16Float;
    let output = texture(&device, [48, 32], format, TextureUsages::STORAGE_BINDING);
    let input =
        FrameInput::of_textures(&settings, &textures, Lights { sky: &sky, ..Lights::default() });
    lighting.prepare(&FrameInput { output: Some(&view(&output)), ..input }).unwrap();
    assert_eq!(recorded(&device, &queue, &lighting), right);
    let picture = fetch(&device, &queue, &output);
    let picture: &[[u16; 4]] = bytemuck::cast_slice(&picture);
    for (i, right) in right.iter().enumerate() {
        let seen = picture[i].map(float);
        for c in 0..4 {
            let off = (seen[c] - right[c]).abs();
            assert!(off <= 1e-3 * right[c] + 1e-4, "texel {i}: {seen:?}, not {right:?}");
        }
    }
    assert!(right.iter().any(|l| l[0] > 0.2) && right.iter().any(|l| l[0] < 0.01));
}

#[test]
fn software_devices_leave_the_light_to_the_cpu() {
    let (device, queue) = device();
    let software = device.adapter_info().device_type == DeviceType::Cpu;
    let backend =
        |wanted| Lighting::new(&device, &queue, &LightingOptions::on(wanted)).unwrap().backend();
    let auto = if software { Backend::Cpu } else { Backend::Gpu };
    let expected = [Backend::Gpu, Backend::Cpu, auto];
    assert_eq!([Backend::Gpu, Backend::Cpu, Backend::Auto].map(backend), expected);
}

#[test]
fn the_cpu_gives_cells_the_light_of_the_solver() {
    let (device, queue) = device();
    let mut on_cpu = on_cpu(&device, &queue);
    for &method in Method::ALL {
        for moment in [false, true] {
            let settings = Settings { moment, ..Settings::new(method) };
            let mut solver = Solver::new(settings.clone()).unwrap();
            // With the moment alone history would go on.
            on_cpu.reset();
            // The second frame has history, and the third another size.
            for [w, h] in [[31, 17], [31, 17], [20, 24]] {
                let mut cells = cells(w, h, 7);
                cells.lamps_mut().push(Lamp { position: [8.0, 9.0], ..Lamp::default() });
                let right = solver.solve(&cells).unwrap();
                on_cpu.prepare(&FrameInput::of_cells(&settings, &cells)).unwrap();
                let seen = light(&on_cpu, &cells).unwrap();
                assert!(seen.pixels() == right.pixels(), "{method:?}");
                assert!(seen.moment() == right.moment(), "{method:?}");
                assert_eq!(seen.moment().is_some(), moment, "{method:?}");
            }
        }
    }
}

#[test]
fn the_cpu_lights_a_hosts_textures_as_the_gpu_does() {
    let (device, queue) = device();
    let (mut textures, _) = host_textures(&device, &queue);
    // The right half is in another layer.
    let masks: Vec<u8> = (0..48 * 32).map(|i| if i % 48 < 24 { 1 } else { 2 }).collect();
    textures.masks = Some(filled(&device, &queue, [48, 32], TextureFormat::R8Unorm, &masks));
    let sky = Sky::Uniform([0.0, 0.0, 0.25]);
    let lamps = [
        // It is in the textures, if the method does not light it by rule.
        Lamp { position: [40.0, 20.0], ..Lamp::default() },
        Lamp { position: [8.0, 26.0], direct: Direct::Exact, mask: 1, ..Lamp::default() },
    ];
    let lights = Lights { sky: &sky, lamps: &lamps, ..Lights::default() };
    for method in [Method::Cascades, Method::Holographic, Method::Polar] {
        let settings = Settings { bounces: Bounces::Count(1), ..Settings::new(method) };
        let lit = |mut lighting: Lighting| {
            let output = texture(
                &device,
                [48, 32],
                TextureFormat::Rgba16Float,
                TextureUsages::STORAGE_BINDING,
            );
            let input = FrameInput::of_textures(&settings, &textures, lights);
            lighting.prepare(&FrameInput { output: Some(&view(&output)), ..input }).unwrap();
            let light = recorded(&device, &queue, &lighting);
            (light, fetch(&device, &queue, &output))
        };
        let (right, _) = lit(lighting(&device, &queue));
        let (seen, output) = lit(on_cpu(&device, &queue));
        let output: &[[u16; 4]] = bytemuck::cast_slice(&output);
        for (i, right) in right.iter().enumerate() {
            for c in 0..3 {
                let off = (seen[i][c] - right[c]).abs();
                assert!(off <= 1e-3 * right[c] + 1e-5, "{method:?}, {i}: {:?}, {right:?}", seen[i]);
                let off = (float(output[i][c]) - seen[i][c]).abs();
                assert!(off <= 1e-3 * seen[i][c] + 1e-4, "{method:?}, texel {i}");
            }
        }
        assert!(right.iter().any(|l| l[0] > 0.2), "{method:?} is dark");
    }
}

#[test]
fn a_hosts_textures_are_lit_in_their_surroundings_on_both() {
    let (device, queue) = device();
    let (textures, _) = host_textures(&device, &queue);
    let settings = Settings::new(Method::Holographic);
    let around = cells(192, 96, 5);
    let world = World::new(&around, WorldSettings::new(settings.clone()), |_, _| ()).unwrap();
    let mut surroundings = Surroundings::new(&world, 0);
    let window = surroundings.window(GridWindow { first: [64, 32], size: [48, 32] }).unwrap();
    let inflow_of = |intensity: f32, to: &mut Surroundings| {
        let lamp = Lamp { position: [120.0, 40.0], intensity, ..Lamp::default() };
        to.inflow(window, &[lamp]).unwrap()
    };
    let [inflow, brighter] = [12.0, 13.0].map(|v| inflow_of(v, &mut surroundings));
    let lit = |mut lighting: Lighting, inflow: &Inflow| {
        let lights = Lights { inflow: Some(inflow), ..Lights::default() };
        lighting.prepare(&FrameInput::of_textures(&settings, &textures, lights)).unwrap();
        recorded(&device, &queue, &lighting)
    };
    let right = lit(lighting(&device, &queue), &inflow);
    let agrees = |seen: &[[f32; 4]]| {
        let pairs = seen.iter().zip(&right);
        pairs.clone().all(|(seen, right)| {
            (0..3).all(|c| (seen[c] - right[c]).abs() <= 1e-3 * right[c] + 1e-5)
        })
    };
    assert!(agrees(&lit(on_cpu(&device, &queue), &inflow)));
    assert!(!agrees(&lit(on_cpu(&device, &queue), &brighter)), "another lamp passes");

    let other = Inflow::new([32, 48], 8, |_, _| [1.0; 3]).unwrap();
    let lights = Lights { inflow: Some(&other), ..Lights::default() };
    for mut lighting in [lighting(&device, &queue), on_cpu(&device, &queue)] {
        let input = FrameInput::of_textures(&settings, &textures, lights);
        let error = lighting.prepare(&input).unwrap_err().to_string();
        assert!(error.contains("32×48") && error.contains("48×32"), "{error}");
    }
}

#[test]
fn history_goes_on_when_textures_are_exchanged() {
    let (device, queue) = device();
    let two = [host_textures(&device, &queue).0, host_textures(&device, &queue).0];
    let mut settings = raymarch();
    settings.bounces = Bounces::Feedback;
    raymarch_of(&mut settings).temporal.history_length = 8;
    let light = |exchange: usize| -> Vec<[f32; 4]> {
        let mut lighting = lighting(&device, &queue);
        let mut light = Vec::new();
        for number in 0..5 {
            let textures = &two[number * exchange % 2];
            let input = FrameInput::of_textures(&settings, textures, Lights::default());
            lighting.prepare(&input).unwrap();
            light = recorded(&device, &queue, &lighting);
        }
        light
    };
    assert_eq!(light(0), light(1));
}

#[test]
fn textures_that_cannot_be_used_are_named_with_the_reason() {
    let (device, queue) = device();
    let (good, _) = host_textures(&device, &queue);
    let mut lighting = lighting(&device, &queue);
    let settings = raymarch();
    let bound = TextureUsages::TEXTURE_BINDING;
    let mut rejected = |textures: Textures| {
        let input = FrameInput::of_textures(&settings, &textures, Lights::default());
        lighting.prepare(&input).unwrap_err().to_string()
    };
    let other = |format, usage, size| view(&texture(&device, size, format, usage));
    let integers = other(TextureFormat::Rgba8Uint, bound, [48, 32]);
    let unbound = other(TextureFormat::Rgba8Unorm, TextureUsages::COPY_SRC, [48, 32]);
    let small = other(TextureFormat::Rgba8Unorm, bound, [47, 32]);
    assert_eq!(
        rejected(Textures { emission: integers, ..good.clone() }),
        "the texture `emission` has the format Rgba8Uint, not floats"
    );
    assert_eq!(
        rejected(Textures { albedo: unbound, ..good.clone() }),
        "the texture `albedo` lacks the usage TEXTURE_BINDING"
    );
    assert_eq!(
        rejected(Textures { tint_opacity: small.clone(), ..good.clone() }),
        "the texture `tint_opacity` is 47×32, but emission is 48×32"
    );

    let half = TextureFormat::Rgba16Float;
    let output = |format, usage, size| view(&texture(&device, size, format, usage));
    let stored = TextureUsages::STORAGE_BINDING;
    let input = FrameInput::of_textures(&settings, &good, Lights::default());
    for (picture, problem) in [
        (output(TextureFormat::Rgba8Unorm, stored, [48, 32]), "has the format Rgba8Unorm, not"),
        (output(half, bound, [48, 32]), "lacks the usage STORAGE_BINDING"),
        (output(half, stored, [48, 31]), "is 48×31, but the grid is 48×32"),
    ] {
        let input = FrameInput { output: Some(&picture), ..input };
        let error = lighting.prepare(&input).unwrap_err().to_string();
        assert!(error.contains(problem), "{error}");
    }
    let right = output(half, stored, [48, 32]);
    lighting.prepare(&FrameInput { output: Some(&right), ..input }).unwrap();
}

fn polar() -> Settings {
    Settings::direct(Method::Polar)
}

#[test]
fn lamps_light_a_hosts_textures() {
    let (device, queue) = device();
    let (textures, mut cells) = host_textures(&device, &queue);
    *cells.lamps_mut() = vec![
        Lamp { position: [5.0, 9.0], ..Lamp::default() },
        Lamp { position: [40.5, 20.5], size: 3.0, ..Lamp::default() },
    ];
    let settings = polar();
    let right = frame(&device, &queue, &mut lighting(&device, &queue), &settings, &cells);

    let mut lighting = lighting(&device, &queue);
    let bad = [Lamp { range: f32::NAN, ..Lamp::default() }];
    let input =
        FrameInput::of_textures(&settings, &textures, Lights { lamps: &bad, ..Lights::default() });
    let error = lighting.prepare(&input).unwrap_err().to_string();
    assert!(error.starts_with("`lamp[0].range`"), "{error}");
    let input = FrameInput::of_textures(
        &settings,
        &textures,
        Lights { lamps: cells.lamps(), ..Lights::default() },
    );
    lighting.prepare(&input).unwrap();
    assert_eq!(recorded(&device, &queue, &lighting), right);
}

#[test]
fn more_lamps_than_the_device_can_hold_are_rejected_and_fewer_lit() {
    let (device, queue) = device();
    let mut settings = polar();
    settings.method.as_polar_mut().unwrap().density = 8.0;
    let mut lighting = lighting(&device, &queue);
    let mut cells = cells(256, 256, 3);
    *cells.lamps_mut() = vec![Lamp { position: [100.0; 2], ..Lamp::default() }; 2000];
    let error = lighting.prepare(&FrameInput::of_cells(&settings, &cells)).unwrap_err();
    assert!(matches!(error, PrepareError::TooLarge { .. }), "{error:?}");
    assert!(error.to_string().contains("bytes for the rays of its lamps"), "{error}");
    assert!(lighting.stage(Stage::Light).is_none());
    cells.lamps_mut().truncate(2);
    frame(&device, &queue, &mut lighting, &settings, &cells);
}
