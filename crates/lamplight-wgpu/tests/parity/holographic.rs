//! `holographic`, every preset.

use crate::common::{cells, device, device_of, device_with, frame, lighting, on_gpu};
use crate::compare::{Both, SIZES, agree, differences, middle, scenes};
use crate::inflow::entered;
use lamplight::settings::{Holographic, Variant};
use lamplight::{Bounces, Cells, Gradient, Lamp, Matter, Rgb, Settings, Sky};
use lamplight_wgpu::{FrameInput, Lighting, LightingOptions, Tier};
use std::time::{Duration, Instant};

fn holographic(preset: &str) -> Settings {
    Settings::direct(Holographic::preset(preset).unwrap())
}

/// Solid matter alone, some of it glowing: no fog, no tint.
fn solid(width: u32, height: u32, seed: u64) -> Cells {
    let mut cells = cells(width, height, seed);
    for i in 0..cells.len() {
        let matter = cells.matter(i);
        if matter.opacity < 1.0 {
            cells.set_matter(i, Matter::EMPTY);
        }
    }
    cells
}

#[test]
fn direct_light_agrees_at_every_size() {
    let gpu = device();
    for [w, h] in SIZES {
        for preset in ["default", "fast", "coarse"] {
            // The largest size costs a software GPU seconds.
            if w * h > 1 << 15 && preset != "default" {
                continue;
            }
            let name = format!("{preset} at {w}×{h}");
            agree(&gpu, &format!("{name}, walls"), &solid(w, h, 3), holographic(preset));
            agree(&gpu, &name, &cells(w, h, 3), holographic(preset));
        }
    }
}

#[test]
fn every_preset_agrees_with_bounces_and_under_any_sky() {
    let gpu = device();
    let [zenith, horizon, ground] = [[0.1, 0.4, 2.0], [1.0, 0.8, 0.2], [0.05, 0.0, 0.0]];
    let gradient = Sky::Gradient(Gradient { zenith, horizon, ground });
    for preset in ["default", "fast", "coarse", "high"] {
        for (bounces, [w, h], sky) in [
            (0, [45, 70], gradient.clone()),
            (1, [61, 43], Sky::Uniform([0.2; 3])),
            (3, [40, 77], Sky::Uniform([0.0; 3])),
        ] {
            let mut settings = holographic(preset);
            settings.bounces = Bounces::Count(bounces);
            settings.wall_depth = 2.5;
            let name = format!("{preset}, {bounces} bounces");
            for mut cells in [cells(w, h, 17), solid(w, h, 19)] {
                cells.set_sky(sky.clone());
                agree(&gpu, &name, &cells, settings.clone());
            }
        }
    }
}

#[test]
fn every_setting_agrees() {
    let gpu = device();
    let cells = cells(53, 37, 23);
    for (gather_level, gather_length, gather_rays, bundle_rays) in
        [(1, 15, 1, 1), (2, 1, 3, 16), (3, 5, 16, 3), (4, 15, 2, 8)]
    {
        for lattice_spacing in [1, 2, 4] {
            let settings = Holographic {
                variant: Variant::Bundles,
                lattice_spacing,
                gather_level,
                gather_length,
                gather_rays,
                bundle_rays,
            };
            agree(&gpu, &format!("{settings:?}"), &cells, Settings::direct(settings));
        }
    }
}

#[test]
fn every_example_scene_agrees() {
    let gpu = device();
    for (name, scene) in scenes() {
        let Settings { wall_depth, .. } = scene.resolve_settings().unwrap();
        let settings =
            Settings { bounces: Bounces::Count(1), wall_depth, ..holographic("default") };
        agree(&gpu, &name, &middle(&scene), settings);
    }
}

