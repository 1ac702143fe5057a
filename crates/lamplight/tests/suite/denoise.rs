//! The blur removes only noise.

use crate::common::*;
use lamplight::internals::Estimate;
use lamplight::internals::denoise::Denoiser;
use lamplight::settings;
use lamplight::{Cells, Lamp, Light, Matter, Rgb, Settings, Sky};

/// The most error that the blur may leave of a frame of 32 rays.
const LEFT_OF_NOISE: f64 = 0.6;
/// The most that it may change a picture of 4096 rays, relative RMSE: its noise is about half of it.
const CHANGED: f64 = 0.01;
/// Weights that sum to 1 in f32, over six passes.
const ROUNDING: f32 = 1e-5;

/// Light of which each cell's noise has this variance, blurred.
fn blurred(cells: &Cells, light: &[Rgb], variance: f32, passes: u32) -> Vec<Rgb> {
    let mut estimate = Estimate::default();
    estimate.resize(light.len());
    estimate.light.copy_from_slice(light);
    estimate.variance.fill(variance);
    let settings = settings::Denoise { passes, ..Default::default() };
    Denoiser::default().denoise(&settings, cells, &mut estimate);
    estimate.light
}

/// Settings with so many rays, and passes of the blur.
fn of_rays(rays: u32, passes: u32) -> Settings {
    settings(|s| (raymarch_of(s).rays, raymarch_of(s).denoise.passes) = (rays, passes))
}

/// A hall with pillars, a lamp and a dim sky seen through a window.
fn hall() -> Cells {
    let mut cells = grid(80, 50, |x, y| {
        let window = y == 0 && (50..60).contains(&x);
        let edge = (x == 0 || y == 0 || x == 79 || y == 49) && !window;
        let pillar = x % 17 < 3 && y % 15 < 3;
        if edge || pillar { WALL } else { Matter::EMPTY }
    });
    cells.lamps_mut().push(Lamp { position: [24.0, 24.0], size: 3.0, intensity: 5.0, ..LAMP });
    cells.set_sky(Sky::Uniform([0.3, 0.4, 0.6]));
    cells
}

#[test]
fn noise_falls_and_features_stay() {
    let cells = hall();
    let truth = solve(&settings(|s| (raymarch_of(s).rays, s.seed) = (4096, 9)), &cells);
    let with = |rays, passes| relative_rmse(&solve(&of_rays(rays, passes), &cells), &truth);
    let before = with(32, 0);
    let after = [1, 3, 5].map(|passes| with(32, passes));
    let percent = after.map(|e| format!("{:.2} %", 100.0 * e));
    println!("32 rays: {:.2} %; after 1, 3 and 5 passes {percent:?}", 100.0 * before);
    assert!(after[1].max(after[2]) < LEFT_OF_NOISE * before, "{before} to {after:?}");
    assert!(after[0] < before, "{before} to {after:?}");
    let (before, after) = (with(4096, 0), with(4096, 5));
    println!("4096 rays: {:.2} %; after 5 passes {:.2} %", 100.0 * before, 100.0 * after);
    assert!(after < CHANGED, "{before} to {after}");
}

#[test]
fn light_without_noise_stays() {
    let drawn = hall().drawn().into_owned();
    let random = &mut seeded(4);
    let light: Vec<Rgb> = (0..drawn.len()).map(|_| rgb(random)).collect();
    let most = |variance| {
        let after = blurred(&drawn, &light, variance, 5);
        let channels = light.as_flattened().iter().zip(after.as_flattened());
        channels.map(|(b, a)| (a / b - 1.0).abs()).fold(0.0, f32::max)
    };
    assert!(most(0.0) < ROUNDING, "{}", most(0.0));
    assert!(most(0.1) > 0.5, "noise stays too: {}", most(0.1));
}

#[test]
fn a_uniform_picture_does_not_change() {
    let cells = hall();
    let light = vec![[0.25, 3.0, 1e4]; cells.len()];
    for (after, before) in blurred(&cells, &light, 1.0, 6).iter().zip(&light) {
        for c in 0..3 {
            assert!((after[c] / before[c] - 1.0).abs() < ROUNDING, "{after:?}");
        }
    }
}

#[test]
fn the_blur_does_not_cross_walls() {
    let random = &mut fresh();
    for round in 0..60 {
        let contact = if round % 2 == 0 { Contact::Sides } else { Contact::Corners };
        let size = [2 + random.u32(..60), 2 + random.u32(..40)];
        let count = 1 + random.usize(..(size[0] * size[1]) as usize / 2);
        let sealed = Sealed::new(random, size, count, contact);
        let cells = grid(size[0], size[1], |x, y| {
            let i = (y * size[0] + x) as usize;
            if sealed.wall[i] { WALL } else { Matter::EMPTY }
        });
        let inside = |i: usize| if sealed.inside[i] { [1e6 * random.f32(); 3] } else { [0.0; 3] };
        let light: Vec<Rgb> = (0..cells.len()).map(inside).collect();
        let after = blurred(&cells, &light, 1e12, 6);
        for i in 0..cells.len() {
            let changed = after[i] != light[i];
            assert!(sealed.inside[i] || !changed, "{contact:?}, {size:?}: cell {i}");
        }
    }
}

