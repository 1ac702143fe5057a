//! The GPU held to the CPU, stage by stage and frame by frame.

mod common;

use common::{cells, device, frame};
use lamplight::settings::{BounceBy, Hit, Noise, Raymarch, Spacing};
use lamplight::stages::clearance::{Ground, clearance};
use lamplight::stages::distance::distance;
use lamplight::stages::jump_flood::{jump_flood, settle};
use lamplight::stages::seed::{is_occupied, seed};
use lamplight::stages::transmittance::log_transmittance;
use lamplight::{Bounces, Cells, Gradient, Method, Rgb, Scene, Settings, Sky, Solver};
use lamplight_wgpu::read_back::read_back;
use lamplight_wgpu::{Lighting, Stage};
use wgpu::{Device, Queue};

/// One cell, lines, primes, a power of two, not square, larger than a word of columns.
const SIZES: [[u32; 2]; 8] =
    [[1, 1], [1, 37], [41, 1], [31, 17], [64, 64], [97, 61], [127, 131], [512, 288]];

fn raymarch() -> Settings {
    Settings { method: Method::Raymarch, ..Settings::default() }
}

/// The GPU's stages for some cells.
fn stage<T: bytemuck::Pod>(
    (device, queue): &(Device, Queue),
    cells: &Cells,
    settings: Settings,
    stage: Stage,
) -> Vec<T> {
    let mut lighting = Lighting::new(device, queue, settings).unwrap();
    lighting.prepare(device, queue, cells).unwrap();
    let mut encoder = device.create_command_encoder(&Default::default());
    lighting.record_fields(&mut encoder);
    lighting.record(&mut encoder);
    queue.submit([encoder.finish()]);
    read_back(device, queue, lighting.stage(stage).unwrap()).unwrap()
}

#[test]
fn seeds_jump_flood_and_distance_agree() {
    let gpu = device();
    for [w, h] in SIZES {
        let cells = cells(w, h, 7);
        let (mut seeds, mut scratch, mut away) = Default::default();
        seed(&cells, 0.0, &mut seeds);
        let mut nearest = seeds.clone();
        jump_flood(w, h, 0, &mut nearest, &mut scratch);
        settle(w, h, &mut nearest, &mut scratch);
        distance(w, &nearest, &mut away);
        let read = |what| stage::<u32>(&gpu, &cells, raymarch(), what);
        assert_eq!(read(Stage::Seeds), seeds, "seeds at {w}×{h}");
        assert_eq!(read(Stage::Nearest), nearest, "jump flood at {w}×{h}");
        let seen: Vec<f32> = stage(&gpu, &cells, raymarch(), Stage::Distance);
        for (seen, right) in seen.iter().zip(&away) {
            let right = right.min(f32::MAX);
            assert!((seen - right).abs() <= 1e-6 * right, "distance {seen}, not {right}");
        }
    }
}

#[test]
fn clear_squares_agree() {
    let gpu = device();
    for [w, h] in SIZES {
        let cells = cells(w, h, 11);
        let ground: Vec<Ground> = (0..cells.len())
            .map(|i| match () {
                () if cells.is_solid(i) => Ground::Closed,
                () if is_occupied(&cells, i, 0.0) => Ground::Matter,
                () => Ground::Clear,
            })
            .collect();
        let light = |i: usize| {
            (cells.emission()[i], log_transmittance(cells.opacity()[i], cells.tint()[i]))
        };
        let mut squares = Vec::new();
        clearance(w, &ground, |i, j| light(i) == light(j), &mut squares);
        let seen: Vec<u32> = stage(&gpu, &cells, raymarch(), Stage::Clearance);
        for (i, word) in seen.iter().enumerate() {
            let right = std::array::from_fn(|quadrant| squares[quadrant * cells.len() + i]);
            let (x, y) = (i as u32 % w, i as u32 / w);
            assert_eq!(word.to_le_bytes(), right, "at ({x}, {y}) of {w}×{h}");
        }
    }
}

fn light_on_both(gpu: &(Device, Queue), cells: &Cells, settings: Settings) -> [Vec<Rgb>; 2] {
    let (device, queue) = gpu;
    let right = Solver::new(settings.clone()).unwrap().solve(cells).unwrap().pixels().to_vec();
    let mut lighting = Lighting::new(device, queue, settings).unwrap();
    let seen = frame(device, queue, &mut lighting, cells);
    [seen.into_iter().map(|[r, g, b, _]| [r, g, b]).collect(), right]
}

/// Share of a pixel's light, or of the mean where that is more, by which both may differ: rounding,
/// and now and then a ray that passes a corner on the other side. Measured at up to 4e-5.
const TOLERANCE: f64 = 1e-3;
/// Share of pixels that may be off where rays end by the distance field: whether it is below
/// `hit_distance` is decided by rounding where both are equal. Measured at up to 5e-5.
const TIES: f64 = 1e-4;

/// How much each pixel differs.
fn differences(seen: &[Rgb], right: &[Rgb]) -> Vec<f64> {
    assert_eq!(seen.len(), right.len());
    let sum: f64 = right.as_flattened().iter().map(|&v| f64::from(v)).sum();
    let mean = sum / (3 * right.len()) as f64;
    let of = |seen: f32, right: f32| {
        f64::from((seen - right).abs()) / f64::from(right).max(mean).max(f64::MIN_POSITIVE)
    };
    let pixel = |(seen, right): (&Rgb, &Rgb)| {
        (0..3)
            .map(|c| of(seen[c], right[c]))
            .fold(0.0, |worst: f64, one| if worst.is_nan() || one <= worst { worst } else { one })
    };
    seen.iter().zip(right).map(pixel).collect()
}

