//! Mistakes of hosts, and changes of their mind.

mod common;
#[path = "common/textures.rs"]
mod textures;

use common::{adapter, cells, device, device_of, frame, lighting, open, raymarch_of, recorded};
use lamplight::settings::Temporal;
use lamplight::{Bounces, Cells, Inflow, Lamp, Matter, Method, Settings, Sight, Sky, Sun};
use lamplight_wgpu::error::PrepareError;
use lamplight_wgpu::{
    Backend, Color, Compose, ComposeParams, FrameInput, Lighting, LightingOptions, Lights, Stage,
    Textures, Tier,
};
use textures::{fetch, filled, texture, view};
use wgpu::{
    Device, Extent3d, Texture, TextureDescriptor, TextureDimension, TextureFormat, TextureUsages,
    TextureView, TextureViewDescriptor, TextureViewDimension,
};

fn raymarch() -> Settings {
    Settings::direct(Method::Raymarch)
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

/// Textures that are all the same view.
fn textures_like(view: &TextureView) -> Textures {
    Textures {
        emission: view.clone(),
        tint_opacity: view.clone(),
        albedo: view.clone(),
        glow: None,
        masks: None,
    }
}

/// Prepares a frame of textures without lamps, under a black sky.
fn prepare(
    lighting: &mut Lighting,
    settings: &Settings,
    view: &TextureView,
    output: Option<&TextureView>,
) -> Result<(), PrepareError> {
    let textures = textures_like(view);
    let input = FrameInput::of_textures(settings, &textures, Lights::default());
    lighting.prepare(&FrameInput { output, ..input })
}

#[test]
fn views_of_a_part_of_a_texture_are_rejected() {
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
    let mut lighting = lighting(&device, &queue);
    let mut compose = Compose::new(&device, &queue).unwrap();
    let settings = raymarch();
    let good = view(&texture(&device, [16, 16], half, BOUND));
    for (part, problem) in
        [(level, "has 3 mip levels, not one"), (layer, "is not one two-dimensional picture")]
    {
        let error = prepare(&mut lighting, &settings, &part, None).unwrap_err().to_string();
        assert_eq!(error, format!("the texture `emission` {problem}"));

        let error = prepare(&mut lighting, &settings, &good, Some(&part)).unwrap_err().to_string();
        assert_eq!(error, format!("the texture `output` {problem}"));
        prepare(&mut lighting, &settings, &good, None).unwrap();
        let params = ComposeParams { color: Color::View(&part), ..ComposeParams::default() };
        let rejected = compose.prepare(&lighting, TextureFormat::Rgba8Unorm, &params);
        assert_eq!(rejected.unwrap_err().to_string(), format!("the texture `color` {problem}"));
    }
}

#[test]
fn errors_of_the_device_are_returned_too() {
    let adapter = adapter();
    let [(device, queue), (other, _)] = [Tier::Web; 2].map(|tier| open(&adapter, tier));
    let half = TextureFormat::Rgba16Float;
    let mut lighting = lighting(&device, &queue);
    let settings = raymarch();
    let stored = TextureUsages::STORAGE_BINDING;
    let good = view(&texture(&device, [16, 16], half, BOUND | stored));
    let foreign = view(&texture(&other, [16, 16], half, BOUND | stored));
    // One layer, seen as an array of one.
    let array = several(&device, 1, 1, half).create_view(&TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2Array),
        ..TextureViewDescriptor::default()
    });
    for bad in [foreign, array] {
        let rejected = prepare(&mut lighting, &settings, &bad, None);
        assert!(matches!(rejected, Err(PrepareError::Device(_))), "{rejected:?}");
        // The frame after is not affected.
        prepare(&mut lighting, &settings, &good, None).unwrap();
        let rejected = prepare(&mut lighting, &settings, &good, Some(&bad));
        assert!(matches!(rejected, Err(PrepareError::Device(_))), "{rejected:?}");
        let mut compose = Compose::new(&device, &queue).unwrap();
        let params = ComposeParams { color: Color::View(&bad), ..ComposeParams::default() };
        let rejected = compose.prepare(&lighting, TextureFormat::Rgba8Unorm, &params);
        assert!(matches!(rejected, Err(PrepareError::Device(_))), "{rejected:?}");
        assert_eq!(recorded(&device, &queue, &lighting).len(), 256);
    }
}

