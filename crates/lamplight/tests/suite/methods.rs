//! Every method and preset on every kind of size: no panic, light that is finite and in its place.

use crate::common::*;
use lamplight::{Bounces, Cells, Error, Gradient, Lamp, Light, Matter, Method, Settings};
use lamplight::{SettingsTable, Sky, Solver};

/// One px, one row, one column, primes, powers of two, long and thin.
const SIZES: [[u32; 2]; 11] = [
    [1, 1],
    [1, 7],
    [7, 1],
    [2, 2],
    [1, 257],
    [61, 53],
    [97, 101],
    [256, 3],
    [128, 128],
    [4096, 1],
    [1, 4096],
];
/// Sums of some hundred f32, relative.
const ROUNDING: f32 = 1e-4;

/// Every method with each of its presets.
fn every_preset() -> impl Iterator<Item = (Method, &'static str, Settings)> {
    let presets = |&method: &Method| method.presets().iter().map(move |&preset| (method, preset));
    Method::ALL.iter().flat_map(presets).map(|(method, preset)| {
        let mut table = SettingsTable::default();
        table.set("method", method.name());
        table.set(&format!("{}.preset", method.name()), preset);
        table.set("bounces", 1);
        (method, preset, table.resolve().unwrap())
    })
}

/// A lamp, a wall that glows, fog, glass and a sky, as far as the grid has room for them.
fn scene(width: u32, height: u32) -> Cells {
    let mut cells = grid(width, height, |x, y| match (x + 3 * y) % 19 {
        0 => Matter { emission: [0.5, 1.0, 2.0], albedo: [0.5; 3], ..WALL },
        5 => Matter { opacity: 0.1, albedo: [0.5; 3], ..Matter::EMPTY },
        9 => Matter { tint: [0.9, 0.5, 0.2], ..Matter::EMPTY },
        _ => Matter::EMPTY,
    });
    let position = [width as f32 / 2.0, height as f32 / 2.0];
    cells.lamps_mut().push(Lamp { position, size: 0.7, ..LAMP });
    cells.set_sky(Sky::Gradient(Gradient {
        zenith: [0.2, 0.3, 0.6],
        horizon: [0.5, 0.3, 0.2],
        ground: [0.0; 3],
    }));
    cells
}

#[test]
fn every_size_is_lit() {
    for (method, preset, settings) in every_preset() {
        for [width, height] in SIZES {
            // The plain variant holds all levels at once.
            let what = format!("{} {preset} at {width}×{height}", method.name());
            let cells = scene(width, height);
            let light = Solver::new(settings.clone()).unwrap().solve(&cells).unwrap().clone();
            assert_eq!((light.width(), light.height()), (width, height), "{what}");
            let good = |v: &f32| v.is_finite() && *v >= 0.0;
            assert!(light.pixels().as_flattened().iter().all(good), "{what}");
            queries_agree(&light, &what);
        }
    }
}

/// Asserts that queries of gameplay code agree with the picture.
fn queries_agree(light: &Light, what: &str) {
    let (w, h) = (light.width(), light.height());
    let (mut sum, mut count) = ([0.0f64; 3], 0);
    for y in 0..h {
        for x in 0..w {
            let pixel = light.pixels()[(y * w + x) as usize];
            assert_eq!(light.at(x, y), pixel, "{what}");
            if !light.solid()[(y * w + x) as usize] {
                let centre = [x as f32 + 0.5, y as f32 + 0.5];
                for (a, b) in light.sample(centre).into_iter().zip(pixel) {
                    assert!((a - b).abs() <= ROUNDING * (1.0 + b), "{what}: sample at {centre:?}");
                }
                (0..3).for_each(|c| sum[c] += f64::from(pixel[c]));
                count += 1;
            }
        }
    }
    let over = light.over([0.0, 0.0], [w as f32, h as f32]);
    for c in 0..3 {
        let mean = (sum[c] / f64::from(count.max(1))) as f32;
        assert!((over[c] - mean).abs() <= ROUNDING * (1.0 + mean), "{what}: {over:?}, not {mean}");
    }
}

/// The most that light may change by a quarter turn where directions are on a lattice that turns
/// with it: sums in another order, stored with 8 bits.
const TURNED: f64 = 1e-3;

#[test]
fn turning_the_scene_turns_the_light() {
    let on_a_lattice = |method| matches!(method, Method::Cascades | Method::Holographic);
    for (method, preset, settings) in every_preset().filter(|way| on_a_lattice(way.0)) {
        // Rows that share a point are the same from both sides only if the last point has as many as the others.
        let (w, h) = match (method, preset) {
            (Method::Holographic, "fast") => (62, 38),
            (Method::Holographic, "coarse") => (60, 36),
            _ => (61, 37),
        };
        let mut cells = scene(w, h);
        cells.lamps_mut().clear();
        cells.set_sky(Sky::Uniform([0.1, 0.2, 0.3]));
        let solve =
            |cells: &Cells| Solver::new(settings.clone()).unwrap().solve(cells).unwrap().clone();
        let (light, around) = (solve(&cells), solve(&turned(&cells)));
        let back = |wrong: u32| {
            let at = |i| around.at(h - 1 - i / w, (i % w + wrong) % w);
            relative_rmse(
                &Light::from_pixels(&cells, (0..w * h).map(at).collect()).unwrap(),
                &light,
            )
        };
        println!("{} {preset}: {:.4} %", method.name(), 100.0 * back(0));
        assert!(back(0) < TURNED, "{} {preset}: {}", method.name(), back(0));
        assert!(back(1) > 10.0 * TURNED, "{} {preset}: light off by a px passes", method.name());
    }
}

