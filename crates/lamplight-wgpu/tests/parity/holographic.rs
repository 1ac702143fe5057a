//! `holographic`, every preset.

use crate::common::{cells, device};
use crate::compare::{SIZES, agree, scenes};
use lamplight::settings::Holographic;
use lamplight::{Bounces, Cells, Gradient, Matter, Method, Settings, Sky};

fn holographic(preset: &str) -> Settings {
    let mut settings = Settings { method: Method::Holographic, ..Settings::default() };
    settings.holographic = Holographic::preset(preset).unwrap();
    settings
}

/// Solid matter alone, some of it glowing: no fog, no tint.
fn solid(width: u32, height: u32, seed: u64) -> Cells {
    let mut cells = cells(width, height, seed);
    for i in 0..cells.len() {
        let matter = cells.matter(i);
        if matter.opacity < 1.0 {
            cells.set_matter(i, Matter::EMPTY);
        }
    }
    cells
}

#[test]
fn direct_light_agrees_at_every_size() {
    let gpu = device();
    for [w, h] in SIZES {
        for preset in ["default", "fast"] {
            let name = format!("{preset} at {w}×{h}");
            agree(&gpu, &format!("{name}, walls"), &solid(w, h, 3), holographic(preset));
            agree(&gpu, &name, &cells(w, h, 3), holographic(preset));
        }
    }
}

#[test]
fn every_preset_agrees_with_bounces_and_under_any_sky() {
    let gpu = device();
    let [zenith, horizon, ground] = [[0.1, 0.4, 2.0], [1.0, 0.8, 0.2], [0.05, 0.0, 0.0]];
    let gradient = Sky::Gradient(Gradient { zenith, horizon, ground });
    for preset in ["default", "fast", "quality"] {
        for (bounces, [w, h], sky) in [
            (0, [45, 70], gradient),
            (1, [61, 43], Sky::Uniform([0.2; 3])),
            (3, [40, 77], Sky::Uniform([0.0; 3])),
        ] {
            let mut settings = holographic(preset);
            settings.bounces = Bounces::Count(bounces);
            settings.wall_depth = 2.5;
            let name = format!("{preset}, {bounces} bounces");
            for mut cells in [cells(w, h, 17), solid(w, h, 19)] {
                cells.set_sky(sky);
                agree(&gpu, &name, &cells, settings.clone());
            }
        }
    }
}

#[test]
fn every_setting_agrees() {
    let gpu = device();
    let cells = cells(53, 37, 23);
    for (hop, least, rays, beams) in [(1, 16, 1, 1), (2, 1, 3, 16), (3, 5, 16, 3), (4, 16, 2, 8)] {
        let mut settings = holographic("default");
        settings.holographic = Holographic { hop, least, rays, beams, ..settings.holographic };
        agree(&gpu, &format!("{:?}", settings.holographic), &cells, settings);
    }
}

#[test]
fn every_example_scene_agrees() {
    let gpu = device();
    for (name, scene) in scenes() {
        let cells = scene.cells().unwrap();
        for bounces in [0, 2].map(Bounces::Count) {
            let settings = Settings { bounces, ..scene.settings().unwrap() };
            let settings =
                Settings { bounces, wall_depth: settings.wall_depth, ..holographic("default") };
            agree(&gpu, &format!("{name}, {bounces:?}"), &cells, settings);
        }
    }
}
