//! Bounces by feedback: one more each frame, from the light of the frame before.

use crate::common::*;
use lamplight::settings::{Cascades, Holographic, MethodSettings, Raymarch};
use lamplight::{Bounces, Cells, Direct, Lamp, Light, Matter, Settings, Solver};

/// A method, and what a furnace shows of it.
struct Subject {
    method: MethodSettings,
    /// Bounces that the first frame has.
    first: u32,
    /// Relative error of the light in a furnace.
    error: f64,
}

fn subjects() -> Vec<Subject> {
    // Rays are gathered at surfaces as well, before they are at pixels.
    let rays = |name: &&'static str| Subject {
        method: unfiltered(Raymarch::preset(name).unwrap()).into(),
        first: 1,
        error: 1e-4,
    };
    let mut subjects: Vec<Subject> = Raymarch::PRESETS.iter().map(rays).collect();
    subjects.push(Subject { method: Cascades::default().into(), first: 0, error: 1e-4 });
    subjects.push(Subject { method: Holographic::default().into(), first: 0, error: 5e-3 });
    subjects
}

fn solver(method: &MethodSettings, bounces: Bounces) -> Solver {
    Solver::new(Settings { bounces, ..Settings::new(method.clone()) }).unwrap()
}

/// Sums over cones are grouped by the pixels that are wanted.
const ROUNDING: f32 = 5e-4;

/// A box whose walls emit and reflect, and the light in it after some bounces.
const EMITS: f32 = 0.5;

fn furnace(albedo: f32) -> Cells {
    room(15, 11, Matter { emission: [EMITS; 3], albedo: [albedo; 3], ..WALL })
}

fn in_the_furnace(albedo: f64, bounces: u32) -> f64 {
    (0..=bounces).map(|k| f64::from(EMITS) * albedo.powi(k as i32)).sum()
}

#[track_caller]
fn all_open_cells_are(light: &Light, expected: f64, error: f64) {
    for i in (0..light.pixels().len()).filter(|&i| !light.solid()[i]) {
        near(light.pixels()[i][1], expected, error);
    }
}

/// Red walls, fog and a lamp that a screen hides from half of the room.
fn hall() -> Cells {
    let mut cells = grid(48, 32, |x, y| match (x, y) {
        (0 | 47, _) | (_, 0 | 31) => Matter { albedo: [0.8, 0.4, 0.3], ..WALL },
        (24, 0..20) => Matter { albedo: [0.6; 3], ..WALL },
        (30..40, 18..28) => Matter { opacity: 0.05, albedo: [0.9; 3], ..Matter::EMPTY },
        _ => Matter::EMPTY,
    });
    cells.lamps_mut().push(Lamp { position: [10.0, 9.0], size: 3.0, ..Lamp::default() });
    cells
}