#[test]
fn scenes_without_emission_stay_dark() {
    for (method, preset, settings) in every_preset() {
        let mut cells = scene(61, 53);
        cells.set_sky(Sky::BLACK);
        cells.emission_mut().fill([0.0; 3]);
        for lamp in cells.lamps_mut() {
            lamp.intensity = 0.0;
        }
        let light = Solver::new(settings).unwrap().solve(&cells).unwrap().clone();
        let lit = light.pixels().iter().filter(|p| **p != [0.0; 3]).count();
        assert_eq!(lit, 0, "{} {preset}", method.name());
    }
}

#[test]
fn every_method_rejects_invalid_cells() {
    for (method, preset, settings) in every_preset() {
        let mut solver = Solver::new(settings).unwrap();
        for bad in [f32::NAN, f32::INFINITY, -1.0] {
            let mut cells = scene(7, 5);
            cells.emission_mut()[17][1] = bad;
            let error = solver.solve(&cells).unwrap_err();
            let named = matches!(error, Error::Cell { x: 3, y: 2, field: "emission", .. });
            assert!(named, "{} {preset}: {error}", method.name());
        }
    }
}

#[test]
fn only_polar_needs_a_lamp() {
    for (method, preset, settings) in every_preset() {
        let cells = grid(9, 9, |x, _| if x == 4 { GLOW } else { Matter::EMPTY });
        let settings = Settings { bounces: Bounces::Count(0), ..settings };
        let result = Solver::new(settings).unwrap().solve(&cells).map(|light| light.at(1, 4)[0]);
        match method {
            Method::Polar => assert!(result.is_err(), "{preset} lights what has no lamp"),
            _ => assert!(result.unwrap() > 0.0, "{} {preset} leaves it black", method.name()),
        }
    }
}

#[test]
fn invalid_settings_are_rejected_by_name() {
    let resolve = |text: &str| {
        let mut table = SettingsTable::default();
        table.set_from_text(text).and_then(|()| table.resolve())
    };
    for (text, key) in [
        ("holographic.gather_level=0", "holographic.gather_level"),
        ("holographic.gather_level=5", "holographic.gather_level"),
        ("holographic.gather_length=0", "holographic.gather_length"),
        ("holographic.gather_length=16", "holographic.gather_length"),
        ("holographic.gather_rays=0", "holographic.gather_rays"),
        ("holographic.gather_rays=17", "holographic.gather_rays"),
        ("holographic.bundle_rays=0", "holographic.bundle_rays"),
        ("holographic.bundle_rays=17", "holographic.bundle_rays"),
        ("holographic.bundle_rays=nan", "holographic.bundle_rays"),
        ("holographic.preset=best", "holographic.preset"),
        ("holographic.merge=plain", "merge"),
        ("cascades.rays=5", "cascades.rays"),
        ("cascades.interval=-1", "cascades.interval"),
        ("cascades.interval=nan", "cascades.interval"),
        ("cascades.overlap=1.5", "cascades.overlap"),
        ("cascades.hop=3", "hop"),
        ("cascades.preset=best", "cascades.preset"),
        ("polar.preset=best", "polar.preset"),
        ("polar.beams=4", "beams"),
        ("flood.decay=nan", "flood.decay"),
        ("flood.hop=1", "hop"),
        ("method=radiosity", "method"),
    ] {
        let error = resolve(text).unwrap_err().to_string();
        assert!(error.contains(key), "{text}: {error}");
    }
}

#[test]
fn methods_repeat_frames_as_documented() {
    let cells = scene(61, 53);
    for (method, preset, settings) in every_preset() {
        let mut laid = Settings { bounces: Bounces::Count(1), ..Settings::new(method) };
        laid.set_preset(preset).unwrap();
        assert_eq!(laid, settings, "{preset} by its table and by itself");
        let repeats = settings.repeats();
        let mut solver = Solver::new(settings).unwrap();
        let first = solver.solve(&cells).unwrap().clone();
        let same = *solver.solve(&cells).unwrap() == first;
        // Some presets of other methods repeat too, without a guarantee.
        assert!(same || !repeats, "{method:?} {preset}");
        assert!(!same || preset != "default" || repeats, "{method:?} {preset}");
    }
}

#[test]
fn fields_are_the_same_by_the_cheapest_settings() {
    let cells = scene(61, 53);
    let mut settings = Settings::direct(Method::Raymarch);
    raymarch_of(&mut settings).threshold = 0.4;
    let fields = |settings: Settings| {
        let mut solver = Solver::new(settings).unwrap();
        solver.solve(&cells).unwrap();
        let stages = solver.stages();
        (stages.seeds.to_vec(), stages.nearest.to_vec(), stages.distance.to_vec())
    };
    let found = fields(settings.clone());
    assert_eq!(found, fields(settings.fields_only()));
    raymarch_of(&mut settings).threshold = 0.0;
    assert_ne!(found, fields(settings.fields_only()), "the threshold is passed on");
}

#[test]
fn looking_at_the_stages_of_a_frame_leaves_its_times() {
    let mut solver = Solver::new(Settings::direct(Method::Holographic)).unwrap();
    solver.solve(&jumble(24, 16, 1)).unwrap();
    let times = solver.timings().to_vec();
    assert!(!solver.stages().distance.is_empty());
    assert_eq!(solver.timings(), times);
}