#[test]
fn settings_may_change_between_frames() {
    let (device, queue) = device();
    let cells = cells(61, 37, 4);
    let mut one = lighting(&device, &queue);
    let first = Settings { seed: 1, ..raymarch() };
    frame(&device, &queue, &mut one, &first, &cells);
    let half = TextureFormat::Rgba16Float;
    let output = texture(&device, [61, 37], half, TextureUsages::STORAGE_BINDING);
    let output_view = view(&output);

    let with = |change: fn(&mut Settings)| {
        let mut settings = first.clone();
        change(&mut settings);
        settings
    };
    let changes = [
        with(|s| s.seed = 7),
        with(|s| s.wall_depth = 5.0),
        with(|s| s.bounces = Bounces::Count(2)),
        with(|s| raymarch_of(s).rays = 5),
        with(|s| raymarch_of(s).threshold = 0.5),
        with(|s| s.set_preset("godot").unwrap()),
        with(|_| ()),
    ];
    let mut before = Vec::new();
    for (number, settings) in (1..).zip(changes) {
        let what = format!("{settings:?}");
        let input = FrameInput::of_cells(&settings, &cells);
        one.prepare(&FrameInput { output: Some(&output_view), ..input }).unwrap();
        assert_eq!(one.settings(), Some(&settings));
        let light = recorded(&device, &queue, &one);
        // As with these settings from the start, and as many frames before.
        let mut fresh = lighting(&device, &queue);
        for _ in 0..number {
            fresh.prepare(&input).unwrap();
        }
        assert_eq!(light, frame(&device, &queue, &mut fresh, &settings, &cells), "{what}");
        let written = fetch(&device, &queue, &output);
        assert_ne!(written, before, "{what}");
        before = written;
    }
}

#[test]
fn a_frame_that_is_rejected_changes_nothing() {
    let (device, queue) = device();
    let small = cells(31, 17, 4);
    let mut settings = raymarch();
    raymarch_of(&mut settings).temporal = Temporal { history_length: 8, reject: true };
    let [mut one, mut same] = [(), ()].map(|()| lighting(&device, &queue));
    for lighting in [&mut one, &mut same] {
        frame(&device, &queue, lighting, &settings, &small);
    }
    let right = recorded(&device, &queue, &same);
    let memory = same.cost().unwrap().memory;
    let unchanged = |one: &mut Lighting, rejected: Result<(), PrepareError>| {
        assert!(rejected.is_err());
        assert_eq!(one.settings(), Some(&settings));
        assert_eq!(one.cost().unwrap().memory, memory);
    };
    for bad in [
        Settings { wall_depth: f32::NAN, ..settings.clone() },
        Settings { bounces: Bounces::Count(100_000), ..settings.clone() },
    ] {
        let rejected = one.prepare(&FrameInput::of_cells(&bad, &small));
        unchanged(&mut one, rejected);
    }
    let large = view(&texture(&device, [4096, 4096], TextureFormat::Rgba8Unorm, BOUND));
    let thin = view(&texture(&device, [31, 17], TextureFormat::R8Unorm, BOUND));
    for bad in [large, thin] {
        let rejected = prepare(&mut one, &settings, &bad, None);
        unchanged(&mut one, rejected);
    }
    // An output of another size.
    let input = FrameInput::of_cells(&settings, &small);
    let half = TextureFormat::Rgba16Float;
    let output = view(&texture(&device, [8, 8], half, TextureUsages::STORAGE_BINDING));
    let rejected = one.prepare(&FrameInput { output: Some(&output), ..input });
    unchanged(&mut one, rejected);
    assert_eq!(recorded(&device, &queue, &one), right);
    let next = [&mut one, &mut same].map(|one| frame(&device, &queue, one, &settings, &small));
    assert_eq!(next[0], next[1]);

    // A grid that is just small enough, but not for what bounces need.
    let plain = raymarch();
    let grid = Cells::new(2048, 2048).unwrap();
    one.prepare(&FrameInput::of_cells(&plain, &grid)).unwrap();
    let bounces = Settings { bounces: Bounces::Count(1), ..raymarch() };
    let rejected = one.prepare(&FrameInput::of_cells(&bounces, &grid));
    assert!(matches!(rejected, Err(PrepareError::TooLarge { .. })), "{rejected:?}");
    assert_eq!(one.settings(), Some(&plain));
    frame(&device, &queue, &mut one, &plain, &small);
}

