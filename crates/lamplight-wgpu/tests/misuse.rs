//! What hosts get wrong, or change their mind about.

mod common;
#[path = "common/textures.rs"]
mod textures;

use common::{adapter, cells, device, frame, open};
use lamplight::settings::Temporal;
use lamplight::{Bounces, Cells, Lamp, Method, Settings, Sky};
use lamplight_wgpu::read_back::read_back;
use lamplight_wgpu::{Color, Compose, Error, Lighting, Shown, Stage, Textures, Tier};
use textures::{fetch, filled, texture, view};
use wgpu::{
    Device, Extent3d, Texture, TextureDescriptor, TextureDimension, TextureFormat, TextureUsages,
    TextureView, TextureViewDescriptor, TextureViewDimension,
};

fn raymarch() -> Settings {
    Settings { method: Method::Raymarch, ..Settings::default() }
}

const BOUND: TextureUsages = TextureUsages::TEXTURE_BINDING;

/// A texture of several layers or mip levels.
fn several(device: &Device, layers: u32, levels: u32, format: TextureFormat) -> Texture {
    device.create_texture(&TextureDescriptor {
        label: None,
        size: Extent3d { width: 16, height: 16, depth_or_array_layers: layers },
        mip_level_count: levels,
        sample_count: 1,
        dimension: TextureDimension::D2,
        format,
        usage: BOUND | TextureUsages::STORAGE_BINDING,
        view_formats: &[],
    })
}

/// One size and format for all.
fn textures_like(view: &TextureView) -> Textures {
    Textures { emission: view.clone(), tint_opacity: view.clone(), albedo: view.clone() }
}

#[test]
fn views_of_a_part_of_a_texture_are_refused() {
    let (device, queue) = device();
    let half = TextureFormat::Rgba16Float;
    let one_level = TextureViewDescriptor {
        base_mip_level: 1,
        mip_level_count: Some(1),
        ..TextureViewDescriptor::default()
    };
    let one_layer = TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2),
        base_array_layer: 2,
        array_layer_count: Some(1),
        ..TextureViewDescriptor::default()
    };
    let level = several(&device, 1, 3, half).create_view(&one_level);
    let layer = several(&device, 4, 1, half).create_view(&one_layer);
    let mut lighting = Lighting::new(&device, &queue, raymarch()).unwrap();
    let mut compose = Compose::new(&device).unwrap();
    let good = view(&texture(&device, [16, 16], half, BOUND));
    for (part, problem) in
        [(level, "has 3 mip levels, not one"), (layer, "is not one two-dimensional picture")]
    {
        let told = lighting.prepare_textures(&device, &queue, &textures_like(&part), Sky::BLACK);
        let error = told.unwrap_err().to_string();
        assert_eq!(error, format!("the texture `emission` {problem}"));

        lighting.prepare_textures(&device, &queue, &textures_like(&good), Sky::BLACK).unwrap();
        let error = lighting.write_to(&device, &part).unwrap_err().to_string();
        assert_eq!(error, format!("the texture `output` {problem}"));
        let shown = Shown { color: Color::View(&part), ..Shown::default() };
        let format = TextureFormat::Rgba8Unorm;
        let told = compose.prepare(&device, &queue, &lighting, format, &shown);
        assert_eq!(told.unwrap_err().to_string(), format!("the texture `color` {problem}"));
    }
}

#[test]
fn what_only_the_device_knows_is_an_error_too() {
    let adapter = adapter();
    let [(device, queue), (other, _)] = [Tier::Web; 2].map(|tier| open(&adapter, tier));
    let half = TextureFormat::Rgba16Float;
    let mut lighting = Lighting::new(&device, &queue, raymarch()).unwrap();
    let good = view(&texture(&device, [16, 16], half, BOUND | TextureUsages::STORAGE_BINDING));
    let foreign = view(&texture(&other, [16, 16], half, BOUND | TextureUsages::STORAGE_BINDING));
    // One layer, seen as an array of one.
    let array = several(&device, 1, 1, half).create_view(&TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2Array),
        ..TextureViewDescriptor::default()
    });
    for bad in [foreign, array] {
        let told = lighting.prepare_textures(&device, &queue, &textures_like(&bad), Sky::BLACK);
        assert!(matches!(told, Err(Error::Device(_))), "{told:?}");
        // The frame after is none the worse for it.
        lighting.prepare_textures(&device, &queue, &textures_like(&good), Sky::BLACK).unwrap();
        let told = lighting.write_to(&device, &bad);
        assert!(matches!(told, Err(Error::Device(_))), "{told:?}");
        let mut compose = Compose::new(&device).unwrap();
        let shown = Shown { color: Color::View(&bad), ..Shown::default() };
        let format = TextureFormat::Rgba8Unorm;
        let told = compose.prepare(&device, &queue, &lighting, format, &shown);
        assert!(matches!(told, Err(Error::Device(_))), "{told:?}");
        let mut encoder = device.create_command_encoder(&Default::default());
        lighting.record(&mut encoder);
        queue.submit([encoder.finish()]);
        let light = lighting.stage(Stage::Light).unwrap();
        assert_eq!(read_back::<[f32; 4]>(&device, &queue, light).unwrap().len(), 256);
    }
}

