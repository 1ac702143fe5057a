//! Panoramas: their directions, and that every method sees all of them.

use crate::common::*;
use lamplight::settings::{Cascades, Holographic, MethodSettings, Raymarch};
use lamplight::{Cells, Gradient, Light, Matter, Method, Panorama, Rgb, Settings, Sky, Solver};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Sums of some thousand f32, relative.
const ROUNDING: f64 = 1e-5;
/// A gradient as 1024 columns: linear between columns in place of the sine, whose second derivative is 1. Between two of
/// them it is off by (2π/1024)²/8 = 5e-6, where it has its bend at the horizon by a quarter of 2π/1024.
const SAMPLED: f64 = 2e-3;

/// Every method that sees the sky, and the presets of those with cones.
fn variants() -> Vec<(String, Settings)> {
    let named = |method: Method, preset: &str, settings: MethodSettings| {
        (format!("{} {preset}", method.name()), Settings::direct(settings))
    };
    let raymarch = unfiltered(Raymarch { rays: 64, ..Raymarch::default() });
    let mut all = vec![
        named(Method::Raymarch, "default", raymarch.into()),
        named(Method::Flood, "default", Method::Flood.into()),
    ];
    for &preset in Method::Holographic.presets() {
        let settings = Holographic::preset(preset).unwrap();
        all.push(named(Method::Holographic, preset, settings.into()));
    }
    for &preset in Method::Cascades.presets() {
        all.push(named(Method::Cascades, preset, Cascades::preset(preset).unwrap().into()));
    }
    all
}

fn solve(settings: &Settings, cells: &Cells, sky: impl Into<Sky>) -> Light {
    let mut cells = cells.clone();
    cells.set_sky(sky.into());
    Solver::new(settings.clone()).unwrap().solve(&cells).unwrap().clone()
}

/// The largest difference over open cells, relative to the mean.
fn worst(a: &Light, b: &Light) -> f64 {
    let sum: f32 = b.pixels().as_flattened().iter().sum();
    let mean = f64::from(sum) / (3 * b.pixels().len()) as f64;
    let pairs = a.pixels().as_flattened().iter().zip(b.pixels().as_flattened());
    pairs.map(|(a, b)| f64::from((a - b).abs())).fold(0.0, f64::max) / mean
}

/// A panorama of random columns.
fn random_panorama(random: &mut fastrand::Rng, columns: usize) -> Panorama {
    let columns: Vec<Rgb> = (0..columns).map(|_| rgb(random)).collect();
    Panorama::new(&columns).unwrap().turned(7.0 * random.f32() - 3.5)
}

/// A few walls, so that skies throw shadows.
fn walls(width: u32, height: u32) -> Cells {
    grid(width, height, |x, y| match (x / 5 % 4, y / 4 % 5) {
        (1, 2) => Matter { albedo: [0.5; 3], ..WALL },
        _ => Matter::EMPTY,
    })
}

#[test]
fn the_strip_begins_below_and_goes_clockwise() {
    let columns = [[1.0; 3], [2.0; 3], [3.0; 3], [4.0; 3]];
    let panorama = Panorama::new(&columns).unwrap();
    let diagonals = [[-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]];
    for (i, direction) in diagonals.into_iter().enumerate() {
        let at = |panorama: &Panorama| panorama.radiance(direction)[0];
        near(at(&panorama), (i + 1) as f64, 1e-6);
        let later = panorama.clone().turned(std::f32::consts::FRAC_PI_2);
        near(at(&later), ((i + 3) % 4 + 1) as f64, 1e-6);
    }
    // Half way between the two upper columns, and across the ends.
    near(panorama.radiance([0.0, -2.0])[0], 2.5, 1e-6);
    near(panorama.radiance([0.0, 0.5])[0], 2.5, 1e-6);
}

#[test]
fn the_mean_is_that_of_all_directions_between() {
    let random = &mut fresh();
    let gradient = Gradient { zenith: rgb(random), horizon: rgb(random), ground: rgb(random) };
    for case in 0..60 {
        let columns = 1 + random.usize(..40);
        let sky = match case % 3 {
            0 => Sky::Gradient(gradient),
            _ => random_panorama(random, columns).into(),
        };
        let from = 20.0 * random.f64() - 10.0;
        let to = from + TAU * random.f64().powi(3) + 1e-3;
        const STEPS: u32 = 20_000;
        let mut sum = [0.0; 3];
        for step in 0..STEPS {
            let angle = from + (to - from) * (f64::from(step) + 0.5) / f64::from(STEPS);
            let seen = sky.radiance([angle.cos() as f32, angle.sin() as f32]);
            (0..3).for_each(|c| sum[c] += f64::from(seen[c]) / f64::from(STEPS));
        }
        let mean = sky.mean(from, to);
        (0..3).for_each(|c| near(mean[c], sum[c], 1e-4));
        let other = sky.mean(from + 0.5, to + 0.5);
        assert!(columns < 3 || other != mean, "another part of the sky passes");
    }
}

#[test]
fn an_even_panorama_is_a_uniform_sky() {
    let color = [0.3, 1.0, 7.0];
    let cells = walls(61, 43);
    for (name, settings) in variants() {
        for columns in [1, 7] {
            let panorama = Panorama::new(&vec![color; columns]).unwrap().turned(1.0);
            let light = solve(&settings, &cells, panorama);
            let uniform = solve(&settings, &cells, color);
            let off = worst(&light, &uniform);
            assert!(off < ROUNDING, "{name}, {columns} columns: {off}");
            let other = worst(&solve(&settings, &cells, color.map(|v| 1.001 * v)), &uniform);
            assert!(other > ROUNDING, "{name}: another sky passes");
        }
    }
}