#[test]
fn the_blur_crosses_open_space() {
    let noise = &mut seeded(1);
    let cells = Cells::new(20, 20).unwrap();
    let left = |i: usize| if i % 20 < 10 { [noise.f32() + 1.0; 3] } else { [0.0; 3] };
    let light: Vec<Rgb> = (0..400).map(left).collect();
    assert!(blurred(&cells, &light, 0.02, 1)[10][0] > 0.0);
}

#[test]
fn edges_of_media_stay() {
    // A medium on the right is brighter, with the same noise on both sides.
    let scene = |medium: Matter| grid(40, 30, |x, _| if x < 20 { Matter::EMPTY } else { medium });
    let noise = &mut seeded(2);
    let light: Vec<Rgb> =
        (0..1200).map(|i| [noise.f32() * 0.5 + if i % 40 < 20 { 1.0 } else { 2.0 }; 3]).collect();
    let step = |light: &[Rgb]| {
        let column = |x: usize| (0..30).map(|y| light[y * 40 + x][0]).sum::<f32>() / 30.0;
        column(20) - column(19)
    };
    let after = |medium| step(&blurred(&scene(medium), &light, 1.0, 5));
    let lost = after(Matter::EMPTY);
    assert!(lost < 0.8, "the step is lost without an edge: {lost}");
    let fog = Matter { opacity: 0.9, ..Matter::EMPTY };
    let glass = Matter { tint: [1.0, 0.1, 1.0], ..Matter::EMPTY };
    for medium in [fog, glass] {
        let kept = after(medium);
        println!("a step of 1 is {kept:.3} at an edge, {lost:.3} without");
        // Transmittance that differs by 0.9 leaves e^(−8·0.9) = 0.0007 of the weight.
        assert!((kept - 1.0).abs() < 0.1, "{medium:?}: {kept}");
    }
}

#[test]
fn walls_of_one_cell_keep_their_light_at_any_size() {
    for (w, h) in [(1, 1), (1, 40), (40, 1), (2, 2), (7, 3)] {
        let cells = grid(w, h, |x, y| if (x + y) % 3 == 1 { WALL } else { Matter::EMPTY });
        let noise = &mut seeded(3);
        let light: Vec<Rgb> = (0..cells.len()).map(|_| rgb(noise)).collect();
        for (i, after) in blurred(&cells, &light, 1.0, 6).iter().enumerate() {
            let kept = (0..3).all(|c| (after[c] - light[i][c]).abs() <= ROUNDING);
            assert!(!cells.is_solid(i) || kept, "{after:?}");
            assert!(after.iter().all(|v| (0.0..=1.0 + ROUNDING).contains(v)), "{after:?}");
        }
    }
}

#[test]
fn far_from_a_small_lamp_there_is_neither_a_pattern_nor_too_little_light() {
    let mut cells = grid(160, 100, |_, _| Matter::EMPTY);
    cells.lamps_mut().push(Lamp { position: [60.0, 50.0], size: 3.0, ..LAMP });
    let lit = |rays, passes| solve(&of_rays(rays, passes), &cells);
    let right = lit(4096, 0);
    // The mean relative light, and the deviation of cells from the mean of their neighbours.
    let seen = |light: &Light| {
        let relative = |x: u32, y: u32| light.at(x, y)[1] / right.at(x, y)[1];
        let far = || (130..154).flat_map(|x| (6..30).map(move |y| [x, y]));
        let count = far().count() as f32;
        let mean = far().map(|[x, y]| relative(x, y)).sum::<f32>() / count;
        let pattern = far().map(|[x, y]| {
            let beside = [[x - 1, y], [x + 1, y], [x, y - 1], [x, y + 1]];
            let around = beside.iter().map(|&[x, y]| relative(x, y)).sum::<f32>() / 4.0;
            (relative(x, y) - around).powi(2)
        });
        (mean, (pattern.sum::<f32>() / count).sqrt())
    };
    let [raw, smoothed] = [lit(32, 0), lit(32, 4)].map(|light| seen(&light));
    println!("mean and pattern: {raw:?} before, {smoothed:?} after");
    assert!((0.96..1.02).contains(&smoothed.0) && smoothed.1 < 0.015);
    assert!(raw.1 > 0.5, "what is measured is there without the blur");
}