#[test]
fn textures_may_alternate_under_one_output() {
    let (device, queue) = device();
    let half = TextureFormat::Rgba16Float;
    let glow = |byte: u8| filled(&device, &queue, [16, 16], half, &[byte; 8 * 16 * 16]);
    // As half floats 0x3838 is a little over a half, 0x3c3c a little over 1.
    let pair = [glow(0x38), glow(0x3c)];
    let settings = raymarch();
    let sky = Sky::Uniform([1.0; 3]);
    let lit = |lighting: &mut Lighting, matter: &TextureView, output: &Texture| {
        let textures = textures_like(matter);
        let input = FrameInput::of_textures(
            &settings,
            &textures,
            Lights { sky: &sky, ..Lights::default() },
        );
        lighting.prepare(&FrameInput { output: Some(&view(output)), ..input }).unwrap();
        recorded(&device, &queue, lighting);
        fetch(&device, &queue, output)
    };
    let output = || texture(&device, [16, 16], half, TextureUsages::STORAGE_BINDING);
    let [mut one, mut fresh] = [(), ()].map(|()| lighting(&device, &queue));
    let shared = output();
    let mut seen = Vec::new();
    for number in 0..4 {
        let matter = &pair[number % 2];
        seen.push(lit(&mut one, matter, &shared));
        assert_eq!(seen[number], lit(&mut fresh, matter, &output()), "frame {number}");
    }
    assert_ne!(seen[0], seen[1]);
    // A frame without an output leaves it as it is.
    frame(&device, &queue, &mut one, &settings, &Cells::new(8, 8).unwrap());
    assert_eq!(fetch(&device, &queue, &shared), seen[3]);
}

/// Cells without lamps are an error under `polar`, as on the CPU.
#[test]
fn methods_may_change_to_those_that_light_lamps_and_back() {
    let (device, queue) = device();
    let mut cells = cells(31, 17, 4);
    let mut lighting = lighting(&device, &queue);
    let seen = frame(&device, &queue, &mut lighting, &raymarch(), &cells);
    for method in [Method::Polar, Method::Flood] {
        let settings = Settings::direct(method);
        let prepared = lighting.prepare(&FrameInput::of_cells(&settings, &cells));
        assert_eq!(prepared.is_err(), method == Method::Polar, "{prepared:?}");
        cells.lamps_mut().push(Lamp { position: [15.0, 8.0], ..Lamp::default() });
        let light = frame(&device, &queue, &mut lighting, &settings, &cells);
        assert_ne!(light, seen);
        cells.lamps_mut().clear();
        lighting.reset();
        assert_eq!(frame(&device, &queue, &mut lighting, &raymarch(), &cells), seen);
    }
}

#[test]
fn textures_without_lamps_are_dark_under_polar() {
    let (device, queue) = device();
    let open = [255, 255, 255, 0].repeat(16 * 16);
    let matter = filled(&device, &queue, [16, 16], TextureFormat::Rgba8Unorm, &open);
    let matter = textures_like(&matter);
    let settings = Settings::direct(Method::Polar);
    let mut lighting = lighting(&device, &queue);
    let mut light = |lamps: &[Lamp]| {
        let input =
            FrameInput::of_textures(&settings, &matter, Lights { lamps, ..Lights::default() });
        lighting.prepare(&input).unwrap();
        let light = recorded(&device, &queue, &lighting);
        light.iter().map(|[r, g, b, _]| r + g + b).sum::<f32>()
    };
    let lamp = Lamp { position: [8.0, 8.0], ..Lamp::default() };
    assert_eq!([light(&[]), light(&[lamp]).min(1.0), light(&[])], [0.0, 1.0, 0.0]);
}

