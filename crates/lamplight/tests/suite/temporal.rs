//! Mean over frames: noise falls, and removed light leaves no trail.

use crate::common::*;
use lamplight::internals::temporal::REACH;
use lamplight::settings::{Hit, Noise, Spacing, Temporal};
use lamplight::{
    Bounces, Cells, Direct, Inflow, Lamp, Light, Matter, Rgb, Settings, Sky, Solver, Sun,
};

/// Rays of a frame, and of what frames are compared with.
const RAYS: u32 = 16;
const MANY_RAYS: u32 = 2048;

/// The largest error that may be left after 8 and 64 frames, ÷ that of one. Independent frames leave
/// 1/√8 = 0.354 and 1/8 = 0.125; the rest is the noise of the measure and of the truth itself.
const AFTER_8: f64 = 0.4;
const AFTER_64: f64 = 0.16;

/// The largest fraction of a lamp's light that may be left after 8 frames.
const LEFT: f64 = 0.01;

fn accumulating(change: impl FnOnce(&mut Settings)) -> Settings {
    settings(|s| {
        raymarch_of(s).temporal.history_length = 64;
        raymarch_of(s).rays = RAYS;
        change(s);
    })
}

/// Two rooms with a door between them, pillars, and albedo ½ all over.
fn rooms() -> Cells {
    grid(72, 40, |x, y| {
        let edge = x == 0 || y == 0 || x == 71 || y == 39;
        let middle = x == 40 && !(16..22).contains(&y);
        let pillar = x % 13 == 9 && y % 11 == 6;
        let wall = edge || middle || pillar;
        if wall { Matter { albedo: [0.5; 3], ..WALL } } else { Matter::EMPTY }
    })
}

fn lamp(position: [f32; 2], size: f32) -> Lamp {
    Lamp { position, size, intensity: 5.0, ..LAMP }
}

fn with_lamp(cells: &Cells, lamp: Lamp) -> Cells {
    let mut cells = cells.clone();
    cells.lamps_mut().push(lamp);
    cells
}

fn frames(solver: &mut Solver, cells: &Cells, count: usize) -> Light {
    for _ in 0..count {
        solver.solve(cells).unwrap();
    }
    solver.light().clone()
}

#[test]
fn noise_falls_with_the_frames() {
    let cells = with_lamp(&rooms(), lamp([20.0, 20.0], 2.0));
    for bounces in [0, 1] {
        let bounces = Bounces::Count(bounces);
        let truth =
            settings(|s| (raymarch_of(s).rays, s.bounces, s.seed) = (MANY_RAYS, bounces, 9));
        let truth = solve(&truth, &cells);
        for noise in [Noise::White, Noise::Blue, Noise::Golden] {
            let settings = accumulating(|s| (raymarch_of(s).noise, s.bounces) = (noise, bounces));
            let mut solver = Solver::new(settings).unwrap();
            let mut after = |more| relative_rmse(&frames(&mut solver, &cells, more), &truth);
            let errors = [after(1), after(7), after(56)];
            let [of_8, of_64] = [errors[1] / errors[0], errors[2] / errors[0]];
            println!(
                "{noise:?}, {bounces:?}: {:.2} %, {:.2} %, {:.2} % after 1, 8, 64 frames",
                100.0 * errors[0],
                100.0 * errors[1],
                100.0 * errors[2]
            );
            assert!(of_8 < AFTER_8, "{noise:?}: {of_8} of the error is left after 8 frames");
            assert!(of_64 < AFTER_64, "{noise:?}: {of_64} of the error is left after 64 frames");
        }
    }
}

#[test]
fn without_accumulation_noise_stays() {
    let cells = with_lamp(&rooms(), lamp([20.0, 20.0], 2.0));
    let truth = solve(&settings(|s| (raymarch_of(s).rays, s.seed) = (MANY_RAYS, 9)), &cells);
    let mut solver =
        Solver::new(accumulating(|s| raymarch_of(s).temporal.history_length = 1)).unwrap();
    let mut after = |more| relative_rmse(&frames(&mut solver, &cells, more), &truth);
    let (first, eighth) = (after(1), after(7));
    assert!(eighth > 2.0 * AFTER_8 * first, "{first} to {eighth}");
}

/// Light near the lamp (within 12 px) and far from it, summed over open cells.
fn sums(light: &Light, lamp: &Lamp) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for i in (0..light.pixels().len()).filter(|&i| !light.solid()[i]) {
        let (x, y) = (i as u32 % light.width(), i as u32 / light.width());
        let away = (x as f32 + 0.5 - lamp.position[0]).hypot(y as f32 + 0.5 - lamp.position[1]);
        sums[usize::from(away > 12.0)] += f64::from(light.pixels()[i][0]);
    }
    sums
}

/// Returns the light left of a lamp 8 frames after it went out, near and far.
fn left_behind(settings: &Settings, lit: &Cells, dark: &Cells, lamp: &Lamp) -> [f64; 2] {
    let mut solver = Solver::new(settings.clone()).unwrap();
    let before = sums(&frames(&mut solver, lit, 10), lamp);
    let after = sums(&frames(&mut solver, dark, 8), lamp);
    [after[0] / before[0], after[1] / before[1]]
}