#[test]
fn noise_of_a_wall_falls_along_each_side_of_it() {
    // A wall of three px, from which a bright room and a dark one are seen.
    let cells = grid(64, 24, |_, y| if (10..13).contains(&y) { WALL } else { Matter::EMPTY });
    let noise = &mut seeded(5);
    let mut light = vec![[0.0; 3]; cells.len()];
    let row = |y: usize| 64 * y..64 * (y + 1);
    let rows = [(10, 8.0), (11, 0.0), (12, 1.0)];
    for (y, mean) in rows {
        // As of faces of which few see a light.
        light[row(y)].fill_with(|| [if rgb(noise)[0] < 0.25 { 4.0 * mean } else { 0.0 }; 3]);
    }
    let after = blurred(&cells, &light, 192.0, 4);
    for (y, mean) in rows {
        let of = |light: &[Rgb]| light[row(y)].iter().map(|v| v[0]).collect::<Vec<_>>();
        let (before, after) = (of(&light), of(&after));
        let deviation = |row: &[f32]| {
            let squares = row.iter().map(|v| (v - mean) * (v - mean));
            (squares.sum::<f32>() / row.len() as f32).sqrt()
        };
        let deviations = [&before, &after].map(|row| deviation(row));
        let sums = [&before, &after].map(|row| row.iter().sum::<f32>() / row.len() as f32);
        println!("row {y}: deviations {deviations:?}, means {sums:?}");
        assert!((sums[0] - sums[1]).abs() <= 0.1 * mean, "no light of another side");
        assert!(deviations[1] <= 0.45 * deviations[0], "{deviations:?}");
    }
}

#[test]
fn walls_along_which_a_small_light_shines_are_not_black() {
    let mut cells = grid(160, 100, |x, y| {
        let is_box = (80..110).contains(&x) && (40..70).contains(&y);
        if is_box { WALL } else { Matter::EMPTY }
    });
    cells.lamps_mut().push(Lamp { position: [40.0, 30.0], size: 3.0, ..LAMP });
    let lit = |rays, passes| {
        let light = solve(&of_rays(rays, passes), &cells);
        (82..108).map(|x| light.at(x, 40)[1]).collect::<Vec<_>>()
    };
    let right = lit(4096, 0);
    let least = |row: &[f32]| {
        row.iter().zip(&right).map(|(seen, right)| seen / right).fold(f32::INFINITY, f32::min)
    };
    let [raw, smoothed] = [lit(32, 0), lit(32, 4)].map(|row| least(&row));
    println!("least light of a face, relative: {raw:.2} before, {smoothed:.2} after");
    assert!(smoothed > 0.6);
    assert!(raw < 0.1, "what is measured is there without the blur");
}

/// Most that a cell may differ from its neighbours once blurred, relative to them: twice the 1.2
/// that is seen. When the noise of two lights cancelled in the estimate, arcs between them kept 9.7.
const SMOOTH: f32 = 2.5;

/// The largest difference of a cell from the mean of its eight neighbours, relative to that mean,
/// over the cells that are not right beside a light or the border.
fn grain(light: &Light, lights: [[i32; 2]; 2]) -> f32 {
    let [w, h] = [light.width() as i32, light.height() as i32];
    let green = |x: i32, y: i32| light.at(x as u32, y as u32)[1];
    let mut largest = 0.0f32;
    for y in 1..h - 1 {
        for x in 1..w - 1 {
            if lights.iter().any(|l| (l[0] - x).abs().max((l[1] - y).abs()) < 16) {
                continue;
            }
            let around: f32 = (-1..=1)
                .flat_map(|dy| (-1..=1).map(move |dx| [dx, dy]))
                .filter(|d| *d != [0, 0])
                .map(|[dx, dy]| green(x + dx, y + dy) / 8.0)
                .sum();
            largest = largest.max((green(x, y) - around).abs() / around.max(f32::MIN_POSITIVE));
        }
    }
    largest
}

#[test]
fn two_lights_leave_no_grain_between_them() {
    let lights = [[30, 60], [90, 60]];
    let cells = grid(120, 120, |x, y| {
        let near = |l: &[i32; 2]| (l[0] - x as i32).abs().max((l[1] - y as i32).abs()) < 2;
        if lights.iter().any(near) { GLOW } else { Matter::EMPTY }
    });
    let grain_after = |passes| grain(&solve(&of_rays(32, passes), &cells), lights);
    let (raw, blurred) = (grain_after(0), grain_after(4));
    println!("grain {raw:.2} before, {blurred:.2} after");
    assert!(blurred < SMOOTH);
    assert!(raw > SMOOTH, "what is measured is there without the blur");
}