#[test]
fn settings_may_change_between_frames() {
    let (device, queue) = device();
    let cells = cells(61, 37, 4);
    let mut lighting = Lighting::new(&device, &queue, raymarch()).unwrap();
    // Before the first frame too.
    lighting.set_settings(&device, &queue, Settings { seed: 1, ..raymarch() }).unwrap();
    frame(&device, &queue, &mut lighting, &cells);
    let half = TextureFormat::Rgba16Float;
    let output = texture(&device, [61, 37], half, TextureUsages::STORAGE_BINDING);
    lighting.write_to(&device, &view(&output)).unwrap();

    let with = |change: fn(&mut Settings)| {
        let mut settings = Settings { seed: 1, ..raymarch() };
        change(&mut settings);
        settings
    };
    let changes = [
        with(|s| s.seed = 7),
        with(|s| s.wall_depth = 5.0),
        with(|s| s.bounces = Bounces::Count(2)),
        with(|s| s.raymarch.rays = 5),
        with(|s| s.raymarch.threshold = 0.5),
        with(|s| s.raymarch = lamplight::settings::Raymarch::preset("godot").unwrap()),
        with(|_| ()),
    ];
    let mut before = Vec::new();
    for (number, settings) in (1..).zip(changes) {
        let what = format!("{settings:?}");
        lighting.set_settings(&device, &queue, settings.clone()).unwrap();
        assert_eq!(lighting.settings(), &settings);
        let light = frame(&device, &queue, &mut lighting, &cells);
        // As if it had been so from the start, with as many frames before.
        let mut fresh = Lighting::new(&device, &queue, settings).unwrap();
        for _ in 0..number {
            fresh.prepare(&device, &queue, &cells).unwrap();
        }
        assert_eq!(light, frame(&device, &queue, &mut fresh, &cells), "{what}");
        // The texture to write to goes on.
        let written = fetch(&device, &queue, &output);
        assert_ne!(written, before, "{what}");
        before = written;
    }
}

#[test]
fn settings_that_are_refused_change_nothing() {
    let (device, queue) = device();
    let cells = cells(31, 17, 4);
    let mut lighting = Lighting::new(&device, &queue, raymarch()).unwrap();
    let mut same = Lighting::new(&device, &queue, raymarch()).unwrap();
    for refused in [
        Settings { wall_depth: f32::NAN, ..raymarch() },
        Settings { bounces: Bounces::Count(100_000), ..raymarch() },
    ] {
        let right = frame(&device, &queue, &mut same, &cells);
        let memory = same.cost().unwrap().memory;
        assert!(lighting.set_settings(&device, &queue, refused).is_err());
        assert_eq!(lighting.settings(), &raymarch());
        assert_eq!(frame(&device, &queue, &mut lighting, &cells), right);
        assert_eq!(lighting.cost().unwrap().memory, memory);
    }

    // A grid that is just small enough, but not for what bounces need.
    let (width, height) = (2048, 2048);
    lighting.prepare(&device, &queue, &Cells::new(width, height).unwrap()).unwrap();
    let told = lighting.set_settings(
        &device,
        &queue,
        Settings { bounces: Bounces::Count(1), ..raymarch() },
    );
    assert!(matches!(told, Err(Error::TooLarge { .. })), "{told:?}");
    assert_eq!(lighting.settings(), &raymarch());
    lighting.prepare(&device, &queue, &cells).unwrap();
    let mut encoder = device.create_command_encoder(&Default::default());
    lighting.record(&mut encoder);
    queue.submit([encoder.finish()]);
}