#[test]
fn a_gradient_as_a_panorama_is_the_gradient() {
    let gradient =
        Gradient { zenith: [0.1, 0.4, 2.0], horizon: [1.0, 0.8, 0.2], ground: [0.05, 0.0, 0.0] };
    let sky = Sky::Gradient(gradient);
    let column = |k: u32| {
        let angle = FRAC_PI_2 + TAU * (f64::from(k) + 0.5) / 1024.0;
        sky.radiance([angle.cos() as f32, angle.sin() as f32])
    };
    let panorama = Panorama::new(&(0..1024).map(column).collect::<Vec<_>>()).unwrap();
    let cells = walls(61, 43);
    for (name, settings) in variants() {
        // Whose rays are few: it takes a gradient at the ray, a panorama around it.
        if name.starts_with("flood") {
            continue;
        }
        let right = solve(&settings, &cells, gradient);
        let off = worst(&solve(&settings, &cells, panorama.clone()), &right);
        println!("{name}: {off:.1e}");
        assert!(off < SAMPLED, "{name}: {off}");
        let turned = worst(&solve(&settings, &cells, panorama.clone().turned(0.05)), &right);
        assert!(turned > SAMPLED, "{name}: a turned sky passes");
    }
}

#[test]
fn a_turned_sky_over_a_turned_grid_gives_turned_light() {
    let random = &mut fresh();
    let panorama = random_panorama(random, 33);
    let quarter = panorama.turn() + std::f32::consts::FRAC_PI_2;
    for (name, settings) in variants() {
        // The noise of rays does not turn, nor does a blur along x, then y.
        if name.starts_with("raymarch") || name.starts_with("flood") {
            continue;
        }
        // Rows that share a point turn only if all points have as many.
        let side = match name.as_str() {
            "holographic fast" => 38,
            "holographic coarse" => 40,
            _ => 37,
        };
        let cells = walls(side, side);
        let light = solve(&settings, &cells, panorama.clone());
        let both = solve(&settings, &turned(&cells), panorama.clone().turned(quarter));
        let back = |light: &Light| {
            let mut off = 0.0f32;
            for y in 0..side {
                for x in 0..side {
                    let [a, b] = [both.at(side - 1 - y, x), light.at(x, y)];
                    off = (0..3).map(|c| (a[c] - b[c]).abs()).fold(off, f32::max);
                }
            }
            off
        };
        let off = back(&light);
        assert!(off < 1e-4, "{name}: {off}");
        let still = back(&solve(&settings, &cells, panorama.clone().turned(quarter)));
        assert!(still > 0.01, "{name}: the sky of another direction passes");
    }
}

#[test]
fn a_sun_of_three_degrees_loses_no_light() {
    const COLUMNS: usize = 120;
    let random = &mut fresh();
    for (name, settings) in variants() {
        // Rays see a sun that is as narrow by chance, or around themselves only.
        if name.starts_with("raymarch") || name.starts_with("flood") {
            continue;
        }
        for [width, height] in [[1, 1], [61, 43], [130, 67]] {
            let mut columns = [[0.0; 3]; COLUMNS];
            columns[random.usize(..COLUMNS)] = [COLUMNS as f32; 3];
            let panorama = Panorama::new(&columns).unwrap().turned(random.f32());
            let light = solve(&settings, &Cells::new(width, height).unwrap(), panorama);
            for pixel in light.pixels() {
                near(pixel[0], 1.0, 10.0 * ROUNDING);
            }
        }
    }
}

#[test]
fn wrong_panoramas_are_refused() {
    let refused = |columns: &[Rgb], expected: &str| {
        let message = Panorama::new(columns).unwrap_err().to_string();
        assert_eq!(message, expected);
    };
    refused(&[], "`sky.columns` is a list of 0, but must be a list of 1 to 8192 colours");
    refused(
        &vec![[0.0; 3]; 8193],
        "`sky.columns` is a list of 8193, but must be a list of 1 to 8192 colours",
    );
    for bad in [f32::NAN, f32::INFINITY, -1.0, 2e12] {
        refused(
            &[[0.0; 3], [0.0, bad, 0.0]],
            &format!(
                "`sky.columns[1]` is [0, {bad}, 0], but must be three radiances from 0 to 1e12"
            ),
        );
    }
    let mut cells = Cells::new(3, 3).unwrap();
    cells.set_sky(Panorama::new(&[[1.0; 3]]).unwrap().turned(f32::NAN).into());
    assert_eq!(
        cells.check().unwrap_err().to_string(),
        "`sky.turn` is NaN, but must be a finite angle"
    );
}

#[test]
fn a_sky_may_be_turned_around_many_times() {
    let panorama = Panorama::new(&[[0.0; 3], [1.0; 3], [4.0; 3]]).unwrap();
    for turn in [7.0, -100.0, 1e18, f32::MAX] {
        let turned = panorama.clone().turned(turn);
        assert!(turned.turn().abs() < std::f32::consts::TAU, "{turn}: {}", turned.turn());
        near(turned.mean(0.0, TAU)[0], 5.0 / 3.0, 1e-6);
    }
    assert_eq!(panorama.turned(-6.0).turn(), -6.0);
}
