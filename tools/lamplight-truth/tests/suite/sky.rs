//! Panoramas: the reference held to closed forms, and the methods held to the reference.

use crate::common::{WALL, direct, expect_rgb, grid, inside, tracer};
use lamplight::settings::{Cascades, Holographic, MethodSettings, Raymarch};
use lamplight::{Bounces, Cells, Direct, Light, Matter, Panorama, Rgb, Settings, Solver, Sun};
use lamplight_truth::scenes::open_cells;
use lamplight_truth::{Measures, PathTracer};
use std::f64::consts::TAU;

/// Relative precision of the comparison with closed forms.
const POWER: f64 = 0.05;
/// Columns of the strip below: 3° each.
const COLUMNS: usize = 120;
/// Open cells looked at, and paths of the reference per cell.
const LOOKS: usize = 600;
const PATHS: u32 = 8192;

/// A dusk: warm on the left, blue on the right and above, dark below; and a sun of one column at the upper left.
fn dusk(sun: f32) -> Panorama {
    let column = |k: usize| -> Rgb {
        // 0 straight down, a quarter on the left, a half above.
        let turn = (k as f32 + 0.5) / COLUMNS as f32;
        let near = |at: f32, width: f32| (1.0 - (turn - at).abs() / width).max(0.0);
        let [warm, blue] = [near(0.25, 0.15), near(0.6, 0.35)];
        let sun = if k == 37 { sun } else { 0.0 };
        let red = 1.5 * warm + 0.1 * blue + sun;
        let green = 0.6 * warm + 0.2 * blue + 0.8 * sun;
        [red, green, 0.2 * warm + 0.6 * blue + 0.5 * sun]
    };
    Panorama::new(&(0..COLUMNS).map(column).collect::<Vec<_>>()).unwrap()
}

/// Houses on a floor, with windows and an arcade.
fn skyline(sky: &Panorama) -> Cells {
    let wall = Matter { albedo: [0.6, 0.5, 0.4], ..WALL };
    let mut cells = grid(200, 120, |x, y| {
        let at = [x, y];
        let house = inside(at, [20, 50], [50, 110])
            || inside(at, [80, 70], [130, 110])
            || inside(at, [150, 30], [170, 110]);
        let room = inside(at, [24, 54], [46, 80])
            || inside(at, [84, 76], [126, 104])
            || inside(at, [154, 40], [166, 60]);
        let window = inside(at, [46, 60], [50, 72]) || inside(at, [80, 86], [84, 98]);
        let floor = y >= 110;
        if floor || (house && !room && !window) { wall } else { Matter::EMPTY }
    });
    cells.set_sky(sky.clone().into());
    cells
}

#[test]
fn an_open_cell_sees_all_columns_and_one_on_a_floor_the_upper_half() {
    let dusk = dusk(0.0);
    let columns = dusk.columns();
    for turn in [0.0, 1.3] {
        let panorama = dusk.clone().turned(turn);
        let mut cells = grid(9, 7, |_, _| Matter::EMPTY);
        cells.set_sky(panorama.clone().into());
        let mean = [0, 1, 2]
            .map(|c| columns.iter().map(|rgb| f64::from(rgb[c])).sum::<f64>() / COLUMNS as f64);
        expect_rgb(&direct(40_000), &cells, [4, 3], mean, POWER);

        let (width, half) = (101, 50.5);
        let mut cells = grid(width, 2, |_, y| if y == 1 { WALL } else { Matter::EMPTY });
        cells.set_sky(panorama.into());
        // From straight down clockwise: the part of the circle that the floor leaves open.
        let low = (0.5f64 / half).atan() / TAU;
        let steps = 100_000;
        let mut open = [0.0; 3];
        for step in 0..steps {
            let part = 0.25 - low + (0.5 + 2.0 * low) * (f64::from(step) + 0.5) / f64::from(steps);
            let place = (part - f64::from(turn) / TAU).rem_euclid(1.0) * COLUMNS as f64 - 0.5;
            let [a, b] = [place.floor(), place.floor() + 1.0]
                .map(|k| columns[k.rem_euclid(COLUMNS as f64) as usize]);
            for c in 0..3 {
                let [a, b] = [a, b].map(|rgb| f64::from(rgb[c]));
                let seen = a + (b - a) * (place - place.floor());
                open[c] += seen * (0.5 + 2.0 * low) / f64::from(steps);
            }
        }
        expect_rgb(&direct(40_000), &cells, [50, 0], open, POWER);
    }
}

