//! Inflow: equal to the sky where it is one, and to the world around a grid that is cut out of it.

use crate::common::*;
use lamplight::settings::{Cascades, Holographic, Raymarch};
use lamplight::{Bounces, Cells, GridWindow, Inflow, Light, Matter, Rgb, Settings, Sky, Solver};

/// Sums of some thousand f32, relative.
const ROUNDING: f64 = 1e-5;
/// Rays of `cascades` from beyond the border see the matter of the grid under a sky, and only inflow with one.
const FROM_OUTSIDE: f64 = 5e-3;

/// The methods that read inflow.
fn methods() -> Vec<(&'static str, Settings)> {
    let mut all = vec![
        ("raymarch", Settings::direct(unfiltered(Raymarch { rays: 256, ..Raymarch::default() }))),
        ("cascades", Settings::direct(Cascades::default())),
    ];
    for preset in ["default", "fast", "coarse", "high"] {
        all.push((preset, Settings::direct(Holographic::preset(preset).unwrap())));
    }
    all
}

fn solve(settings: &Settings, cells: &Cells) -> Light {
    Solver::new(settings.clone()).unwrap().solve(cells).unwrap().clone()
}

/// Walls, glass and fog at random.
fn scene([width, height]: [u32; 2]) -> Cells {
    let mut random = seeded(11);
    let mut cells = Cells::new(width, height).unwrap();
    for _ in 0..width * height / 200 {
        let [x, y] = [random.u32(0..width), random.u32(0..height)];
        let matter = match random.u32(0..3) {
            0 => Matter { opacity: 1.0, emission: [0.2, 0.1, 0.0], ..Matter::EMPTY },
            1 => Matter { opacity: 0.1, tint: [0.9, 0.6, 0.8], ..Matter::EMPTY },
            _ => Matter { opacity: 1.0, ..Matter::EMPTY },
        };
        for (x, y) in
            (x..width.min(x + 4)).flat_map(|x| (y..height.min(y + 3)).map(move |y| (x, y)))
        {
            cells.set(x, y, matter);
        }
    }
    cells
}

/// Root mean square difference over open cells, relative to the mean.
fn error(light: &Light, truth: &[Rgb]) -> f64 {
    let open = light.pixels().iter().zip(truth).zip(light.solid()).filter(|(_, solid)| !**solid);
    let (mut squares, mut sum) = (0.0, 0.0);
    for ((found, truth), _) in open {
        for c in 0..3 {
            squares += f64::from(found[c] - truth[c]).powi(2);
            sum += f64::from(truth[c]);
        }
    }
    let count = 3.0 * light.solid().iter().filter(|solid| !**solid).count() as f64;
    (squares / count).sqrt() / (sum / count)
}

#[test]
fn a_uniform_inflow_is_a_uniform_sky() {
    let rgb = [0.3, 0.5, 1.0];
    for size in [[97, 61], [64, 64], [33, 120]] {
        let mut cells = scene(size);
        for (name, settings) in methods() {
            cells.set_inflow(None).unwrap();
            cells.set_sky(Sky::Uniform(rgb));
            let sky = solve(&settings, &cells);
            cells.set_sky(Sky::BLACK);
            cells.set_inflow(Some(Inflow::new(size, 16, |_, _| rgb).unwrap())).unwrap();
            let inflow = solve(&settings, &cells);
            let found = error(&inflow, sky.pixels());
            println!("{size:?}, {name}: {found:e}");
            let bound = if name == "cascades" { FROM_OUTSIDE } else { ROUNDING };
            assert!(found < bound, "{size:?}, {name}: {found}");
        }
    }
}

#[test]
fn a_solver_with_other_settings_reads_the_inflow_anew() {
    let size = [97, 61];
    let radiance = |angle: f64| [angle.cos(), angle.sin(), 1.0].map(|v| v as f32 + 1.0);
    let mut cells = scene(size);
    cells.set_inflow(Some(Inflow::new(size, 64, |_, angle| radiance(angle)).unwrap())).unwrap();
    let of_level =
        |gather_level| Settings::direct(Holographic { gather_level, ..Holographic::default() });
    let mut kept = Solver::new(of_level(1)).unwrap();
    for level in [2, 4, 1] {
        kept.solve(&cells).unwrap();
        kept.set_settings(of_level(level)).unwrap();
        assert_eq!(bits(kept.solve(&cells).unwrap()), bits(&solve(&of_level(level), &cells)));
    }
}

#[test]
fn an_inflow_has_the_emission_of_its_settings() {
    // Behind fog that the threshold takes for empty.
    let cells = grid(60, 20, |x, _| match x {
        40..44 => Matter { opacity: 0.3, ..Matter::EMPTY },
        50.. => GLOW,
        _ => Matter::EMPTY,
    });
    let window = GridWindow { first: [0; 2], size: [20; 2] };
    let seen = |raymarch: Raymarch| {
        let mut solver = Solver::new(Settings::direct(raymarch)).unwrap();
        solver.solve(&cells).unwrap();
        let inflow = solver.inflow(window, 64).unwrap();
        // The middle of the right side, in all directions.
        inflow.strip(30).iter().map(|rgb| rgb[0]).sum::<f32>()
    };
    let clear = Raymarch { threshold: 0.5, ..Raymarch::default() };
    let [plain, doubled] = [1.0, 2.0]
        .map(|emission_multiplier| seen(Raymarch { emission_multiplier, ..clear.clone() }));
    assert!(plain > 0.0 && (doubled / plain - 2.0).abs() < 1e-5, "{plain}, {doubled}");
    let foggy = seen(Raymarch::default());
    assert!(plain > 1.5 * foggy, "{plain}, {foggy}");
}

