//! The reference that refines goes where the one of many samples is.

use lamplight::{Bounces, Cells, Light, Matter, Settings};
use lamplight_truth::{Measures, PathTracer, ProgressiveReference};

fn tracer(samples: u32) -> PathTracer {
    PathTracer {
        samples,
        bounces: Bounces::Count(1),
        wall_depth: 2.0,
        elevation: Settings::ELEVATION,
        seed: 7,
    }
}

/// A small room with a light, a pillar and fog.
fn room() -> Cells {
    let mut cells = Cells::new(40, 30).unwrap();
    for (x, y) in (0..30).flat_map(|y| (0..40).map(move |x| (x, y))) {
        let wall = Matter { opacity: 1.0, albedo: [0.6, 0.5, 0.4], ..Matter::default() };
        let edge = x == 0 || y == 0 || x == 39 || y == 29;
        let light = Matter { opacity: 1.0, emission: [4.0, 3.0, 2.0], ..Matter::default() };
        match (x, y) {
            _ if edge || (18..21).contains(&x) && (10..20).contains(&y) => cells.set(x, y, wall),
            (8..12, 8..12) => cells.set(x, y, light),
            (25..35, 5..10) => {
                cells.set(x, y, Matter { opacity: 0.1, albedo: [0.5; 3], ..Matter::default() });
            }
            _ => {}
        }
    }
    cells
}

/// Passes in calls of `calls_of` cells each.
fn refined(cells: &Cells, passes: u32, calls_of: usize) -> ProgressiveReference {
    let mut refining = ProgressiveReference::new(tracer(1), cells).unwrap();
    while refining.passes() < passes {
        refining.refine(calls_of);
    }
    refining
}

fn error(refining: &ProgressiveReference, truth: &Light) -> f64 {
    let light = refining.light().unwrap();
    Measures::of(light.pixels(), truth.pixels(), truth.solid()).relative_rmse
}

#[test]
fn the_error_falls_with_passes() {
    let cells = room();
    let truth = tracer(16384).render(&cells, &|_| ()).unwrap().light;
    let errors = [1, 4, 16, 64].map(|passes| error(&refined(&cells, passes, 10_000), &truth));
    println!("{errors:?}");
    // Fourfold the paths halve the error at least; a light that has another number of bounces stays off.
    assert!(errors.windows(2).all(|two| two[1] < 0.65 * two[0]), "{errors:?}");
    let direct = PathTracer { bounces: Bounces::Count(0), ..tracer(1) };
    let mut other = ProgressiveReference::new(direct, &cells).unwrap();
    (0..64).for_each(|_| other.refine(usize::MAX / 2));
    let off = error(&other, &truth);
    assert!(off > 4.0 * errors[3], "{off} and {errors:?}");
}

#[test]
fn the_division_into_calls_makes_no_difference() {
    let cells = room();
    let whole = refined(&cells, 2, cells.len());
    let mut pieces = refined(&cells, 2, 999);
    assert_eq!(whole.light(), pieces.light());
    // Some cells of the next pass are reported at once.
    pieces.refine(500);
    assert_ne!(whole.light(), pieces.light());
    assert!(ProgressiveReference::new(tracer(1), &cells).unwrap().light().is_none());
}
