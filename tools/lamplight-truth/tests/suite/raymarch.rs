//! `raymarch` held to the reference on the project's own scenes.

use crate::common::seeded;
use lamplight::settings::Raymarch;
use lamplight::{Bounces, Cells, Lamp, Light, Rgb, Scene, Settings, Solver};
use lamplight_truth::{Measures, PathTracer};
use std::path::{Path, PathBuf};

/// Relative RMSE that is allowed, direct light with 1024 rays …
const DIRECT: f64 = 0.02;
/// … on the dungeon, whose lamps are a few px wide …
const DUNGEON: f64 = 0.05;
/// … and with bounces and as many rays.
const BOUNCED: f64 = 0.03;
/// Open cells looked at in each scene, at random; their seed is fixed, so runs repeat.
const LOOKS: usize = 100;

fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut scenes: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    scenes.sort();
    assert!(scenes.len() >= 8, "the project promises eight scenes, found {scenes:?}");
    scenes
}

fn solve(cells: &Cells, rays: u32, bounces: u32) -> Light {
    let raymarch = Raymarch { rays, ..Raymarch::default() };
    let settings = Settings { bounces: Bounces::Count(bounces), ..Settings::direct(raymarch) };
    Solver::new(settings).unwrap().solve(cells).unwrap().clone()
}

/// Open cells spread at random.
fn looks(cells: &Cells) -> Vec<[u32; 2]> {
    let mut random = seeded(0x1a3b);
    let drawn = cells.drawn();
    std::iter::repeat_with(|| [random.u32(..cells.width()), random.u32(..cells.height())])
        .filter(|&[x, y]| !drawn.is_solid(drawn.index(x, y)))
        .take(LOOKS)
        .collect()
}

/// Measures a light at some cells; prints the error and the reference's own.
fn judge(name: &str, cells: &Cells, light: &Light, tracer: PathTracer) -> Measures {
    let at = looks(cells);
    let truth = tracer.at(cells, &at).unwrap();
    let (mean, error): (Vec<Rgb>, Vec<Rgb>) = truth.into_iter().unzip();
    let seen: Vec<Rgb> = at.iter().map(|&[x, y]| light.at(x, y)).collect();
    let measures = Measures::of(&seen, &mean, &vec![false; at.len()]);
    let own = error.as_flattened().iter().map(|e| f64::from(*e).powi(2)).sum::<f64>();
    let own = (own / (3 * at.len()) as f64).sqrt() / measures.mean;
    let Measures { relative_rmse, bias, p99, .. } = measures;
    println!(
        "{name:14} rmse {:6.3} %  bias {:+6.3} %  p99 {:6.3} %  reference's own {:6.3} %",
        100.0 * relative_rmse,
        100.0 * bias,
        100.0 * p99,
        100.0 * own
    );
    measures
}

fn name(scene: &Path) -> String {
    scene.file_stem().unwrap().to_string_lossy().into_owned()
}

#[test]
fn direct_light_of_every_scene_is_right() {
    let mut failed = Vec::new();
    for path in scenes() {
        let cells = Scene::load(&path).unwrap().cells().unwrap();
        let light = solve(&cells, 1024, 0);
        let tracer = PathTracer {
            samples: 8192,
            bounces: Bounces::Count(0),
            wall_depth: 0.0,
            elevation: Settings::ELEVATION,
            seed: 1,
        };
        let name = name(&path);
        let allowed = if name == "dungeon" { DUNGEON } else { DIRECT };
        let measures = judge(&name, &cells, &light, tracer);
        if measures.relative_rmse > allowed {
            failed.push((name, measures.relative_rmse));
        }
    }
    assert!(failed.is_empty(), "beyond the bound: {failed:?}");
}

#[test]
fn bounced_light_of_every_scene_is_right() {
    let mut failed = Vec::new();
    for path in scenes() {
        let scene = Scene::load(&path).unwrap();
        let cells = scene.cells().unwrap();
        let light = solve(&cells, 1024, 2);
        let tracer = PathTracer {
            samples: 32_768,
            bounces: Bounces::Count(2),
            wall_depth: 0.0,
            elevation: Settings::ELEVATION,
            seed: 1,
        };
        let name = name(&path);
        let measures = judge(&name, &cells, &light, tracer);
        if measures.relative_rmse > BOUNCED {
            failed.push((name, measures.relative_rmse));
        }
    }
    assert!(failed.is_empty(), "beyond the bound: {failed:?}");
}

/// Share by which the light of a gliding lamp may change (the bound).
const GLIDE: f32 = 0.02;

#[test]
fn a_moving_lamp_keeps_its_light() {
    let mut cells = Cells::new(97, 61).unwrap();
    // Light falls off as 1/d, so the sum of light × distance over a ring is proportional to the lamp's light.
    let total = |cells: &Cells, [x, y]: [f32; 2]| {
        let light = solve(cells, 512, 0);
        let ring = (0..64).map(|i| {
            let (sin, cos) = (i as f32 * std::f32::consts::TAU / 64.0).sin_cos();
            let cell = [(x + 22.0 * cos) as u32, (y + 22.0 * sin) as u32];
            let d = (cell[0] as f32 + 0.5 - x).hypot(cell[1] as f32 + 0.5 - y);
            light.at(cell[0], cell[1])[0] * d
        });
        ring.sum::<f32>() / 64.0
    };
    for size in [0.5, 1.0, 2.0, 3.0] {
        let (mut low, mut high) = (f32::MAX, 0.0f32);
        for i in 0..10 {
            let at = [48.0 + i as f32 * 0.2, 30.0 + i as f32 * 0.14];
            *cells.lamps_mut() = vec![Lamp { position: at, size, ..Lamp::default() }];
            let total = total(&cells, at);
            (low, high) = (low.min(total), high.max(total));
        }
        let spread = (high - low) / low;
        println!("size {size}: {low:.5} to {high:.5}, spread {:.2} %", 100.0 * spread);
        assert!(spread < GLIDE, "a lamp of size {size} changes by {spread}");
    }
}

#[test]
fn light_that_lacks_a_bounce_is_rejected() {
    let path = scenes().into_iter().find(|p| name(p) == "two_rooms").unwrap();
    let cells = Scene::load(&path).unwrap().cells().unwrap();
    let light = solve(&cells, 512, 1);
    let tracer = PathTracer {
        samples: 4096,
        bounces: Bounces::Count(2),
        wall_depth: 0.0,
        elevation: Settings::ELEVATION,
        seed: 1,
    };
    assert!(judge("a bounce less", &cells, &light, tracer).relative_rmse > BOUNCED);
}
