//! `polar`: every setting, scenes with lamps, and lamps that come and go.

use crate::common::{cells, device};
use crate::compare::{Both, SIZES, agree, scenes};
use crate::lamps::lamps;
use lamplight::settings::{Blend, Polar, ShadowFilter, Traversal};
use lamplight::{Cells, Falloff, Lamp, Matter, Settings};
use lamplight_wgpu::Stage;

fn polar(polar: Polar) -> Settings {
    Settings { wall_depth: 2.0, ..Settings::direct(polar) }
}

fn lit(width: u32, height: u32, count: u32, seed: u64) -> Cells {
    let mut cells = cells(width, height, seed);
    *cells.lamps_mut() = lamps(width, height, count, seed + 1);
    cells
}

#[test]
fn polar_agrees_at_every_size_with_every_preset() {
    let gpu = device();
    for preset in Polar::PRESETS {
        let mut both = Both::new(&gpu, polar(Polar::preset(preset).unwrap()));
        for [w, h] in SIZES {
            both.agree(&gpu, &format!("{preset} at {w}×{h}"), &lit(w, h, 12, 31));
        }
    }
}

#[test]
fn polar_agrees_with_every_setting() {
    let gpu = device();
    let cells = lit(127, 61, 14, 41);
    for traversal in [Traversal::Edge, Traversal::Step, Traversal::Distance] {
        for (shadow_filter, translucent) in [
            (ShadowFilter::Soft, true),
            (ShadowFilter::Linear, true),
            (ShadowFilter::Nearest, true),
            (ShadowFilter::Soft, false),
        ] {
            let settings = Polar { traversal, shadow_filter, translucent, ..Polar::default() };
            let name = format!("{traversal:?}, {shadow_filter:?}, translucent: {translucent}");
            agree(&gpu, &name, &cells, polar(settings));
        }
    }
    for (blend, falloff) in [
        (Blend::Add, Falloff::Linear),
        (Blend::Max, Falloff::Smooth),
        (Blend::Screen, Falloff::Inverse),
    ] {
        let settings = Polar { blend, falloff: Some(falloff), ..Polar::default() };
        agree(&gpu, &format!("{blend:?}, {falloff:?}"), &cells, polar(settings));
    }
    for density in [0.25, 0.7, 8.0] {
        let settings = Polar { density, ..Polar::default() };
        agree(&gpu, &format!("density {density}"), &cells, polar(settings));
    }
}

#[test]
fn polar_agrees_beside_walls_that_lamps_graze() {
    let gpu = device();
    let (width, height) = (160, 60);
    let mut cells = Cells::new(width, height).unwrap();
    for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
        let frame = x == 0 || y == 0 || x + 1 == width || y + 1 == height;
        let bars = x % 40 == 20 && y > 56;
        if frame || bars {
            cells.set(x, y, Matter { opacity: 1.0, ..Matter::EMPTY });
        }
    }
    // Above the floor, in the middle of a cell, within the floor with a part, and near corners.
    let lamps = [([50.4, 25.6], 3.0), ([70.5, 30.5], 3.0), ([110.3, 57.7], 4.0), ([3.2, 3.6], 2.0)];
    for (position, size) in lamps {
        let lamp = Lamp { position, size, range: 200.0, ..Lamp::default() };
        cells.lamps_mut().push(lamp);
    }
    for density in [0.5, 1.0] {
        for shadow_filter in [ShadowFilter::Soft, ShadowFilter::Linear] {
            let settings = Polar { density, shadow_filter, ..Polar::default() };
            agree(&gpu, &format!("density {density}, {shadow_filter:?}"), &cells, polar(settings));
        }
    }
}

#[test]
fn polar_agrees_on_every_example_scene_with_lamps() {
    let gpu = device();
    let mut presets: Vec<_> = Polar::PRESETS
        .iter()
        .map(|preset| (preset, Both::new(&gpu, polar(Polar::preset(preset).unwrap()))))
        .collect();
    let mut lit = 0;
    for (name, scene) in scenes() {
        let cells = scene.cells().unwrap();
        if !cells.lamps().is_empty() {
            lit += 1;
            for (preset, both) in &mut presets {
                both.agree(&gpu, &format!("{name}, {preset}"), &cells);
            }
        }
    }
    assert!(lit >= 7);
}

#[test]
fn curves_that_find_no_room_in_the_store_are_traced_again() {
    let gpu = device();
    let mut cells = Cells::new(96, 64).unwrap();
    for i in 0..cells.len() {
        let opacity = [0.0, 0.02, 0.05][i * 7919 / 31 % 3];
        cells.set_matter(i, Matter { opacity, ..Matter::EMPTY });
    }
    *cells.lamps_mut() = lamps(96, 64, 9, 51);
    for traversal in [Traversal::Edge, Traversal::Distance] {
        for shadow_filter in [ShadowFilter::Soft, ShadowFilter::Nearest] {
            let settings = Polar { traversal, shadow_filter, ..Polar::default() };
            agree(
                &gpu,
                &format!("specks of fog, {traversal:?}, {shadow_filter:?}"),
                &cells,
                polar(settings),
            );
        }
    }
}

#[test]
fn lamps_come_and_go_and_buffers_of_the_host_stay_valid() {
    let gpu = device();
    let mut both = Both::new(&gpu, polar(Polar::default()));
    let mut cells = cells(120, 70, 61);
    let mut all = lamps(120, 70, 640, 62);
    for lamp in &mut all {
        // Mesa's software GPU ends all loops of a pixel after 65 535 turns altogether.
        lamp.range = 1.0 + 0.3 * lamp.range;
        // Of 640 lamps, a few would look along a line through exact corners (`TIES`).
        lamp.position = lamp.position.map(|v| v + 0.1234);
    }
    let mut light = None;
    let mut sizes = Vec::new();
    // More than a tile looks at together, one, and then one by one.
    for count in [3, 600, 1].into_iter().chain((600..640).step_by(20)) {
        cells.lamps_mut().clear();
        cells.lamps_mut().extend_from_slice(&all[..count]);
        both.agree(&gpu, &format!("{count} lamps"), &cells);
        let buffer = both.lighting.stage(Stage::Light).unwrap().clone();
        assert_eq!(*light.get_or_insert(buffer.clone()), buffer, "the light lies elsewhere");
        sizes.push(both.lighting.cost().unwrap().memory);
    }
    sizes.dedup();
    println!("bytes: {sizes:?}");
    assert!(sizes.len() <= 3, "reallocated too often");
}
