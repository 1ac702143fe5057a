//! The blur takes grain away, all over the picture.

mod common;

use common::{GLOW, grid};
use lamplight::{Light, Matter, Settings, Solver, settings};

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
    let solve = |passes| {
        let mut settings = Settings {
            denoise: settings::Denoise { passes, strength: 1.0 },
            ..Settings::default()
        };
        settings.raymarch.rays = 32;
        grain(Solver::new(settings).unwrap().solve(&cells).unwrap(), lights)
    };
    let (raw, blurred) = (solve(0), solve(4));
    println!("grain {raw:.2} before, {blurred:.2} after");
    assert!(blurred < SMOOTH);
    assert!(raw > SMOOTH, "what is measured is there without the blur");
}