#[test]
fn textures_may_alternate_and_the_output_goes_on() {
    let (device, queue) = device();
    let half = TextureFormat::Rgba16Float;
    let glow = |byte: u8| {
        let texels = [byte; 8 * 16 * 16];
        textures_like(&filled(&device, &queue, [16, 16], half, &texels))
    };
    // As half floats 0x3838 is a little over a half, 0x3c3c a little over 1.
    let pair = [glow(0x38), glow(0x3c)];
    let lit = |lighting: &mut Lighting, textures: &Textures| {
        lighting.prepare_textures(&device, &queue, textures, Sky::Uniform([1.0; 3])).unwrap();
    };
    let written = |lighting: &Lighting, output: &Texture| {
        let mut encoder = device.create_command_encoder(&Default::default());
        lighting.record(&mut encoder);
        queue.submit([encoder.finish()]);
        fetch(&device, &queue, output)
    };
    let output = || texture(&device, [16, 16], half, TextureUsages::STORAGE_BINDING);
    let mut lighting = Lighting::new(&device, &queue, raymarch()).unwrap();
    let mut fresh = Lighting::new(&device, &queue, raymarch()).unwrap();
    let shared = output();
    let mut seen = Vec::new();
    for number in 0..4 {
        let textures = &pair[number % 2];
        lit(&mut lighting, textures);
        lit(&mut fresh, textures);
        if number == 0 {
            lighting.write_to(&device, &view(&shared)).unwrap();
        }
        let own = output();
        fresh.write_to(&device, &view(&own)).unwrap();
        seen.push(written(&lighting, &shared));
        assert_eq!(seen[number], written(&fresh, &own), "frame {number}");
    }
    assert_ne!(seen[0], seen[1]);
    // Another size ends it, and is no error.
    lighting.prepare(&device, &queue, &Cells::new(8, 8).unwrap()).unwrap();
    assert_eq!(written(&lighting, &shared), seen[3]);
}

/// Lamps are missed by the frame, not by the settings.
#[test]
fn settings_may_come_before_the_lamps_that_they_light() {
    let (device, queue) = device();
    let mut cells = cells(31, 17, 4);
    let mut lighting = Lighting::new(&device, &queue, raymarch()).unwrap();
    let seen = frame(&device, &queue, &mut lighting, &cells);
    for method in [Method::Polar, Method::Flood] {
        let settings = Settings { method, ..Settings::default() };
        lighting.set_settings(&device, &queue, settings.clone()).unwrap();
        let told = lighting.prepare(&device, &queue, &cells);
        assert_eq!(told.is_err(), method == Method::Polar, "{told:?}");
        cells.lamps_mut().push(Lamp { position: [15.0, 8.0], ..Lamp::default() });
        let light = frame(&device, &queue, &mut lighting, &cells);
        assert_ne!(light, seen);
        cells.lamps_mut().clear();
        lighting.set_settings(&device, &queue, raymarch()).unwrap();
        lighting.reset();
        assert_eq!(frame(&device, &queue, &mut lighting, &cells), seen);
    }
}

/// A frame that was prepared is recorded as it was, whatever comes after.
#[test]
fn settings_come_with_the_next_frame_that_is_prepared() {
    let (device, queue) = device();
    let cells = cells(31, 17, 4);
    let record = |lighting: &Lighting| {
        let mut encoder = device.create_command_encoder(&Default::default());
        lighting.record(&mut encoder);
        queue.submit([encoder.finish()]);
        let light = lighting.stage(Stage::Light).unwrap();
        read_back::<[f32; 4]>(&device, &queue, light).unwrap()
    };
    let start = || {
        let mut settings = raymarch();
        settings.temporal = Temporal { frames: 8, reject: false };
        let mut lighting = Lighting::new(&device, &queue, settings).unwrap();
        frame(&device, &queue, &mut lighting, &cells);
        // History has to move along.
        lighting.set_origin([3, 0]);
        lighting.prepare(&device, &queue, &cells).unwrap();
        lighting
    };
    let right = record(&start());
    for change in [
        |s: &mut Settings| s.wall_depth = 9.0,
        |s: &mut Settings| s.raymarch.rays = 3,
        |s: &mut Settings| s.method = Method::Holographic,
    ] {
        let mut lighting = start();
        let mut other = lighting.settings().clone();
        change(&mut other);
        lighting.set_settings(&device, &queue, other).unwrap();
        assert_eq!(record(&lighting), right);
        assert_ne!(frame(&device, &queue, &mut lighting, &cells), right);
    }
}

