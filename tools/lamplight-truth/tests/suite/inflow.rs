//! Light from the world around a grid: a window of a world, alone.

use crate::common::*;
use lamplight::settings::{Holographic, Raymarch};
use lamplight::{Bounces, Cells, GridWindow, Matter, Method, Rgb, Settings, Solver};
use lamplight_truth::{Measures, scenes};

const WORLD: [u32; 2] = [200, 150];
const WINDOW: GridWindow = GridWindow { first: [60, 45], size: [80, 60] };
/// Directions of the inflow.
const COLUMNS: usize = 512;
/// Largest errors of the light of the window alone against that in its world: direct light, and all bounces, which
/// enter as `high` found them.
const ALONE: [(Bounces, f64); 2] = [(Bounces::Count(0), 0.01), (Bounces::Converged, 0.015)];

/// Lights, walls and fog around the window and in it.
fn world() -> Cells {
    let glow = |emission| Matter { emission, ..WALL };
    let wall = Matter { albedo: [0.8, 0.6, 0.4], ..WALL };
    let fog = Matter { opacity: 0.02, albedo: [0.7; 3], ..Matter::EMPTY };
    let discs = [
        ([130.0, 95.0], 14.0, fog),
        ([30.0, 40.0], 8.0, glow([4.0, 2.0, 1.0])),
        ([170.0, 30.0], 6.0, glow([1.0, 3.0, 2.0])),
        ([110.0, 130.0], 7.0, glow([1.0, 1.5, 4.0])),
        ([80.0, 70.0], 4.0, wall),
        ([115.0, 80.0], 5.0, wall),
        ([45.0, 62.0], 3.0, wall),
        ([165.0, 100.0], 20.0, wall),
    ];
    grid(WORLD[0], WORLD[1], |x, y| {
        let holds = |[cx, cy]: [f32; 2], radius: f32| {
            (x as f32 + 0.5 - cx).hypot(y as f32 + 0.5 - cy) < radius
        };
        let disc = discs.iter().rev().find(|(at, radius, _)| holds(*at, *radius));
        disc.map_or(Matter::EMPTY, |(_, _, matter)| *matter)
    })
}

fn light_of(cells: &Cells, bounces: Bounces, at: &[[u32; 2]]) -> Vec<Rgb> {
    let traced = tracer(16_384, bounces).at(cells, at).unwrap();
    traced.into_iter().map(|(mean, _)| mean).collect()
}

fn error(found: &[Rgb], truth: &[Rgb]) -> f64 {
    Measures::of(found, truth, &vec![false; truth.len()]).relative_rmse
}

#[test]
fn a_window_alone_has_the_light_of_its_world() {
    let world = world();
    let [w, h] = WINDOW.size;
    let mut alone = grid(w, h, |x, y| world.get(WINDOW.first[0] + x, WINDOW.first[1] + y).unwrap());
    let at = scenes::open_cells(&alone, 300, 5);
    let in_world: Vec<_> =
        at.iter().map(|&[x, y]| [WINDOW.first[0] + x, WINDOW.first[1] + y]).collect();
    for (bounces, bound) in ALONE {
        let truth = light_of(&world, bounces, &in_world);
        let high = Settings { bounces, ..Settings::direct(Holographic::preset("high").unwrap()) };
        let mut solver = Solver::new(high).unwrap();
        solver.solve(&world).unwrap();
        alone.set_inflow(None).unwrap();
        let dark = light_of(&alone, bounces, &at);
        assert!(error(&dark, &truth) > 0.5, "light without inflow passes");
        alone.set_inflow(Some(solver.inflow(WINDOW, COLUMNS).unwrap())).unwrap();
        let traced = light_of(&alone, bounces, &at);
        let found = error(&traced, &truth);
        println!("path tracer, {bounces:?}: {:.2} %", 100.0 * found);
        assert!(found < bound, "{bounces:?}: {found}");
        let rays = Raymarch { rays: 1024, ..Raymarch::default() };
        for (name, settings, bound) in [
            ("holographic", Settings::direct(Method::Holographic), 0.02),
            // Its probes smear light that comes from one direction, as they do with narrow suns.
            ("cascades", Settings::direct(Method::Cascades), 0.06),
            ("raymarch", Settings::direct(rays), 0.04),
        ] {
            let settings = Settings { bounces, ..settings };
            let mut solver = Solver::new(settings).unwrap();
            let light = solver.solve(&alone).unwrap();
            let seen: Vec<Rgb> = at.iter().map(|&[x, y]| light.at(x, y)).collect();
            let found = error(&seen, &traced);
            println!("{name}, {bounces:?}: {:.2} %", 100.0 * found);
            assert!(found < bound, "{name}, {bounces:?}: {found}");
        }
    }
}
