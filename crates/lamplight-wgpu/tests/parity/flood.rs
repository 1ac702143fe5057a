//! `flood`: every setting, scenes, and frame after frame.

use crate::common::{cells, device};
use crate::compare::{Both, SIZES, middle, scenes};
use crate::lamps::lamps;
use lamplight::settings::{Fade, Flood, Sweeps};
use lamplight::{Gradient, Settings, Sky};

/// One of the settings changed.
type Change = fn(&mut Flood);
/// Frames that are compared one after the other.
const FRAMES: u32 = 3;

fn flood(flood: Flood) -> Settings {
    Settings { wall_depth: 2.0, ..Settings::direct(flood) }
}

#[test]
fn flood_agrees_at_every_size_with_every_preset() {
    let gpu = device();
    for preset in Flood::PRESETS {
        let mut both = Both::new(&gpu, flood(Flood::preset(preset).unwrap()));
        for [w, h] in SIZES {
            let mut cells = cells(w, h, 71);
            *cells.lamps_mut() = lamps(w, h, 12, 72);
            for number in 0..FRAMES {
                both.agree(&gpu, &format!("{preset} at {w}×{h}, frame {number}"), &cells);
            }
        }
    }
}

#[test]
fn flood_agrees_with_every_setting() {
    let gpu = device();
    let mut cells = cells(97, 61, 73);
    *cells.lamps_mut() = lamps(97, 61, 12, 74);
    let [zenith, horizon, ground] = [[0.1, 0.4, 2.0], [1.0, 0.8, 0.2], [0.05, 0.0, 0.0]];
    cells.set_sky(Sky::Gradient(Gradient { zenith, horizon, ground }));
    let changes: [(&str, Change); 8] = [
        ("one ray", |s| s.rays = 1),
        ("many rays", |s| s.rays = 301),
        ("no matter", |s| s.matter_rays = 0),
        ("no bounce", |s| s.bounce_rays = 0),
        ("no blur", |s| s.rounds = 0),
        ("no decay", |s| s.decay = 0.0),
        ("seed's fading", |s| s.fade = Fade::Seed),
        ("seed's sweeps", |s| s.sweeps = Sweeps::Seed),
    ];
    for (name, change) in changes {
        let mut settings = Flood::default();
        change(&mut settings);
        let mut both = Both::new(&gpu, flood(settings));
        for number in 0..FRAMES {
            both.agree(&gpu, &format!("{name}, frame {number}"), &cells);
        }
    }
}

#[test]
fn flood_agrees_on_every_example_scene() {
    let gpu = device();
    let mut both = Both::new(&gpu, flood(Flood::default()));
    for (name, scene) in scenes() {
        let cells = middle(&scene);
        for number in 0..FRAMES {
            both.agree(&gpu, &format!("{name}, frame {number}"), &cells);
        }
    }
}

#[test]
fn light_stays_as_lamps_move_come_and_go_until_the_size_changes() {
    let gpu = device();
    let mut both = Both::new(&gpu, flood(Flood { decay: 0.02, ..Flood::default() }));
    let mut cells = cells(64, 40, 75);
    let all = lamps(64, 40, 90, 76);
    for number in 0..20 {
        let count = [2, 90, 0, 30][number / 5];
        cells.lamps_mut().clear();
        cells.lamps_mut().extend(all[..count].iter().cloned().map(|mut lamp| {
            lamp.position[0] += number as f32;
            lamp
        }));
        both.agree(&gpu, &format!("frame {number}"), &cells);
    }
    let other = crate::common::cells(40, 64, 77);
    both.agree(&gpu, "another size", &other);
    both.agree(&gpu, "back again", &cells);
}
