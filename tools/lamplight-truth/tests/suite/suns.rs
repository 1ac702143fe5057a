//! Suns, in every method: their own light, and what it does where it falls.

use crate::common::{WALL, grid, seeded};
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