#[test]
fn an_inflow_of_another_size_is_refused() {
    let mut cells = Cells::new(8, 5).unwrap();
    let other = Inflow::new([5, 8], 4, |_, _| [1.0; 3]).unwrap();
    let error = cells.set_inflow(Some(other)).unwrap_err().to_string();
    assert!(error.contains("5×8") && error.contains("8×5"), "{error}");
}

#[test]
fn radiance_that_is_none_is_refused() {
    for invalid in [f32::NAN, f32::INFINITY, -1.0, 2e12] {
        let size = [8, 5];
        let radiance = |place: [f32; 2]| if place == [8.0, 2.5] { invalid } else { 0.0 };
        let inflow = Inflow::new(size, 4, |place, _| [1.0, radiance(place.at), -0.0]);
        let error = inflow.unwrap_err().to_string();
        let expected = format!("`inflow` is {invalid}, but must be a radiance from 0 to 1e12");
        assert_eq!(error, expected);
    }
}

/// A window of a world, by its first cell and its size.
const WORLD: [u32; 2] = [200, 150];
const FIRST: [u32; 2] = [60, 45];
const SIZE: [u32; 2] = [80, 60];

/// A world with lights around a window, and walls in it.
fn world() -> Cells {
    let mut cells = Cells::new(WORLD[0], WORLD[1]).unwrap();
    let mut disc = |[cx, cy]: [f32; 2], radius: f32, matter: Matter| {
        for (x, y) in (0..WORLD[0]).flat_map(|x| (0..WORLD[1]).map(move |y| (x, y))) {
            if (x as f32 + 0.5 - cx).hypot(y as f32 + 0.5 - cy) < radius {
                cells.set(x, y, matter);
            }
        }
    };
    let glow = |emission| Matter { opacity: 1.0, emission, ..Matter::EMPTY };
    disc([30.0, 40.0], 8.0, glow([4.0, 2.0, 1.0]));
    disc([170.0, 30.0], 6.0, glow([1.0, 3.0, 2.0]));
    disc([110.0, 130.0], 7.0, glow([1.0, 1.5, 4.0]));
    let wall = Matter { opacity: 1.0, albedo: [0.8, 0.6, 0.4], ..Matter::EMPTY };
    disc([80.0, 70.0], 4.0, wall);
    disc([115.0, 80.0], 5.0, wall);
    disc([45.0, 62.0], 3.0, wall);
    disc([150.0, 100.0], 20.0, wall);
    cells
}

/// The window alone.
fn window(world: &Cells) -> Cells {
    let mut cells = Cells::new(SIZE[0], SIZE[1]).unwrap();
    for (x, y) in (0..SIZE[0]).flat_map(|x| (0..SIZE[1]).map(move |y| (x, y))) {
        cells.set(x, y, world.get(FIRST[0] + x, FIRST[1] + y).unwrap());
    }
    cells
}

/// The error of the light of the window alone, with inflow of so many columns, against its light in the world.
fn error_alone(world: &Cells, settings: &Settings, columns: usize) -> f64 {
    let mut solver = Solver::new(settings.clone()).unwrap();
    let whole = solver.solve(world).unwrap().clone();
    let inflow = solver.inflow(GridWindow { first: FIRST, size: SIZE }, columns).unwrap();
    let mut cells = window(world);
    cells.set_inflow(Some(inflow)).unwrap();
    let (xs, ys) = (FIRST[0]..FIRST[0] + SIZE[0], FIRST[1]..FIRST[1] + SIZE[1]);
    let at = ys.flat_map(|y| xs.clone().map(move |x| (x, y)));
    let truth: Vec<Rgb> = at.map(|(x, y)| whole.at(x, y)).collect();
    error(&solve(settings, &cells), &truth)
}

/// Largest error of the light of a window alone against its light in its world, by the same method: noise in
/// `raymarch`, probes that lie elsewhere in `cascades`, and points of `fast` and `coarse`.
const ALONE: [f64; 6] = [0.05, 0.04, 0.015, 0.03, 0.07, 0.01];

#[test]
fn a_window_has_the_light_of_its_world() {
    let world = world();
    for ((name, settings), bound) in methods().into_iter().zip(ALONE) {
        for bounces in [0, 2] {
            let settings = Settings { bounces: Bounces::Count(bounces), ..settings.clone() };
            let found = [128, 512].map(|columns| error_alone(&world, &settings, columns));
            println!(
                "{name}, {bounces} bounces: {:.2}, {:.2} %",
                100.0 * found[0],
                100.0 * found[1]
            );
            assert!(found[1] < bound, "{name}, {bounces} bounces: {}", found[1]);
        }
    }
}
