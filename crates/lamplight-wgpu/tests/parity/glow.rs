//! Cells that glow, and lamps that are drawn as such.

use crate::common::{cells, device, seeded};
use crate::compare::agree;
use lamplight::settings::{Cascades, Flood, Holographic, MethodSettings, Raymarch};
use lamplight::{Bounces, Cells, Lamp, Matter, Rgb, Settings};

/// Random cells, some of which glow: empty ones, fog, glass, and solid ones, which do not show it; and lamps.
fn fires(width: u32, height: u32) -> Cells {
    let mut cells = cells(width, height, 4);
    let mut random = seeded(5);
    for _ in 0..width * height / 40 + 1 {
        let i = random.usize(..cells.len());
        let glow: Rgb = std::array::from_fn(|_| random.f32());
        cells.set_matter(i, Matter { glow, ..cells.matter(i) });
    }
    for i in 0..4 {
        let position = [width, height].map(|side| side as f32 * random.f32());
        let size = 0.3 + i as f32;
        cells.lamps_mut().push(Lamp { position, size, solid: i == 1, ..Lamp::default() });
    }
    cells
}

#[test]
fn glow_agrees_with_every_method() {
    let gpu = device();
    let of = |preset| Holographic::preset(preset).unwrap().into();
    let methods: [(&str, MethodSettings); 7] = [
        ("raymarch", Raymarch::default().into()),
        ("raymarch, by distance", Raymarch::preset("unity").unwrap().into()),
        ("cascades", Cascades::default().into()),
        ("cascades, plain", Cascades::preset("plain").unwrap().into()),
        ("holographic", of("default")),
        ("holographic, paper", of("paper")),
        ("flood", Flood::default().into()),
    ];
    for [width, height] in [[1, 1], [41, 1], [61, 43], [97, 64]] {
        let cells = fires(width, height);
        for (name, method) in &methods {
            for bounces in [0, 1].map(Bounces::Count) {
                let settings = Settings { bounces, ..Settings::direct(method.clone()) };
                agree(&gpu, &format!("{name}, {bounces:?}, {width}×{height}"), &cells, settings);
            }
        }
    }
}
