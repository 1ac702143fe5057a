//! Invariants of every scene.

use crate::common::*;
use lamplight::{Bounces, Cells, Error, Lamp, Matter, Rgb, Sky};
use lamplight_truth::{Estimate, Measures, PathTracer, Received};
use std::sync::Mutex;

/// Walls, fog, glass and lights, in no order; 1 of 3 cells holds something.
fn jumble(width: u32, height: u32) -> Cells {
    let mut generator = seeded(12345);
    let mut random = || generator.f32();
    let mut cells = Cells::new(width, height).unwrap();
    for i in 0..cells.len() {
        let glow = if random() < 0.3 { [random(), random(), 3.0 * random()] } else { [0.0; 3] };
        let albedo = [random(), 0.5, 0.9 * random()];
        let tint = [1.0, random(), 0.5 + 0.5 * random()];
        let kind = random();
        cells.set_matter(
            i,
            match kind {
                k if k < 0.15 => Matter { emission: glow, opacity: 1.0, albedo, ..Matter::EMPTY },
                k if k < 0.25 => {
                    Matter { emission: glow, opacity: random(), albedo, tint, ..Matter::EMPTY }
                }
                k if k < 0.3 => Matter { tint, ..Matter::EMPTY },
                _ => Matter::EMPTY,
            },
        );
    }
    cells.set_sky(Sky::Uniform([0.1, 0.05, 0.2]));
    cells
}

fn render(tracer: &PathTracer, cells: &Cells) -> Estimate {
    tracer.render(cells, &|_| ()).unwrap()
}

/// Returns the grid with other emission and sky.
fn relit(cells: &Cells, emission: impl Fn(usize, Rgb) -> Rgb, sky: Rgb) -> Cells {
    let mut cells = cells.clone();
    for (i, e) in cells.emission_mut().iter_mut().enumerate() {
        *e = emission(i, *e);
    }
    cells.set_sky(Sky::Uniform(sky));
    cells
}

const TWO: Bounces = Bounces::Count(2);

#[test]
fn turning_the_scene_turns_the_light() {
    let cells = jumble(19, 14);
    // A quarter turn to the right: what was at (x, y) comes to (height − 1 − y, x).
    let mut turned = Cells::new(14, 19).unwrap();
    turned.set_sky(cells.sky().clone());
    for y in 0..14 {
        for x in 0..19 {
            turned.set(13 - y, x, cells.get(x, y).unwrap());
        }
    }
    let tracer = tracer(8000, TWO);
    let (a, b) = (render(&tracer, &cells), render(&tracer, &turned));
    let mut sure = 0;
    for y in 0..14 {
        for x in 0..19 {
            let (i, j) = (cells.index(x, y), turned.index(13 - y, x));
            for c in 0..3 {
                let (p, q) = (a.light.pixels()[i][c], b.light.pixels()[j][c]);
                let error = a.standard_error[i][c].hypot(b.standard_error[j][c]);
                let bound = SIGNIFICANT as f32 * error + ROUNDING as f32 * p;
                assert!((p - q).abs() <= bound, "{x}, {y}, channel {c}: {p}, {q} ± {error}");
                sure += usize::from(bound < 0.2 * p);
            }
        }
    }
    assert!(sure > 500, "only {sure} of 798 values are known well");
    // The opposite rotation would not have passed.
    let (p, q) = (a.light.at(2, 3), b.light.at(2, 3));
    assert_ne!(p, q);
}

/// Sums of thousands of f64 in another order of magnitude, stored as f32.
const SUMS: f32 = 1e-5;

#[test]
fn light_is_linear_in_emission() {
    let cells = jumble(19, 14);
    let tracer = tracer(160, TWO);
    let all = render(&tracer, &cells).light;
    let even =
        render(&tracer, &relit(&cells, |i, e| if i % 2 == 0 { e } else { [0.0; 3] }, [0.0; 3]));
    let odd = render(
        &tracer,
        &relit(&cells, |i, e| if i % 2 == 1 { e } else { [0.0; 3] }, [0.1, 0.05, 0.2]),
    );
    let tripled = render(
        &tracer,
        &relit(&cells, |_, e| e.map(|v| 3.0 * v), [0.1, 0.05, 0.2].map(|v| 3.0 * v)),
    );
    for i in 0..cells.len() {
        for c in 0..3 {
            let v = all.pixels()[i][c];
            let sum = even.light.pixels()[i][c] + odd.light.pixels()[i][c];
            assert!((sum - v).abs() <= SUMS * v, "cell {i}: {sum} is not {v}");
            let tripled = tripled.light.pixels()[i][c];
            assert!((tripled - 3.0 * v).abs() <= SUMS * 3.0 * v, "cell {i}: {tripled}, 3 × {v}");
        }
    }
}

