//! Scenes set by hand, and the test of significance.

// Each test program uses its own part of this.
#![allow(dead_code)]

use fastrand::Rng;
use lamplight::{Bounces, Cells, Matter, Rgb, Settings};
use lamplight_truth::PathTracer;

/// A black wall.
pub const WALL: Matter = Matter { opacity: 1.0, ..Matter::EMPTY };
/// A black wall that glows with radiance 1.
pub const GLOW: Matter = Matter { emission: [1.0; 3], ..WALL };

/// Standard errors that an estimate may be off. It has 15 degrees of freedom (16 batches): chance
/// alone goes beyond 7 once in 230,000 (Student's t, two-sided), and seeds are fixed; a few hundred
/// such comparisons in all of this crate's tests fail at random with p < 0.002.
pub const SIGNIFICANT: f64 = 7.0;
/// Rounding of f32, in which light is stored, relative.
pub const ROUNDING: f64 = 1e-6;

pub fn tracer(samples: u32, bounces: Bounces) -> PathTracer {
    PathTracer { samples, bounces, wall_depth: 0.0, elevation: Settings::ELEVATION, seed: 1 }
}

/// Direct light.
pub fn direct(samples: u32) -> PathTracer {
    tracer(samples, Bounces::Count(0))
}

/// A random number generator with this seed, printed so that a failure can be repeated.
pub fn seeded(seed: u64) -> Rng {
    println!("seed {seed}");
    Rng::with_seed(seed)
}

/// A random number generator with a new seed in each run, printed so that a failure can be repeated.
pub fn fresh() -> Rng {
    seeded(fastrand::u64(..))
}

/// A grid whose cells are given by `matter`.
pub fn grid(width: u32, height: u32, mut matter: impl FnMut(u32, u32) -> Matter) -> Cells {
    let mut cells = Cells::new(width, height).unwrap();
    for y in 0..height {
        for x in 0..width {
            cells.set(x, y, matter(x, y));
        }
    }
    cells
}

/// Returns true if a cell lies in the box from `min` to before `max`.
pub fn inside([x, y]: [u32; 2], min: [u32; 2], max: [u32; 2]) -> bool {
    (min[0]..max[0]).contains(&x) && (min[1]..max[1]).contains(&y)
}

pub fn centre(cell: [u32; 2]) -> [f64; 2] {
    cell.map(|v| f64::from(v) + 0.5)
}

/// Judges if an estimate (mean, standard error) is the expected value and precise enough: the test
/// would have failed for relative errors of more than `power`. The
/// standard error is taken to be at least one path of `samples` that sees radiance 1: evenly spaced
/// directions may count the same number of hits in all batches. Black has to be black.
pub fn judge(
    (mean, error): (Rgb, Rgb),
    samples: u32,
    expected: [f64; 3],
    power: f64,
) -> Result<(), String> {
    for c in 0..3 {
        let (mean, expected) = (f64::from(mean[c]), expected[c]);
        let error = f64::from(error[c]).max(1.0 / f64::from(samples));
        let bound = if expected == 0.0 { 0.0 } else { SIGNIFICANT * error + ROUNDING * expected };
        if bound > power * expected {
            return Err(format!("channel {c}: {mean} ± {error} is too vague for {expected}"));
        }
        if (mean - expected).abs() > bound {
            return Err(format!("channel {c}: {mean} ± {error} is not {expected}"));
        }
    }
    Ok(())
}

/// Judges one cell, grey.
#[track_caller]
pub fn expect(tracer: &PathTracer, cells: &Cells, at: [u32; 2], expected: f64, power: f64) {
    expect_rgb(tracer, cells, at, [expected; 3], power);
}

/// Judges one cell.
#[track_caller]
pub fn expect_rgb(
    tracer: &PathTracer,
    cells: &Cells,
    at: [u32; 2],
    expected: [f64; 3],
    power: f64,
) {
    let estimate = tracer.at(cells, &[at]).unwrap()[0];
    if let Err(problem) = judge(estimate, tracer.samples, expected, power) {
        panic!("cell {at:?}, seed {}, {:?}: {problem}", tracer.seed, tracer.bounces);
    }
}

/// Simpson's rule with 2000 panels.
pub fn integral(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    let h = (to - from) / 2000.0;
    let inner: f64 =
        (1..2000).map(|i| f(from + f64::from(i) * h) * if i % 2 == 1 { 4.0 } else { 2.0 }).sum();
    (f(from) + inner + f(to)) * h / 3.0
}
