//! Suns, in every method: their own light, and what it does where it falls.

use crate::common::{WALL, centre, direct, grid, seeded};
use crate::spots::{SIZE, assert_right, furnished, methods, solve};
use lamplight::settings::MethodSettings;
use lamplight::{Matter, Method, Rgb, Sun};
use std::f32::consts::{PI, TAU};

/// Rounding of 32-bit floats.
const ROUNDING: f32 = 1e-4;

#[test]
fn a_sun_lights_the_open_and_a_wall_that_it_meets_as_by_hand() {
    for angle in [1e-4, 0.02, 0.5] {
        // Down, on a floor.
        let mut cells = grid(24, 16, |_, y| if y < 12 { Matter::EMPTY } else { WALL });
        let sun = Sun { direction: 0.5 * PI, angle, intensity: 2.0, ..Sun::default() };
        cells.suns_mut().push(sun);
        let all: [(&str, MethodSettings); 2] =
            [("polar", Method::Polar.into()), ("flood", Method::Flood.into())];
        for (name, method) in methods().into_iter().chain(all) {
            let light = solve(&method, &cells, 0);
            let mean = 2.0 * angle / (2.0 * (0.5 * angle).sin()) / TAU;
            let (open, floor) = (light.at(9, 5)[1], light.at(9, 12)[1]);
            assert!((open / mean - 1.0).abs() < ROUNDING, "{name}, {angle}: {open}, not {mean}");
            assert!((floor - 1.0).abs() < ROUNDING, "{name}, {angle}: {floor}, not 1");
        }
    }
}

#[test]
fn suns_light_rooms_as_the_path_tracer_does() {
    // Direct light of 30 rooms: with 0.02 rad 0.30 % off at most, with 0.4 rad 0.40 %.
    let random = &mut seeded(1);
    for angle in [0.02, 0.4] {
        // Open above and to the right.
        let mut cells = furnished(random, |[x, y]| x < 4 || y + 4 >= SIZE[1]);
        let direction = PI * (0.3 + 0.4 * random.f32());
        let color: Rgb = [1.0, 0.9, 0.7];
        cells.suns_mut().push(Sun { direction, angle, color, intensity: 5.0, ..Sun::default() });
        assert_right(&cells, &format!("{angle} rad"));
    }
}

/// The largest error of the light on walls, relative to their mean light: three points stand for a face, and steps shade
/// parts of each other. 5.7 % at most.
const ON_WALLS: f64 = 0.07;
/// That of all light on walls: 1.9 % at most.
const ON_ALL_WALLS: f64 = 0.025;

#[test]
fn suns_light_slanted_and_round_walls_as_the_path_tracer_does() {
    let size = [48, 40];
    let slanted = |[x, y]: [f64; 2]| (34.0 * (x - 6.0) + 60.0 * (y - 32.0)).abs() < 160.0;
    let round = |[x, y]: [f64; 2]| (x - 24.0).hypot(y - 20.0) < 9.0;
    type IsWall = fn([f64; 2]) -> bool;
    let shapes: [(_, IsWall); 2] = [("slanted", slanted), ("round", round)];
    for (name, is_wall) in shapes {
        for degrees in [20.0f32, 45.0, 60.0, 65.0, 90.0, 240.0] {
            let mut cells =
                grid(
                    size[0],
                    size[1],
                    |x, y| {
                        if is_wall(centre([x, y])) { WALL } else { Matter::EMPTY }
                    },
                );
            let direction = degrees.to_radians();
            cells.suns_mut().push(Sun { direction, angle: 1e-3, ..Sun::default() });
            let traced = direct(256).render(&cells, &|_| ()).unwrap();
            let truth = traced.light.pixels();
            for (method, settings) in methods() {
                let light = solve(&settings, &cells, 0);
                let walls = || (0..cells.len()).filter(|&i| light.solid()[i]);
                let total = |rgb: &[Rgb]| walls().map(|i| f64::from(rgb[i][1])).sum::<f64>();
                let (found, right) = (total(light.pixels()), total(truth));
                let squares =
                    walls().map(|i| f64::from(light.pixels()[i][1] - truth[i][1]).powi(2));
                let lit = walls().filter(|&i| truth[i][1] > 0.0).count() as f64;
                let rms = (squares.sum::<f64>() / lit).sqrt() / (right / lit);
                let all = found / right - 1.0;
                println!(
                    "{name}, {degrees} degrees, {method}: {:.2} %, {:+.2} %",
                    100.0 * rms,
                    100.0 * all
                );
                assert!(rms < ON_WALLS && all.abs() < ON_ALL_WALLS, "{name}, {degrees}, {method}");
            }
        }
    }
}