#[test]
fn precompiled_settings_compile_no_pipelines_when_they_are_used() {
    // Not the device of the other tests, which compile too.
    let (device, queue) = device_of(Tier::Web);
    let cells = cells(31, 17, 4);
    let pipelines = || device.get_internal_counters().hal.compute_pipelines.read();
    let other = Settings { bounces: Bounces::Count(1), ..raymarch() };
    let mut lighting = lighting(&device, &queue);
    let first = frame(&device, &queue, &mut lighting, &raymarch(), &cells);
    let alone = pipelines();
    lighting.precompile(&other).unwrap();
    let both = pipelines();
    assert!(both > alone, "{both} pipelines, {alone} before: the counter does not count");
    assert_eq!(lighting.settings(), Some(&raymarch()));
    for settings in [other, raymarch()] {
        lighting.reset();
        let light = frame(&device, &queue, &mut lighting, &settings, &cells);
        assert_eq!(light == first, settings == raymarch());
        assert_eq!(pipelines(), both, "{settings:?}");
    }
    // However long a slider is dragged, not all of the settings that it passes stay compiled.
    for rays in 1..40 {
        let mut dragged = raymarch();
        raymarch_of(&mut dragged).rays = rays;
        lighting.precompile(&dragged).unwrap();
    }
    let most = 20 * both;
    assert!(pipelines() < most, "{} pipelines are kept", pipelines());
    let invalid = Settings { wall_depth: f32::NAN, ..raymarch() };
    assert!(lighting.precompile(&invalid).is_err());
}

#[test]
fn changes_compiled_ahead_compile_nothing_when_they_come() {
    let (device, queue) = device();
    let plain = Cells::new(31, 17).unwrap();
    let changed = |change: &dyn Fn(&mut Cells)| {
        let mut cells = plain.clone();
        change(&mut cells);
        cells
    };
    let glass = changed(&|cells| {
        cells.set(3, 3, Matter { tint: [0.2, 0.5, 0.9], ..Matter::EMPTY });
    });
    let sun = changed(&|cells| cells.suns_mut().push(Sun::default()));
    let entering = changed(&|cells| {
        let inflow = Inflow::new([31, 17], 16, |_, _| [1.0; 3]).unwrap();
        cells.set_inflow(Some(inflow)).unwrap();
    });
    for method in [Method::Holographic, Method::Raymarch] {
        let direct = Settings::direct(method);
        let bounces = [Bounces::Count(2), Bounces::Converged, Bounces::Feedback];
        let bounces = bounces.map(|bounces| Settings { bounces, ..direct.clone() });
        let moment = Settings { moment: true, ..direct.clone() };
        let bounced = bounces.iter().map(|settings| (settings, &plain));
        let scenes = [&glass, &sun, &entering].map(|cells| (&direct, cells));
        let frames = [(&direct, &plain)].into_iter().chain(scenes).chain(bounced);
        for (settings, cells) in frames.chain([(&moment, &plain), (&bounces[0], &entering)]) {
            // Each change is the first after a frame without any.
            let options =
                LightingOptions { compile_ahead: Some(true), ..LightingOptions::on(Backend::Gpu) };
            let mut lighting = Lighting::new(&device, &queue, &options).unwrap();
            lighting.prepare(&FrameInput::of_cells(&direct, &plain)).unwrap();
            assert!(lighting.compiled() > 0, "the first frame compiles nothing: it is not counted");
            lighting.wait_for_pipelines();
            let input = FrameInput {
                sights: &[Sight::default()],
                distance_field: true,
                ..FrameInput::of_cells(settings, cells)
            };
            lighting.prepare(&input).unwrap();
            assert_eq!(lighting.compiled(), 0, "{settings:?}");
        }
    }
}

#[test]
fn the_light_is_none_before_the_first_frame() {
    let (device, queue) = device();
    let lighting = lighting(&device, &queue);
    let cells = Cells::new(4, 4).unwrap();
    let error = lamplight_wgpu::read_back::light(&lighting, &cells).unwrap_err().to_string();
    assert_eq!(error, "cannot read from the GPU: nothing has been lit");
    assert!(lighting.stage(Stage::Light).is_none());
}

#[test]
fn the_light_of_cells_that_were_not_lit_is_refused() {
    let (device, queue) = device();
    let mut lighting = lighting(&device, &queue);
    let lit = Cells::new(6, 4).unwrap();
    frame(&device, &queue, &mut lighting, &Settings::default(), &lit);
    // As many cells, or not.
    for [width, height] in [[4, 6], [6, 5]] {
        let cells = Cells::new(width, height).unwrap();
        let error = lamplight_wgpu::read_back::light(&lighting, &cells).unwrap_err().to_string();
        let asked = format!("the light of {width}×{height} is asked for");
        assert_eq!(error, format!("cannot read from the GPU: 6×4 cells were lit, but {asked}"));
    }
    assert!(lamplight_wgpu::read_back::light(&lighting, &lit).is_ok());
}