/// Pixels that differ by more than the tolerance, or are no numbers.
fn wrong(seen: &[Rgb], right: &[Rgb]) -> usize {
    differences(seen, right).into_iter().filter(|d| d.is_nan() || *d > TOLERANCE).count()
}

#[track_caller]
fn agree(gpu: &(Device, Queue), name: &str, cells: &Cells, settings: Settings) {
    let ties = if settings.raymarch.hit == Hit::Distance { TIES } else { 0.0 };
    let [seen, right] = light_on_both(gpu, cells, settings);
    let worst = differences(&seen, &right).into_iter().fold(0.0, f64::max);
    let wrong = wrong(&seen, &right);
    println!("{name}: {worst:.1e}, {wrong} of {} pixels wrong", right.len());
    assert!(wrong as f64 <= ties * right.len() as f64, "{name}: {wrong} pixels, {worst:e}");
}

#[test]
fn raymarch_agrees_at_every_size() {
    let gpu = device();
    for [w, h] in SIZES {
        for bounces in [0, 1, 4].map(Bounces::Count) {
            let settings = Settings { wall_depth: 3.0, bounces, ..raymarch() };
            agree(&gpu, &format!("{w}×{h}, {bounces:?}"), &cells(w, h, 3), settings);
        }
    }
}

#[test]
fn raymarch_agrees_with_every_setting() {
    let gpu = device();
    for noise in [Noise::White, Noise::Blue, Noise::Golden] {
        for spacing in [Spacing::Even, Spacing::Golden] {
            let mut settings = Settings { seed: 12345, wall_depth: 0.5, ..raymarch() };
            settings.raymarch.noise = noise;
            settings.raymarch.spacing = spacing;
            settings.raymarch.rays = 7;
            settings.raymarch.threshold = 0.2;
            settings.raymarch.emission_multiplier = 1.5;
            agree(&gpu, &format!("{noise:?}, {spacing:?}"), &cells(97, 61, 5), settings);
        }
    }
    let mut settings = raymarch();
    settings.raymarch.steps = 3;
    agree(&gpu, "three steps", &cells(97, 61, 5), settings);
}

#[test]
fn the_seeds_march_agrees() {
    let gpu = device();
    for preset in Raymarch::PRESETS {
        for attenuation in [false, true] {
            for bounces in [0, 2].map(Bounces::Count) {
                let mut settings = Settings { bounces, ..raymarch() };
                settings.raymarch = Raymarch::preset(preset).unwrap();
                settings.raymarch.attenuation = attenuation;
                settings.raymarch.bounce = BounceBy::Frame;
                let name = format!("{preset}, fading: {attenuation}, {bounces:?}");
                for [w, h] in [[97, 61], [1, 37], [160, 90]] {
                    agree(&gpu, &format!("{name} at {w}×{h}"), &cells(w, h, 13), settings.clone());
                }
            }
        }
    }
}

#[test]
fn raymarch_agrees_under_a_sky_that_changes() {
    let mut cells = cells(61, 43, 9);
    let [zenith, horizon, ground] = [[0.1, 0.4, 2.0], [1.0, 0.8, 0.2], [0.05, 0.0, 0.0]];
    cells.set_sky(Sky::Gradient(Gradient { zenith, horizon, ground }));
    agree(&device(), "sky", &cells, raymarch());
}

#[test]
fn raymarch_agrees_on_every_example_scene() {
    let gpu = device();
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes");
    let mut scenes = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "toml") {
            let scene = Scene::load(&path).unwrap();
            let Settings { wall_depth, seed, .. } = scene.settings().unwrap();
            for (preset, bounces) in [("default", 0), ("default", 2), ("godot", 1)] {
                let bounces = Bounces::Count(bounces);
                let mut settings = Settings { wall_depth, seed, bounces, ..raymarch() };
                settings.raymarch = Raymarch::preset(preset).unwrap();
                settings.raymarch.bounce = BounceBy::Frame;
                let name = format!("{}, {preset}, {bounces:?}", path.display());
                agree(&gpu, &name, &scene.cells().unwrap(), settings);
            }
            scenes += 1;
        }
    }
    assert!(scenes >= 9);
}

#[test]
fn later_frames_have_the_noise_of_later_frames() {
    let (device, queue) = device();
    let cells = cells(64, 48, 21);
    let mut solver = Solver::new(raymarch()).unwrap();
    let mut lighting = Lighting::new(&device, &queue, raymarch()).unwrap();
    let mut before = Vec::new();
    for number in 0..18 {
        let right = solver.solve(&cells).unwrap().pixels().to_vec();
        let seen = frame(&device, &queue, &mut lighting, &cells);
        let seen: Vec<Rgb> = seen.into_iter().map(|[r, g, b, _]| [r, g, b]).collect();
        assert_eq!(wrong(&seen, &right), 0, "frame {number}");
        assert!(before.is_empty() || wrong(&seen, &before) > 0, "the same noise");
        before = seen;
    }
}

#[test]
fn one_wrong_pixel_is_rejected() {
    let [seen, right] = light_on_both(&device(), &cells(97, 61, 3), raymarch());
    assert_eq!(wrong(&seen, &right), 0);
    let mean = right.as_flattened().iter().sum::<f32>() / (3 * right.len()) as f32;
    for change in [0.01 * mean, f32::NAN, f32::INFINITY] {
        let mut changed = seen.clone();
        changed[2000][1] += change;
        assert_eq!(wrong(&changed, &right), 1, "{change} passes");
    }
}