/// The largest difference between lights, relative to the mean of the second.
fn difference(a: &Light, b: &Light) -> f32 {
    let mean = b.over([0.0; 2], [b.width() as f32, b.height() as f32])[1];
    let both = a.pixels().iter().zip(b.pixels());
    both.flat_map(|(a, b)| a.iter().zip(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) / mean
}

/// The methods without noise, whose frames differ by their bounces alone.
fn without_noise() -> impl Iterator<Item = MethodSettings> {
    let methods = subjects().into_iter().map(|subject| subject.method);
    methods.filter(|method| method.as_raymarch().is_none())
}

#[test]
fn each_frame_adds_a_bounce() {
    for Subject { method, first, error } in subjects() {
        let mut solver = solver(&method, Bounces::Feedback);
        for frame in 0..8 {
            let light = solver.solve(&furnace(0.8)).unwrap();
            all_open_cells_are(light, in_the_furnace(0.8f32.into(), first + frame), error);
        }
    }
}

#[test]
fn each_frame_has_the_light_of_as_many_bounces() {
    let [mut spot, drawn] = [hall(), hall()];
    spot.lamps_mut()[0].direct = Direct::Exact;
    for cells in [drawn, spot] {
        for method in without_noise() {
            let mut feedback = solver(&method, Bounces::Feedback);
            let mut before = feedback.light().clone();
            for frame in 0..4 {
                let mut exact = solver(&method, Bounces::Count(frame));
                let expected = exact.solve(&cells).unwrap();
                let found = feedback.solve(&cells).unwrap();
                let off = difference(found, expected);
                assert!(off < ROUNDING, "{method:?}, frame {frame}: {off}");
                assert!(frame == 0 || difference(&before, expected) > 0.1, "frames are alike");
                before.clone_from(found);
            }
        }
    }
}

#[test]
fn light_grows_to_that_of_all_bounces() {
    for method in without_noise() {
        let mut converged = solver(&method, Bounces::Converged);
        let converged = converged.solve(&hall()).unwrap();
        let mut solver = solver(&method, Bounces::Feedback);
        (0..48).for_each(|_| _ = solver.solve(&hall()).unwrap());
        let off = difference(solver.light(), converged);
        println!("{method:?}: {off}");
        // Bounces count as converged from 1e-3 of change on, and later ones add a few times as much.
        assert!(off < 5e-3, "{method:?}: {off}");
    }
}

#[test]
fn the_published_variant_makes_all_bounces_in_each_frame() {
    let paper: MethodSettings = Holographic::preset("paper").unwrap().into();
    let [feedback, converged] = [Bounces::Feedback, Bounces::Converged]
        .map(|bounces| solver(&paper, bounces).solve(&hall()).unwrap().clone());
    assert_eq!(feedback.pixels(), converged.pixels());
}

#[test]
fn frames_repeat_only_without_feedback() {
    for method in without_noise() {
        for (bounces, repeats) in [(Bounces::Converged, true), (Bounces::Feedback, false)] {
            let settings = Settings { bounces, ..Settings::new(method.clone()) };
            assert_eq!(settings.repeats(), repeats, "{method:?}, {bounces:?}");
        }
    }
}

#[test]
fn walls_that_turn_black_reflect_no_light_of_earlier_frames() {
    // Another room goes on reflecting, so that bounces are made at all.
    let rooms = |albedo: f32| {
        grid(19, 11, |x, y| match (x, y) {
            (1..=13, 1..=9) | (16, 4) => Matter::EMPTY,
            (0..=14, _) => Matter { emission: [EMITS; 3], albedo: [albedo; 3], ..WALL },
            _ => Matter { emission: [EMITS; 3], albedo: [0.8; 3], ..WALL },
        })
    };
    for Subject { method, error, .. } in subjects() {
        let mut solver = solver(&method, Bounces::Feedback);
        for _ in 0..3 {
            solver.solve(&rooms(0.8)).unwrap();
        }
        let light = solver.solve(&rooms(0.0)).unwrap();
        near(light.at(7, 5)[1], f64::from(EMITS), error);
        assert!(light.at(16, 4)[1] > 2.0 * EMITS, "{method:?}: the other room is dark");
    }
}

#[test]
fn light_is_the_same_again_after_a_reset() {
    for Subject { method, .. } in subjects() {
        let mut solver = solver(&method, Bounces::Feedback);
        let first = solver.solve(&hall()).unwrap().clone();
        let second = solver.solve(&hall()).unwrap().clone();
        assert!(difference(&first, &second) > 0.01, "{method:?}: frames are alike");
        solver.reset();
        assert_eq!(solver.solve(&hall()).unwrap().pixels(), first.pixels(), "{method:?}");
    }
}

#[test]
fn bounces_go_on_when_the_grid_changes_its_size() {
    // The room, and darkness to the right of it and below, or none.
    let sized = |[width, height]: [u32; 2]| {
        let room = furnace(0.8);
        grid(width, height, |x, y| match (x, y) {
            (0..15, 0..11) => room.get(x, y).unwrap(),
            _ => Matter::EMPTY,
        })
    };
    for Subject { method, first, error } in subjects() {
        let mut solver = solver(&method, Bounces::Feedback);
        for (frame, size) in (0..).zip([[15, 11], [15, 11], [20, 11], [17, 16], [15, 12]]) {
            let light = solver.solve(&sized(size)).unwrap();
            let expected = in_the_furnace(0.8f32.into(), first + frame);
            near(light.at(7, 5)[1], expected, error);
        }
    }
}