/// The largest relative RMSE of a method under a soft sky, and under one with a sun of 3°, which is more than half of its
/// light. Measured: 0.25, 0.15, 0.86, 1.9, 0.86, 0.34 and 0.12 %; with the sun 2.8, 1.5, 5.0, 5.0, 4.9, 3.4 and 0.35 %, at
/// the edges of its shadows.
const METHODS: [(&str, [f64; 2]); 7] = [
    ("holographic", [0.006, 0.035]),
    ("holographic high", [0.004, 0.02]),
    ("holographic fast", [0.01, 0.055]),
    ("holographic paper", [0.03, 0.07]),
    ("cascades", [0.015, 0.06]),
    ("cascades high", [0.008, 0.045]),
    ("raymarch", [0.004, 0.01]),
];

/// The largest relative RMSE of methods with suns in their sky, of 1°, 3° and 20°, which give most of its light.
/// Measured: 0.86, 1.0 and 0.35 %; 0.49, 0.61 and 0.24 %; 3.5, 3.9 and 1.5 %; 7.4, 4.1 and 0.34 %, as rays of `raymarch`
/// meet suns by chance.
const SUNS: [(&str, [f64; 3]); 4] = [
    ("holographic", [0.016, 0.016, 0.006]),
    ("holographic high", [0.01, 0.01, 0.004]),
    ("cascades", [0.055, 0.055, 0.022]),
    ("raymarch", [0.1, 0.06, 0.006]),
];

fn settings(name: &str) -> Settings {
    let method: MethodSettings = match name.split_once(' ') {
        Some(("holographic", preset)) => Holographic::preset(preset).unwrap().into(),
        Some((_, preset)) => Cascades::preset(preset).unwrap().into(),
        None if name == "holographic" => Holographic::default().into(),
        None if name == "cascades" => Cascades::default().into(),
        None => Raymarch { rays: 1024, ..Raymarch::default() }.into(),
    };
    Settings::direct(method)
}

#[test]
fn suns_in_the_sky_light_houses_as_the_path_tracer_says() {
    let mut failed = Vec::new();
    for (i, width) in [1f32, 3.0, 20.0].into_iter().enumerate() {
        let lit = |direction: f32| {
            let mut cells = skyline(&dusk(0.0));
            let angle = width.to_radians();
            let sun = Sun { direction, angle, direct: Direct::Glow, ..Sun::default() };
            cells.suns_mut().push(sun);
            cells
        };
        let cells = lit(0.9);
        let tracer = PathTracer { seed: 5, ..tracer(PATHS, Bounces::Count(0)) };
        let at = open_cells(&cells, LOOKS, 11);
        let truth: Vec<Rgb> = tracer.at(&cells, &at).unwrap().into_iter().map(|(l, _)| l).collect();
        for (name, bounds) in SUNS {
            let error = |cells: &Cells| {
                let mut solver = Solver::new(settings(name)).unwrap();
                let light = solver.solve(cells).unwrap();
                let seen: Vec<Rgb> = at.iter().map(|&[x, y]| light.at(x, y)).collect();
                Measures::of(&seen, &truth, &vec![false; seen.len()]).relative_rmse
            };
            let (own, turned) = (error(&cells), error(&lit(1.0)));
            println!(
                "sun of {width:2}°, {name:16} rmse {:5.2} %; turned: {:5.2} %",
                100.0 * own,
                100.0 * turned
            );
            if own > bounds[i] || turned <= bounds[i] {
                failed.push((width, name));
            }
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}

#[test]
fn every_method_is_right_among_houses_at_dusk() {
    let mut failed = Vec::new();
    for (i, sun) in [0.0, 60.0].into_iter().enumerate() {
        let sky = dusk(sun);
        let cells = skyline(&sky);
        let tracer = PathTracer { seed: 3, ..tracer(PATHS, Bounces::Count(0)) };
        let at = open_cells(&cells, LOOKS, 7);
        let truth: Vec<Rgb> = tracer.at(&cells, &at).unwrap().into_iter().map(|(l, _)| l).collect();
        for (name, bounds) in METHODS {
            let error = |cells: &Cells| {
                let light: Light =
                    Solver::new(settings(name)).unwrap().solve(cells).unwrap().clone();
                let seen: Vec<Rgb> = at.iter().map(|&[x, y]| light.at(x, y)).collect();
                Measures::of(&seen, &truth, &vec![false; seen.len()])
            };
            let own = error(&cells);
            let turned = error(&skyline(&sky.clone().turned(0.3))).relative_rmse;
            println!(
                "sun {sun:2}, {name:18} rmse {:5.2} %  bias {:+5.2} %  p99 {:5.2} %; turned: {:5.2} %",
                100.0 * own.relative_rmse,
                100.0 * own.bias,
                100.0 * own.p99,
                100.0 * turned,
            );
            if own.relative_rmse > bounds[i] || turned <= bounds[i] {
                failed.push((sun, name));
            }
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}
