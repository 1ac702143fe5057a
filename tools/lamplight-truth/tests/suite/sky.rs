//! Panoramas: the reference held to closed forms, and the methods held to the reference.

use crate::common::{WALL, direct, expect_rgb, grid, inside, seeded};
use lamplight::settings::{Cascades, Holographic, MethodSettings, Raymarch};
use lamplight::{Bounces, Cells, Light, Matter, Panorama, Rgb, Settings, Solver};
use lamplight_truth::scenes::open_cells;
use lamplight_truth::{Measures, PathTracer};
use std::f64::consts::TAU;

/// Relative precision of the comparison with closed forms.
const POWER: f64 = 0.05;
/// Columns of the strip below: 3° each.
const COLUMNS: usize = 120;
/// Open cells looked at, and paths of the reference per cell.
const LOOKS: usize = 1000;
const PATHS: u32 = 32_768;

/// A dusk: warm on the left, blue on the right and above, dark below; and a sun of one column at the upper left.
fn dusk() -> Panorama {
    let column = |k: usize| -> Rgb {
        // 0 straight down, a quarter on the left, a half above.
        let turn = (k as f32 + 0.5) / COLUMNS as f32;
        let near = |at: f32, width: f32| (1.0 - (turn - at).abs() / width).max(0.0);
        let [warm, blue] = [near(0.25, 0.15), near(0.6, 0.35)];
        let sun = if k == 37 { 60.0 } else { 0.0 };
        [
            1.5 * warm + 0.1 * blue + sun,
            0.6 * warm + 0.2 * blue + 0.8 * sun,
            0.2 * warm + 0.6 * blue + 0.5 * sun,
        ]
    };
    Panorama::new(&(0..COLUMNS).map(column).collect::<Vec<_>>()).unwrap()
}

/// Houses on a floor, with windows and an arcade.
fn skyline() -> Cells {
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
    cells.set_sky(dusk().into());
    cells
}

#[test]
fn an_open_cell_sees_all_columns_and_one_on_a_floor_the_upper_half() {
    // Without the sun, whose few paths would be the noise.
    let columns: Vec<Rgb> =
        dusk().columns().iter().map(|rgb| if rgb[0] > 10.0 { [0.5; 3] } else { *rgb }).collect();
    for turn in [0.0, 1.3] {
        let panorama = Panorama::new(&columns).unwrap().turned(turn);
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

/// The error of a method, and that under a sky that is turned by a degree.
fn errors(
    name: &str,
    cells: &Cells,
    settings: impl Into<MethodSettings>,
    truth: &[Rgb],
) -> [f64; 2] {
    let at = open_cells(cells, LOOKS, 7);
    let settings = Settings::direct(settings.into());
    let judge = |cells: &Cells| {
        let light: Light = Solver::new(settings.clone()).unwrap().solve(cells).unwrap().clone();
        let seen: Vec<Rgb> = at.iter().map(|&[x, y]| light.at(x, y)).collect();
        Measures::of(&seen, truth, &vec![false; seen.len()])
    };
    let mut turned = cells.clone();
    turned.set_sky(dusk().turned(0.1).into());
    let (own, other) = (judge(cells), judge(&turned));
    println!(
        "{name:20} rmse {:5.2} %  bias {:+5.2} %  p99 {:5.2} %; turned by 6°: rmse {:5.2} %",
        100.0 * own.relative_rmse,
        100.0 * own.bias,
        100.0 * own.p99,
        100.0 * other.relative_rmse,
    );
    [own.relative_rmse, other.relative_rmse]
}

#[test]
fn every_method_is_right_among_houses_at_dusk() {
    seeded(7);
    let cells = skyline();
    let tracer =
        PathTracer { samples: PATHS, bounces: Bounces::Count(0), wall_depth: 0.0, seed: 3 };
    let at = open_cells(&cells, LOOKS, 7);
    let (truth, own): (Vec<Rgb>, Vec<Rgb>) = tracer.at(&cells, &at).unwrap().into_iter().unzip();
    let square = |v: &[Rgb]| v.as_flattened().iter().map(|v| f64::from(v * v)).sum::<f64>();
    let mean = truth.as_flattened().iter().map(|&v| f64::from(v)).sum::<f64>() / (3 * LOOKS) as f64;
    println!(
        "the reference's own {:.2} %",
        100.0 * (square(&own) / (3 * LOOKS) as f64).sqrt() / mean
    );
    let holographic = |preset| Holographic::preset(preset).unwrap().into();
    let many = Raymarch { rays: 1024, ..Raymarch::default() };
    let methods: [(&str, MethodSettings, f64); 7] = [
        ("holographic", holographic("default"), 0.02),
        ("high holographic", holographic("high"), 0.02),
        ("fast holographic", holographic("fast"), 0.03),
        ("paper", holographic("paper"), 0.1),
        ("cascades", Cascades::default().into(), 0.04),
        ("high cascades", Cascades::preset("high").unwrap().into(), 0.025),
        ("raymarch", many.into(), 0.02),
    ];
    let mut failed = Vec::new();
    for (name, settings, bound) in methods {
        let [error, turned] = errors(name, &cells, settings, &truth);
        if error > bound || turned <= bound {
            failed.push(name);
        }
    }
    assert!(failed.is_empty(), "{failed:?}");
}