/// Each way to bounce, with each rule of where rays end.
fn variants() -> Vec<(&'static str, Settings)> {
    let mut variants = Vec::new();
    for hit in [Hit::Edge, Hit::Distance] {
        for (name, bounces) in [
            ("direct", Bounces::Count(0)),
            ("two bounces", Bounces::Count(2)),
            ("feedback", Bounces::Feedback),
        ] {
            variants
                .push((name, accumulating(|s| (s.bounces, raymarch_of(s).hit) = (bounces, hit))));
        }
    }
    variants
}

#[test]
fn a_lamp_that_goes_out_leaves_no_trail() {
    let dark = rooms();
    for (name, settings) in variants() {
        let mut worst = [0.0f64; 2];
        for (size, position) in
            [(0.5, [20.3, 20.6]), (1.0, [5.5, 6.0]), (1.5, [33.1, 30.0]), (3.0, [20.0, 12.0])]
        {
            let lamp = lamp(position, size);
            let left = left_behind(&settings, &with_lamp(&dark, lamp.clone()), &dark, &lamp);
            worst = [worst[0].max(left[0]), worst[1].max(left[1])];
        }
        let hit = settings.method.as_raymarch().unwrap().hit;
        println!(
            "{name}, {hit:?}: {:.4} % left near the lamp, {:.4} % far from it",
            100.0 * worst[0],
            100.0 * worst[1]
        );
        assert!(worst.iter().all(|&left| left < LEFT), "{name}, {hit:?}: {worst:?}");
    }
}

#[test]
fn matter_that_stops_emitting_leaves_no_trail() {
    let lamp = lamp([20.5, 20.5], 0.5);
    for kind in [GLOW, Matter { emission: [9.0; 3], opacity: 0.4, ..Matter::EMPTY }] {
        for (name, settings) in variants() {
            let (mut lit, dark) = (rooms(), rooms());
            lit.set(20, 20, kind);
            let left = left_behind(&settings, &lit, &dark, &lamp);
            assert!(left.iter().all(|&left| left < LEFT), "{name}, {settings:?}: {left:?}");
        }
    }
}

#[test]
fn light_of_other_kinds_than_matter_leaves_no_trail() {
    let floor = Matter { albedo: [0.5; 3], ..WALL };
    let dark = grid(72, 40, |_, y| if y > 34 { floor } else { Matter::EMPTY });
    let lamp = lamp([20.0, 20.0], 2.0);
    let [mut sunny, mut entered] = [dark.clone(), dark.clone()];
    sunny.suns_mut().push(Sun::default());
    entered.set_inflow(Some(Inflow::new([72, 40], 8, |_, _| [1.0; 3]).unwrap())).unwrap();
    let exact = with_lamp(&dark, Lamp { direct: Direct::Exact, ..lamp.clone() });
    for (kind, lit) in [("an exact lamp", exact), ("a sun", sunny), ("inflow", entered)] {
        for (name, settings) in variants() {
            let left = left_behind(&settings, &lit, &dark, &lamp);
            assert!(left.iter().all(|&left| left < LEFT), "{kind}, {name}: {left:?}");
        }
    }
}

#[test]
fn without_rejection_a_trail_is_left() {
    let (dark, lamp) = (rooms(), lamp([20.0, 12.0], 2.0));
    for (name, mut settings) in variants() {
        raymarch_of(&mut settings).temporal.reject = false;
        let left = left_behind(&settings, &with_lamp(&dark, lamp.clone()), &dark, &lamp);
        assert!(left.iter().all(|&left| left > 10.0 * LEFT), "{name}: {left:?}");
    }
}

/// A lamp shines through a door into a cloud; what lies below the cloud sees no more of the lamp
/// than the cloud scatters, as the walls are black.
fn cloud() -> Cells {
    grid(60, 40, |x, y| match (x, y) {
        (30, y) if !(5..10).contains(&y) => WALL,
        (34..46, 1..14) => Matter { opacity: 0.1, albedo: [0.9; 3], ..Matter::EMPTY },
        _ => Matter::EMPTY,
    })
}

#[test]
fn light_in_a_cloud_goes_out_with_its_lamp() {
    let (dark, lamp) = (cloud(), lamp([10.0, 8.0], 2.0));
    let lit = with_lamp(&dark, lamp);
    let below = |light: &Light| light.over([31.0, 26.0], [60.0, 40.0])[0];
    for bounces in [Bounces::Count(1), Bounces::Feedback] {
        let settings = accumulating(|s| s.bounces = bounces);
        let mut solver = Solver::new(settings).unwrap();
        let before = below(&frames(&mut solver, &lit, 10));
        let left = below(&frames(&mut solver, &dark, 8)) / before;
        println!("{bounces:?}: {:.4} % of {before} left below the cloud", 100.0 * left);
        assert!(before > 0.0 && f64::from(left) < LEFT, "{bounces:?}: {left} of {before}");
    }
}