/// Surfaces and a sky as bright as can be, and a lamp of the brightest colour and intensity.
#[test]
fn the_brightest_light_agrees() {
    let gpu = device();
    let lamp = Lamp {
        position: [31.2, 20.7],
        color: [1e12, 3e11, 1e11],
        intensity: 1e6,
        size: 2.5,
        ..Lamp::default()
    };
    for preset in ["default", "fast"] {
        let settings = Settings { bounces: Bounces::Count(1), ..holographic(preset) };
        for dim in [cells(61, 43, 17), solid(61, 43, 19)] {
            let most = dim.emission().as_flattened().iter().copied().fold(0.0, f32::max);
            for brightest in [1e7, 1e9, 1e12] {
                let mut bright = dim.clone();
                for value in bright.emission_mut().as_flattened_mut() {
                    *value = *value / most * brightest;
                }
                bright.set_sky(Sky::Uniform([0.02 * brightest; 3]));
                agree(&gpu, &format!("{preset}, {brightest:e}"), &bright, settings.clone());
            }
            let mut lit = dim.clone();
            lit.lamps_mut().push(lamp.clone());
            agree(&gpu, &format!("{preset}, lamp"), &lit, settings.clone());
        }
    }
}

/// The light, and the dispatches, of a device with a limit on bound bytes and a number of levels per dispatch.
fn lit(
    cells: &Cells,
    preset: &str,
    most_bytes: Option<u64>,
    fused_levels: u32,
) -> (Vec<Rgb>, usize) {
    let (device, queue) = device_with(|limits| {
        if let Some(most) = most_bytes {
            limits.max_storage_buffer_binding_size = most;
        }
    });
    let options = LightingOptions { fused_levels: Some(fused_levels), ..on_gpu() };
    let mut lighting = Lighting::new(&device, &queue, &options).unwrap();
    let light = frame(&device, &queue, &mut lighting, &holographic(preset), cells);
    let cost = lighting.cost().unwrap();
    println!("{preset}, {most_bytes:?}: {} dispatches, {} bytes", cost.dispatches(), cost.memory);
    (light.into_iter().map(|[r, g, b, _]| [r, g, b]).collect(), cost.dispatches())
}

/// The largest relative difference, and whether there are more dispatches than in the right case.
fn changes(name: &str, seen: &(Vec<Rgb>, usize), right: &(Vec<Rgb>, usize)) -> (f64, bool) {
    let worst = differences(&seen.0, &right.0).into_iter().fold(0.0, f64::max);
    println!("{name}: {worst:.1e}");
    (worst, seen.1 > right.1)
}

/// The relative difference that rounding makes of the same sums. Chunks make none.
const SAME: f64 = 1e-5;
/// That of light which is stored, and rounded to 14 bits, or is not. Measured at up to 5.6e-5.
const STORED: f64 = 2e-4;

#[test]
fn neither_fused_levels_nor_chunks_change_the_light() {
    let with_inflow = entered(cells(90, 131, 29), 32, 3);
    for (preset, cells) in
        [("default", cells(90, 131, 29)), ("fast", solid(131, 90, 31)), ("fast", with_inflow)]
    {
        let [alone, fused] = [1, 2].map(|levels| lit(&cells, preset, None, levels));
        let (worst, is_longer) = changes("alone", &alone, &fused);
        assert!(worst <= STORED && is_longer, "{preset}, fused: {worst:e}");
        // The buffers of `fast` are smaller than those of matter, which are bound in one piece.
        if preset == "default" {
            let in_chunks = [1, 2].map(|levels| lit(&cells, preset, Some(500_000), levels));
            for (seen, right) in in_chunks.iter().zip([&alone, &fused]) {
                let (worst, is_longer) = changes("in chunks", seen, right);
                assert!(worst <= SAME && is_longer, "{preset}, in chunks: {worst:e}");
            }
        }
    }
}

#[test]
fn a_grid_that_does_not_fit_is_refused() {
    let (device, queue) = device_with(|limits| limits.max_storage_buffer_binding_size = 1 << 19);
    for preset in ["default", "paper"] {
        let mut lighting = lighting(&device, &queue);
        let settings = holographic(preset);
        let large = cells(400, 300, 1);
        let refused = lighting.prepare(&FrameInput::of_cells(&settings, &large));
        let error = refused.unwrap_err().to_string();
        assert!(error.contains("bytes a buffer, but this device allows"), "{error}");
        let small = cells(40, 30, 1);
        assert_eq!(frame(&device, &queue, &mut lighting, &settings, &small).len(), 1200);
    }
}