#[test]
fn more_emission_never_darkens() {
    let cells = jumble(19, 14);
    let tracer = tracer(160, TWO);
    let before = render(&tracer, &cells).light;
    let mut brighter = 0;
    for raised in [10, 100, 200] {
        let after = relit(
            &cells,
            |i, e| if i == raised { e.map(|v| v + 2.0) } else { e },
            [0.1, 0.05, 0.2],
        );
        let after = render(&tracer, &after).light;
        for (a, b) in after.pixels().iter().zip(before.pixels()) {
            for c in 0..3 {
                assert!(a[c] >= b[c] * (1.0 - SUMS), "{a:?} is darker than {b:?}");
                brighter += usize::from(a[c] > b[c]);
            }
        }
    }
    assert!(brighter > 50, "only {brighter} values changed");
}

/// A diamond of walls that touch by their corners only, in a bright world.
fn diamond(gap: bool) -> Cells {
    let mut cells = grid(31, 31, |x, y| {
        let d = x.abs_diff(15) + y.abs_diff(15);
        match d {
            8 if !(gap && x == 23) => Matter { albedo: [0.5; 3], ..WALL },
            _ if d > 8 => {
                Matter { emission: [5.0; 3], opacity: 0.1, albedo: [0.5; 3], ..Matter::EMPTY }
            }
            _ => Matter { opacity: 0.05, albedo: [0.9; 3], ..Matter::EMPTY },
        }
    });
    cells.set_sky(Sky::Uniform([10.0; 3]));
    cells
}

#[test]
fn a_sealed_room_is_exactly_dark() {
    let tracer = tracer(320, Bounces::Converged);
    for (cells, lit) in [(diamond(false), false), (diamond(true), true)] {
        let light = render(&tracer, &cells).light;
        let mut some = false;
        for y in 0..31u32 {
            for x in 0..31u32 {
                if x.abs_diff(15) + y.abs_diff(15) < 8 {
                    some |= light.at(x, y) != [0.0; 3];
                }
            }
        }
        assert_eq!(some, lit, "one missing wall makes the difference");
    }
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let cells = jumble(37, 11);
    let tracer = PathTracer { wall_depth: 2.0, ..tracer(64, Bounces::Converged) };
    let bytes = |threads: usize, tracer: &PathTracer| -> Vec<u32> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let light = pool.install(|| render(tracer, &cells)).light;
        light.pixels().iter().flatten().map(|v| v.to_bits()).collect()
    };
    let one = bytes(1, &tracer);
    assert_eq!(one, bytes(2, &tracer));
    assert_eq!(one, bytes(3, &tracer));
    assert_ne!(one, bytes(2, &PathTracer { seed: 2, ..tracer }));
    // A few cells are the same cells.
    let all = render(&tracer, &cells);
    let open = (0..cells.len()).filter(|&i| !cells.is_solid(i)).step_by(5);
    for i in open {
        let at = [i as u32 % 37, i as u32 / 37];
        let here = tracer.at(&cells, &[at]).unwrap()[0];
        assert_eq!(here, (all.light.pixels()[i], all.standard_error[i]));
    }
}

#[test]
fn parts_of_any_size_have_the_bytes_of_the_whole() {
    let mut generator = fresh();
    let mut cells = jumble(37, 11);
    cells.lamps_mut().push(Lamp { position: [9.5, 5.5], ..Lamp::default() });
    let tracer = PathTracer { wall_depth: 2.0, ..tracer(32, Bounces::Count(1)) };
    let whole = render(&tracer, &cells);
    let parts = |mut size: Box<dyn FnMut() -> usize>, tracer: PathTracer| {
        let mut received = Received::default();
        while received.rgb.len() < cells.len() {
            let first = received.rgb.len();
            // Prepared anew, as elsewhere.
            let tracing = tracer.prepare(&cells).unwrap();
            received.append(tracing.trace(first..first + size(), &|_| ()));
        }
        tracer.prepare(&cells).unwrap().finish(received).unwrap()
    };
    for _ in 0..3 {
        let mut generator = generator.fork();
        let joined = parts(Box::new(move || generator.usize(1..200)), tracer);
        assert_eq!(joined.light, whole.light);
        assert_eq!(joined.standard_error, whole.standard_error);
    }
    let other = parts(Box::new(|| 100), PathTracer { seed: 2, ..tracer });
    assert_ne!(other.light, whole.light);
    let tracing = tracer.prepare(&cells).unwrap();
    let one_too_few = tracing.trace(1..cells.len() + 9, &|_| ());
    let error = tracing.finish(one_too_few).unwrap_err().to_string();
    assert!(error.contains("406") && error.contains("407"), "{error}");
}