#[test]
fn frames_that_are_refused_leave_what_was_there() {
    let (device, queue) = device();
    let cells = cells(31, 17, 4);
    let mut settings = raymarch();
    settings.temporal = Temporal { frames: 8, reject: true };
    let [mut lighting, mut same] =
        [0, 1].map(|_| Lighting::new(&device, &queue, settings.clone()).unwrap());
    for lighting in [&mut lighting, &mut same] {
        frame(&device, &queue, lighting, &cells);
    }
    let usage = TextureUsages::TEXTURE_BINDING;
    let large =
        textures_like(&view(&texture(&device, [4096, 4096], TextureFormat::Rgba8Unorm, usage)));
    let thin = textures_like(&view(&texture(&device, [31, 17], TextureFormat::R8Unorm, usage)));
    for refused in [large, thin] {
        let told = lighting.prepare_textures(&device, &queue, &refused, Sky::default());
        assert!(told.is_err());
        assert!(lighting.stage(Stage::Light).is_some());
    }
    let next = [&mut lighting, &mut same].map(|one| frame(&device, &queue, one, &cells));
    assert_eq!(next[0], next[1]);
}

/// Who puts the last lamp out sits in the dark.
#[test]
fn textures_without_lamps_are_dark_under_polar() {
    let (device, queue) = device();
    let open = [255, 255, 255, 0].repeat(16 * 16);
    let matter = filled(&device, &queue, [16, 16], TextureFormat::Rgba8Unorm, &open);
    let matter = textures_like(&matter);
    let settings = Settings { method: Method::Polar, ..Settings::default() };
    let mut lighting = Lighting::new(&device, &queue, settings).unwrap();
    let mut light = |lamps: &[Lamp]| {
        lighting.set_lamps(lamps).unwrap();
        lighting.prepare_textures(&device, &queue, &matter, Sky::default()).unwrap();
        let mut encoder = device.create_command_encoder(&Default::default());
        lighting.record(&mut encoder);
        queue.submit([encoder.finish()]);
        let light = lighting.stage(Stage::Light).unwrap();
        let light: Vec<[f32; 4]> = read_back(&device, &queue, light).unwrap();
        light.iter().map(|[r, g, b, _]| r + g + b).sum::<f32>()
    };
    let lamp = Lamp { position: [8.0, 8.0], ..Lamp::default() };
    assert_eq!([light(&[]), light(&[lamp]).min(1.0), light(&[])], [0.0, 1.0, 0.0]);
}

#[test]
fn settings_that_were_announced_build_no_pipelines_when_they_come() {
    let (device, queue) = device();
    let cells = cells(31, 17, 4);
    let pipelines = || device.get_internal_counters().hal.compute_pipelines.read();
    let other = Settings { bounces: Bounces::Count(1), ..raymarch() };
    let mut lighting = Lighting::new(&device, &queue, raymarch()).unwrap();
    let first = frame(&device, &queue, &mut lighting, &cells);
    let alone = pipelines();
    lighting.precompile(&device, &queue, &other).unwrap();
    let both = pipelines();
    assert!(both > alone, "{both} pipelines, {alone} before: nobody counts");
    assert_eq!(lighting.settings(), &raymarch());
    for settings in [other, raymarch()] {
        lighting.set_settings(&device, &queue, settings.clone()).unwrap();
        lighting.reset();
        let light = frame(&device, &queue, &mut lighting, &cells);
        assert_eq!(light == first, settings == raymarch());
        assert_eq!(pipelines(), both, "{settings:?}");
    }
    // However long a slider is drawn, not all of what it passed is kept.
    for rays in 1..40 {
        let mut drawn = raymarch();
        drawn.raymarch.rays = rays;
        lighting.set_settings(&device, &queue, drawn).unwrap();
    }
    let most = 20 * both;
    assert!(pipelines() < most, "{} pipelines are kept", pipelines());
    let refused = Settings { wall_depth: f32::NAN, ..raymarch() };
    assert!(lighting.precompile(&device, &queue, &refused).is_err());
}