#[test]
fn bright_history_does_not_round_dim_frames_away() {
    let lit = |emission: f32| {
        let mut cells = room(16, 16, WALL);
        cells.set(5, 5, Matter { emission: [emission; 3], ..WALL });
        cells
    };
    let mut solver = Solver::new(accumulating(|_| {})).unwrap();
    frames(&mut solver, &lit(1e9), 4);
    assert!(starts_afresh(&mut solver, 4, &lit(1e-3)));
}

/// Two closed rooms, each with a light of its own; `flicker` is that of the left one.
fn apart(flicker: Rgb) -> Cells {
    let mut cells = grid(70, 24, |x, y| {
        let edge = x % 69 == 0 || y % 23 == 0 || x == 30;
        if edge { Matter { albedo: [0.5; 3], ..WALL } } else { Matter::EMPTY }
    });
    cells.set(10, 12, Matter { emission: flicker, ..WALL });
    cells.set(50, 12, Matter { emission: [5.0; 3], ..WALL });
    cells
}

#[test]
fn cells_that_see_no_change_keep_their_history() {
    for bounces in [0, 2] {
        let settings = accumulating(|s| s.bounces = Bounces::Count(bounces));
        let (mut calm, mut restless) =
            (Solver::new(settings.clone()).unwrap(), Solver::new(settings.clone()).unwrap());
        for frame in 0..24 {
            calm.solve(&apart([5.0; 3])).unwrap();
            restless.solve(&apart([5.0 + (frame % 2) as f32, 5.0, 5.0])).unwrap();
        }
        // What a cell sees counts for all within REACH, also behind a wall.
        let far = 31 + REACH as u32;
        let mut differ = 0;
        for (x, y) in (1..69).flat_map(|x| (1..23).map(move |y| (x, y))) {
            let (a, b) = (calm.light().at(x, y), restless.light().at(x, y));
            if x > far {
                assert_eq!(a, b, "({x}, {y})");
            } else if x < 30 {
                differ += usize::from(a != b);
            }
        }
        assert!(differ > 500, "only {differ} cells of the restless room differ");
    }
}

/// Returns whether a solver's next frame has no history: it equals a frame without accumulation.
fn starts_afresh(solver: &mut Solver, before: usize, cells: &Cells) -> bool {
    let mut settings = solver.settings().clone();
    raymarch_of(&mut settings).temporal.history_length = 0;
    let mut plain = Solver::new(settings).unwrap();
    let other = Cells::new(1, 1).unwrap();
    frames(&mut plain, &other, before);
    bits(solver.solve(cells).unwrap()) == bits(plain.solve(cells).unwrap())
}

#[test]
fn another_size_resets_history() {
    // Bounces by feedback go on.
    let settings = variants().into_iter().map(|(_, settings)| settings);
    let without_feedback = settings.filter(|settings| settings.bounces != Bounces::Feedback);
    let lit = |[w, h]: [u32; 2]| {
        with_lamp(
            &room(w, h, Matter { albedo: [0.5; 3], ..WALL }),
            lamp([w as f32 / 2.0, h as f32 / 2.0], 1.0),
        )
    };
    for settings in without_feedback {
        // Also with as many cells in another shape.
        for size in [[40, 24], [24, 30], [30, 30], [5, 9]] {
            let mut solver = Solver::new(settings.clone()).unwrap();
            frames(&mut solver, &lit([30, 24]), 6);
            assert!(starts_afresh(&mut solver, 6, &lit(size)), "{size:?}, {settings:?}");
        }
        let mut solver = Solver::new(settings.clone()).unwrap();
        frames(&mut solver, &lit([30, 24]), 6);
        assert!(!starts_afresh(&mut solver, 6, &lit([30, 24])), "the test sees no history");
    }
}

#[test]
fn reset_clears_history() {
    let cells = with_lamp(&rooms(), lamp([20.0, 12.0], 2.0));
    for (name, settings) in variants() {
        let first = solve(&settings, &cells);
        let mut solver = Solver::new(settings).unwrap();
        let fifth = frames(&mut solver, &cells, 5);
        assert_ne!(bits(&first), bits(&fifth), "{name}");
        solver.reset();
        assert_eq!(bits(&first), bits(solver.solve(&cells).unwrap()), "{name}");
    }
}

#[test]
fn another_sky_resets_history_if_rejection_is_on() {
    let under = |sky: f32| {
        let mut cells = grid(24, 24, |x, y| if [x, y] == [12, 12] { GLOW } else { Matter::EMPTY });
        cells.set_sky(Sky::Uniform([sky; 3]));
        cells
    };
    for reject in [true, false] {
        let temporal = Temporal { history_length: 64, reject };
        let mut solver = Solver::new(settings(|s| {
            (raymarch_of(s).temporal, raymarch_of(s).spacing) = (temporal, Spacing::Golden)
        }))
        .unwrap();
        frames(&mut solver, &under(1.0), 6);
        assert_eq!(starts_afresh(&mut solver, 6, &under(0.5)), reject);
    }
}
