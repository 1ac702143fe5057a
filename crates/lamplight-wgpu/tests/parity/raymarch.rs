//! `raymarch`, by both rules.

use crate::common::{cells, device, frame, lighting, raymarch_of};
use crate::compare::{SIZES, agree, middle, scenes, wrong};
use lamplight::settings::{Noise, Raymarch, Spacing};
use lamplight::{Bounces, Gradient, Method, Rgb, Settings, Sky, Solver};

fn raymarch() -> Settings {
    Settings::direct(Method::Raymarch)
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
            raymarch_of(&mut settings).noise = noise;
            raymarch_of(&mut settings).spacing = spacing;
            raymarch_of(&mut settings).rays = 7;
            raymarch_of(&mut settings).threshold = 0.2;
            raymarch_of(&mut settings).emission_multiplier = 1.5;
            agree(&gpu, &format!("{noise:?}, {spacing:?}"), &cells(97, 61, 5), settings);
        }
    }
    let mut settings = raymarch();
    raymarch_of(&mut settings).steps = 3;
    agree(&gpu, "three steps", &cells(97, 61, 5), settings);
}

#[test]
fn the_seeds_march_agrees() {
    let gpu = device();
    for preset in Raymarch::PRESETS {
        for attenuation in [false, true] {
            for bounces in [0, 2].map(Bounces::Count) {
                let mut settings = Settings { bounces, ..raymarch() };
                *raymarch_of(&mut settings) = Raymarch::preset(preset).unwrap();
                raymarch_of(&mut settings).attenuation = attenuation;
                let name = format!("{preset}, fading: {attenuation}, {bounces:?}");
                for [w, h] in [[97, 61], [1, 37]] {
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
    for (name, scene) in scenes() {
        let Settings { wall_depth, seed, .. } = scene.resolve_settings().unwrap();
        for (preset, bounces) in [("default", 0), ("default", 2), ("godot", 1)] {
            let bounces = Bounces::Count(bounces);
            let mut settings = Settings { wall_depth, seed, bounces, ..raymarch() };
            *raymarch_of(&mut settings) = Raymarch::preset(preset).unwrap();
            let name = format!("{name}, {preset}, {bounces:?}");
            agree(&gpu, &name, &middle(&scene), settings);
        }
    }
}

#[test]
fn later_frames_have_the_noise_of_later_frames() {
    let (device, queue) = device();
    let cells = cells(64, 48, 21);
    let mut solver = Solver::new(raymarch()).unwrap();
    let mut lighting = lighting(&device, &queue);
    let mut before = Vec::new();
    for number in 0..18 {
        let right = solver.solve(&cells).unwrap().pixels().to_vec();
        let seen = frame(&device, &queue, &mut lighting, &raymarch(), &cells);
        let seen: Vec<Rgb> = seen.into_iter().map(|[r, g, b, _]| [r, g, b]).collect();
        assert_eq!(wrong(&seen, &right), 0, "frame {number}");
        assert!(before.is_empty() || wrong(&seen, &before) > 0, "the same noise");
        before = seen;
    }
}
