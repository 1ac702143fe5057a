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