#[test]
fn the_standard_error_is_the_spread_over_seeds() {
    // z = (mean − mean over seeds)/error has variance 1 · 15/13 for 15 degrees of freedom; over
    // 24 seeds × 3 channels × 10 cells its mean square lies within 0.8 and 1.6.
    let cells = jumble(19, 14);
    let open: Vec<[u32; 2]> = (0..cells.len())
        .filter(|&i| !cells.is_solid(i))
        .step_by(20)
        .take(10)
        .map(|i| [i as u32 % 19, i as u32 / 19])
        .collect();
    let runs: Vec<Vec<(Rgb, Rgb)>> = (0..24)
        .map(|seed| PathTracer { seed, ..tracer(3200, TWO) }.at(&cells, &open).unwrap())
        .collect();
    let (mut sum, mut n) = (0.0f64, 0.0);
    for cell in 0..open.len() {
        for c in 0..3 {
            let mean = runs.iter().map(|r| f64::from(r[cell].0[c])).sum::<f64>() / 24.0;
            for run in &runs {
                let (m, e) = (f64::from(run[cell].0[c]), f64::from(run[cell].1[c]));
                sum += ((m - mean) / e).powi(2) * 24.0 / 23.0;
                n += 1.0;
            }
        }
    }
    let spread = sum / n;
    assert!((0.8..1.6).contains(&spread), "{spread}");
}

#[test]
fn more_samples_reduce_the_error() {
    let cells = jumble(19, 14);
    let truth = render(&PathTracer { seed: 9, ..tracer(16_000, TWO) }, &cells).light;
    let off = |samples| {
        let light = render(&tracer(samples, TWO), &cells).light;
        Measures::of(light.pixels(), truth.pixels(), truth.solid()).relative_rmse
    };
    let (few, many) = (off(64), off(64 * 16));
    // 16 times the samples: a quarter of the error or less, give or take the noise of both.
    assert!(many < 0.35 * few, "{few} to {many}");
}

#[test]
fn walls_show_their_irradiance_and_emission() {
    let mut cells = grid(9, 9, |x, y| {
        if inside([x, y], [2, 2], [7, 7]) {
            Matter { emission: [0.0, 0.25, 0.0], ..WALL }
        } else {
            Matter::EMPTY
        }
    });
    cells.set_sky(Sky::Uniform([0.5; 3]));
    let light = render(&direct(160), &cells).light;
    assert_eq!(light.at(4, 2), [0.5, 0.75, 0.5]);
    assert_eq!(light.at(4, 4), [0.0, 0.25, 0.0]);
    let light = render(&PathTracer { wall_depth: 4.0, ..direct(160) }, &cells).light;
    assert!(light.at(4, 4)[0] > 0.0 && light.at(4, 4)[0] < 0.5);
}

#[test]
fn progress_reaches_one() {
    let seen = Mutex::new(Vec::new());
    let cells = jumble(37, 11);
    direct(16).render(&cells, &|share| seen.lock().unwrap().push(share)).unwrap();
    let seen = seen.into_inner().unwrap();
    assert!(seen.len() > 1 && seen.iter().all(|s| (0.0..=1.0).contains(s)));
    assert!(seen.contains(&1.0));
}

#[test]
fn invalid_cells_are_rejected() {
    let mut cells = jumble(5, 4);
    let none = direct(0).render(&cells, &|_| ()).unwrap_err();
    assert_eq!(none.to_string(), "`samples` is 0, but must be 1 or more");
    let outside = direct(16).at(&cells, &[[0, 0], [5, 0]]).unwrap_err();
    assert_eq!(outside.to_string(), "`at` is [5, 0], but must be a cell of the 5×4 grid");
    cells.opacity_mut()[7] = f32::NAN;
    for error in
        [direct(16).render(&cells, &|_| ()).unwrap_err(), direct(16).at(&cells, &[]).unwrap_err()]
    {
        assert!(matches!(error, Error::Cell { x: 2, y: 1, field: "opacity", .. }), "{error}");
    }
}

#[test]
fn the_smallest_and_thinnest_grids() {
    for (width, height) in [(1, 1), (1, 50), (50, 1)] {
        for matter in [Matter::EMPTY, WALL, Matter { opacity: 0.5, ..Matter::EMPTY }] {
            let mut cells = grid(width, height, |_, _| matter);
            cells.set_sky(Sky::Uniform([1.0; 3]));
            let light = render(&direct(160), &cells).light;
            let end = light.at(0, 0)[0];
            let right = match matter.opacity {
                0.0 => end == 1.0,
                1.0 => end == 0.0,
                _ => end > 0.0 && end < 0.8,
            };
            assert!(right, "{width}×{height}, {matter:?}: {end}");
        }
    }
}
