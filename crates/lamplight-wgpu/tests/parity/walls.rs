//! The light that solid cells show.

use crate::common::{cells, device, frame, lighting};
use crate::compare::{SIZES, differences, wrong};
use lamplight::settings::Raymarch;
use lamplight::{Cells, Matter, Rgb, Settings, Sky, Solver};

/// Large blocks of rock, with seams that glow.
fn rock(width: u32, height: u32, seed: u64) -> Cells {
    let mut cells = cells(width, height, seed);
    for y in (height / 3)..height {
        for x in (width / 4)..width {
            let glows = (x * 7 + y * 13) % 61 == 0;
            let emission = if glows { [2.0, 1.0, 0.5] } else { [0.0; 3] };
            cells.set(x, y, Matter { emission, opacity: 1.0, ..Matter::EMPTY });
        }
    }
    cells.set_sky(Sky::Uniform([0.4, 0.2, 0.1]));
    cells
}

#[test]
fn walls_agree_at_any_depth_and_size() {
    let (device, queue) = device();
    for depth in [0.0, 0.5, 3.0, 20.0, 64.0] {
        let settings = Settings {
            wall_depth: depth,
            ..Settings::direct(Raymarch { rays: 4, ..Raymarch::default() })
        };
        let mut lighting = lighting(&device, &queue);
        let mut solver = Solver::new(settings.clone()).unwrap();
        for [width, height] in SIZES.into_iter().filter(|size| size[0] < 500) {
            let cells = rock(width, height, 23);
            let in_walls = |light: &[Rgb]| -> Vec<Rgb> {
                (0..cells.len()).filter(|&i| cells.is_solid(i)).map(|i| light[i]).collect()
            };
            let seen = frame(&device, &queue, &mut lighting, &settings, &cells);
            let seen: Vec<Rgb> = seen.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
            let right = in_walls(solver.solve(&cells).unwrap().pixels());
            let seen = in_walls(&seen);
            let worst = differences(&seen, &right).into_iter().fold(0.0, f64::max);
            println!("{depth} px at {width}×{height}: {worst:.1e}");
            assert_eq!(wrong(&seen, &right), 0, "{depth} px at {width}×{height}");
        }
    }
}

#[test]
fn another_depth_differs() {
    let (device, queue) = device();
    let [shallow, deep] = [8.0, 8.1].map(|wall_depth| Settings {
        wall_depth,
        ..Settings::direct(Raymarch { rays: 4, ..Raymarch::default() })
    });
    let cells = rock(97, 61, 23);
    let seen = frame(&device, &queue, &mut lighting(&device, &queue), &shallow, &cells);
    let seen: Vec<Rgb> = seen.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
    let mut solver = Solver::new(deep).unwrap();
    assert!(wrong(&seen, solver.solve(&cells).unwrap().pixels()) > 100);
}
