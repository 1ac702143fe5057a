//! Lamps and glowing cells in every method: as bright as the closed form says, wherever a lamp stands, and
//! blocking nothing.

use crate::common::*;
use lamplight::settings::{Cascades, Holographic, MethodSettings, Raymarch};
use lamplight::{Bounces, Cells, Lamp, Light, Matter, Rgb, Settings, Solver};
use lamplight_truth::closed_forms::*;
use lamplight_truth::{Measures, scenes};
use std::f64::consts::TAU;

/// Radii of lamps, px.
const SIZES: [f32; 6] = [0.5, 0.75, 1.0, 2.0, 3.0, 6.0];
/// The specified steadiness over all positions, relative.
const STEADY: f64 = 0.01;
/// The light of two lamps, relative to the sum of both: what a method rounds, and the extinction of glow.
const ADDS_UP: f64 = 0.003;
/// Radius of the ring on which lamps are measured, px.
const RING: f64 = 40.0;

/// Every method that draws lamps, and a bound of its error: of the mean over a ring, and the relative RMSE among
/// fires.
fn methods() -> [(&'static str, MethodSettings, f64); 4] {
    let holographic = |preset| Holographic::preset(preset).unwrap().into();
    [
        ("raymarch", Raymarch { rays: 512, ..Raymarch::default() }.into(), 0.01),
        ("cascades", Cascades::default().into(), 0.025),
        ("holographic", holographic("default"), 0.015),
        ("holographic, quality", holographic("quality"), 0.01),
    ]
}

fn solve(cells: &Cells, method: &MethodSettings) -> Light {
    let settings = Settings::direct(method.clone());
    Solver::new(settings).unwrap().solve(cells).unwrap().clone()
}

/// Mean of J·d over a ring round a lone lamp ÷ that of the closed form of another.
fn against_closed_form(method: &MethodSettings, lone: Lamp, lamp: Lamp) -> f64 {
    let mut cells = Cells::new(101, 101).unwrap();
    cells.lamps_mut().push(lone);
    let light = solve(&cells, method);
    // A lamp under 1 px is drawn at 1 px, with the light of its own size.
    let (size, radius) = (f64::from(lamp.size), f64::from(lamp.size.max(1.0)));
    let glow = 2.0 * f64::from(lamp.intensity) * size / (TAU / 2.0 * radius * radius);
    let (mut sum, mut expected) = (0.0, 0.0);
    for i in 0..96 {
        let (sin, cos) = (f64::from(i) * TAU / 96.0).sin_cos();
        let [x, y] = [50.5 + RING * cos, 50.5 + RING * sin].map(|v| v as u32);
        let [cx, cy] = centre([x, y]);
        let d = (cx - f64::from(lamp.position[0])).hypot(cy - f64::from(lamp.position[1]));
        sum += f64::from(light.at(x, y)[0]) * d;
        expected += glow_disc_mean_radiance(glow, radius, d) * d;
    }
    sum / expected
}

/// Returns the least and the most light of a lamp over its positions in an octant of a cell.
fn over_positions(method: &MethodSettings, lamp: Lamp) -> [f64; 2] {
    let positions = (0..3).flat_map(|i| (0..=i).map(move |j| [i, j]));
    let light = positions.map(|shift| {
        let position = shift.map(|v| 50.0 + v as f32 / 4.0);
        let lamp = Lamp { position, ..lamp.clone() };
        against_closed_form(method, lamp.clone(), lamp)
    });
    light.fold([f64::MAX, f64::MIN], |[least, most], v| [least.min(v), most.max(v)])
}

#[test]
fn a_gliding_lamp_keeps_its_light() {
    for (name, method, error) in methods() {
        for size in SIZES {
            let lamp = Lamp { size, intensity: 4.0, ..Lamp::default() };
            let [least, most] = over_positions(&method, lamp);
            println!("{name}, size {size}: {least:.4} to {most:.4}");
            assert!(most - least < STEADY, "{name}, size {size}: {least} to {most}");
            assert!(least > 1.0 - error && most < 1.0 + error, "{name}, size {size}");
        }
    }
}

#[test]
fn the_comparison_rejects_a_lamp_that_is_two_percent_brighter() {
    let (_, method, error) = &methods()[0];
    let lamp = Lamp { position: [50.25, 50.5], intensity: 1.0, ..Lamp::default() };
    let [right, wrong] = [1.0, 1.02].map(|intensity| {
        against_closed_form(method, Lamp { intensity, ..lamp.clone() }, lamp.clone()) - 1.0
    });
    assert!(right.abs() < *error && wrong > *error && wrong - right > STEADY, "{right} {wrong}");
}

/// Light of a lamp and of a wider one in front of it, at places on both sides and behind, ÷ the sum of both
/// alone; the farthest from 1.
fn shading(light: impl Fn(&Cells) -> Vec<f32>, solid: bool) -> f64 {
    let far = Lamp { position: [20.5, 30.25], solid, ..Lamp::default() };
    let near = Lamp { position: [60.25, 30.5], size: 6.0, solid, ..Lamp::default() };
    let of = |lamps: &[Lamp]| {
        let mut cells = Cells::new(121, 61).unwrap();
        cells.lamps_mut().extend_from_slice(lamps);
        light(&cells)
    };
    let [both, far, near] = [&[far.clone(), near.clone()][..], &[far], &[near]].map(of);
    let ratio = |i: usize| f64::from(both[i] / (far[i] + near[i]));
    (0..both.len()).map(ratio).max_by(|a, b| (a - 1.0).abs().total_cmp(&(b - 1.0).abs())).unwrap()
}

/// Places around the two lamps.
const AROUND: [[u32; 2]; 5] = [[100, 30], [100, 34], [40, 30], [5, 30], [60, 55]];

#[test]
fn lamps_do_not_shade_each_other() {
    let traced = |cells: &Cells| -> Vec<f32> {
        direct(40_000).at(cells, &AROUND).unwrap().iter().map(|(mean, _)| mean[0]).collect()
    };
    let off = shading(traced, false) - 1.0;
    println!("path tracer: {off:+.5}");
    assert!(off.abs() < ADDS_UP, "path tracer: {off}");
    assert!(shading(traced, true) < 0.8, "solid lamps block light");
    for (name, method, _) in methods() {
        let solved = |cells: &Cells| -> Vec<f32> {
            let light = solve(cells, &method);
            AROUND.iter().map(|&[x, y]| light.at(x, y)[0]).collect()
        };
        let off = shading(solved, false) - 1.0;
        println!("{name}: {off:+.5}");
        assert!(off.abs() < ADDS_UP, "{name}: {off}");
        assert!(shading(solved, true) < 0.8, "{name}: solid lamps block light");
    }
}

/// Fire, fog that glows, glass, walls, and lamps that overlap all of them.
fn fires(seed: u64) -> Cells {
    let mut random = seeded(seed);
    let mut rgb = || -> Rgb { std::array::from_fn(|_| 0.1 + random.f32()) };
    let matter = [
        Matter { glow: rgb().map(|v| 0.3 * v), ..Matter::EMPTY },
        Matter { glow: rgb().map(|v| 0.1 * v), opacity: 0.03, albedo: [0.5; 3], ..Matter::EMPTY },
        Matter { opacity: 0.01, tint: rgb().map(|v| v.min(1.0)), ..Matter::EMPTY },
        Matter { opacity: 1.0, albedo: rgb().map(|v| 0.7 * v.min(1.0)), ..Matter::EMPTY },
    ];
    let mut cells = Cells::new(128, 96).unwrap();
    for i in 0..24 {
        let [x, y] = [128.0, 96.0].map(|side| side * random.f32());
        let radius = 3.0 + 7.0 * random.f32();
        if i % 6 < 4 {
            for at in 0..cells.len() {
                let [cx, cy] = [at % 128, at / 128].map(|v| v as f32 + 0.5);
                if (cx - x).hypot(cy - y) < radius {
                    cells.set_matter(at, matter[i % 6]);
                }
            }
        } else {
            let size = 0.5 + 2.0 * random.f32();
            cells.lamps_mut().push(Lamp {
                position: [x, y],
                size,
                intensity: 1.0,
                ..Lamp::default()
            });
        }
    }
    cells
}

#[test]
fn glow_is_right_among_fog_glass_and_walls() {
    let cells = fires(7);
    let at = scenes::open_cells(&cells, 600, 3);
    for bounces in [Bounces::Count(0), Bounces::Count(2)] {
        let truth = tracer(4096, bounces).at(&cells, &at).unwrap();
        let truth: Vec<Rgb> = truth.into_iter().map(|(mean, _)| mean).collect();
        for (name, method, error) in methods() {
            let settings = Settings { bounces, ..Settings::direct(method) };
            let light = Solver::new(settings).unwrap().solve(&cells).unwrap().clone();
            let seen: Vec<Rgb> = at.iter().map(|&[x, y]| light.at(x, y)).collect();
            let measures = Measures::of(&seen, &truth, &vec![false; at.len()]);
            println!(
                "{name}, {bounces:?}: {:.2} %, bias {:+.2} %",
                100.0 * measures.relative_rmse,
                100.0 * measures.bias
            );
            assert!(measures.relative_rmse < error, "{name}, {bounces:?}");
        }
    }
}
