//! Light that bounces from frame to frame, and until it has converged.

use crate::common::{cells, device};
use crate::compare::{Both, agree, differences};
use crate::frames::{FRAMES, frames_agree, moving};
use lamplight::settings::{BounceBy, Raymarch};
use lamplight::{Bounces, Cells, Matter, Method, Settings, Solver};

fn raymarch(preset: &str, by: BounceBy, bounces: Bounces) -> Settings {
    let mut settings = Settings { method: Method::Raymarch, bounces, ..Settings::default() };
    settings.raymarch = Raymarch::preset(preset).unwrap();
    settings.raymarch.bounce = by;
    settings.raymarch.rays = 16;
    settings
}

#[test]
fn feedback_agrees_frame_by_frame() {
    let gpu = device();
    for [w, h] in [[1, 1], [1, 37], [31, 17], [97, 61]] {
        for preset in Raymarch::PRESETS {
            for (frames, bounces) in [(0, Bounces::Count(1)), (8, Bounces::Converged)] {
                let mut settings = raymarch(preset, BounceBy::Feedback, bounces);
                settings.temporal.frames = frames;
                let name = format!("{preset} at {w}×{h}, mean over {frames}");
                frames_agree(&gpu, &name, settings, (0..FRAMES).map(|n| moving(w, h, n)));
            }
        }
    }
}

#[test]
fn converged_light_agrees() {
    let gpu = device();
    for [w, h] in [[1, 1], [1, 37], [31, 17], [97, 61]] {
        for preset in Raymarch::PRESETS {
            let settings = raymarch(preset, BounceBy::Frame, Bounces::Converged);
            agree(&gpu, &format!("{preset} at {w}×{h}"), &cells(w, h, 7), settings);
        }
    }
    let mut settings = raymarch("default", BounceBy::Frame, Bounces::Converged);
    settings.temporal.frames = 8;
    frames_agree(&gpu, "with a mean", settings, (0..4).map(|n| moving(31, 17, n)));
}

/// A room in which light goes on for a while, with fog.
fn bright_room() -> Cells {
    let mut cells = Cells::new(33, 21).unwrap();
    let wall = Matter { opacity: 1.0, albedo: [0.8, 0.7, 0.6], ..Matter::EMPTY };
    for y in 0..21 {
        for x in 0..33 {
            if x % 32 == 0 || y % 20 == 0 {
                cells.set(x, y, wall);
            } else if x > 20 {
                cells.set(x, y, Matter { opacity: 0.1, albedo: [0.9; 3], ..Matter::EMPTY });
            }
        }
    }
    cells.set(9, 7, Matter { emission: [5.0; 3], ..wall });
    cells
}

#[test]
fn rounds_end_where_the_cpu_ends_them() {
    let cells = bright_room();
    let settings = |bounces| raymarch("default", BounceBy::Frame, bounces);
    let gpu = device();
    let [seen, right] = Both::new(&gpu, settings(Bounces::Converged)).light(&gpu, &cells);
    let worst = |other: &[_]| differences(&seen, other).into_iter().fold(0.0, f64::max);
    let after = |rounds| {
        let mut solver = Solver::new(settings(Bounces::Count(rounds))).unwrap();
        solver.solve(&cells).unwrap().pixels().to_vec()
    };
    let rounds = (1..100).find(|&rounds| after(rounds) == right).unwrap();
    let (here, less, more) = (worst(&right), worst(&after(rounds - 1)), worst(&after(rounds + 1)));
    println!("{rounds} rounds: {here:.1e} off; one less {less:.1e}, one more {more:.1e}");
    assert!(rounds > 10 && 10.0 * here < less.min(more));
}