#[test]
fn the_published_cascades_agree_at_every_size() {
    let gpu = device();
    // The largest size costs a software GPU seconds.
    for [w, h] in SIZES.into_iter().filter(|[w, h]| w * h <= 1 << 15) {
        agree(&gpu, &format!("paper at {w}×{h}, walls"), &solid(w, h, 5), holographic("paper"));
        agree(&gpu, &format!("paper at {w}×{h}"), &cells(w, h, 5), holographic("paper"));
    }
}

#[test]
fn the_published_cascades_agree_with_bounces_and_under_any_sky() {
    let gpu = device();
    let [zenith, horizon, ground] = [[0.1, 0.4, 2.0], [1.0, 0.8, 0.2], [0.05, 0.0, 0.0]];
    let gradient = Sky::Gradient(Gradient { zenith, horizon, ground });
    for (bounces, [w, h], sky) in [
        (0, [45, 70], gradient.clone()),
        (2, [61, 43], gradient),
        (2, [40, 77], Sky::Uniform([0.0; 3])),
    ] {
        let mut settings = holographic("paper");
        settings.bounces = Bounces::Count(bounces);
        settings.wall_depth = 2.5;
        let mut both = Both::new(&gpu, settings);
        // With tint, and without: each has its own intervals.
        for (what, mut cells) in [("all", cells(w, h, 17)), ("walls", solid(w, h, 19))] {
            cells.set_sky(sky.clone());
            let name = format!("paper, {bounces} bounces, {w}×{h}, {what}");
            both.agree(&gpu, &name, &cells);
            // The sky of another frame.
            cells.set_sky(Sky::Uniform([0.3, 0.2, 0.1]));
            both.agree(&gpu, &format!("{name}, another sky"), &cells);
        }
    }
}

#[test]
fn the_published_cascades_agree_in_example_scenes() {
    let gpu = device();
    for (name, scene) in scenes() {
        if ["fog", "stained_glass", "two_rooms"].contains(&name.as_str()) {
            let Settings { wall_depth, .. } = scene.resolve_settings().unwrap();
            let settings =
                Settings { bounces: Bounces::Count(1), wall_depth, ..holographic("paper") };
            agree(&gpu, &format!("paper, {name}"), &middle(&scene), settings);
        }
    }
}

/// The work is the same with more workgroup memory.
#[test]
fn tiers_agree_to_the_bit() {
    for (name, cells) in [("walls", solid(211, 127, 5)), ("tint", cells(211, 127, 5))] {
        let mut tiers = [Tier::Web, Tier::Native].map(|tier| {
            let (device, queue) = device_of(tier);
            let memory = device.limits().max_compute_workgroup_storage_size;
            let lighting = lighting(&device, &queue);
            (device, queue, lighting, memory, Duration::MAX)
        });
        let mut lights = [Vec::new(), Vec::new()];
        for _ in 0..3 {
            for ((device, queue, lighting, _, least), light) in tiers.iter_mut().zip(&mut lights) {
                let start = Instant::now();
                *light = frame(device, queue, lighting, &holographic("default"), &cells);
                *least = start.elapsed().min(*least);
            }
        }
        let [web, native] = tiers.map(|(.., memory, least)| (memory, least.as_secs_f64() * 1e3));
        println!(
            "{name}: {} bytes {:.0} ms, {} bytes {:.0} ms: ratio {:.2}",
            web.0,
            web.1,
            native.0,
            native.1,
            native.1 / web.1
        );
        assert!(native.0 > web.0, "the adapter has no more than the web grants");
        assert_eq!(lights[0], lights[1], "{name}");
    }
}
