//! `cascades`, by both merges.

use crate::common::{cells, device, device_with};
use crate::compare::{SIZES, agree, agree_but_for, scenes};
use lamplight::settings::{Cascades, Merge};
use lamplight::{Bounces, Cells, Gradient, Scene, Settings, Sky};

/// Share of pixels that may be off with the plain merge where light bounces: ties between two faces of
/// walls. All its probes send the same rays, and ray 106 of the 256 of the third further cascade passes
/// 9e-6 px from the corner 44 px to the left and 26 px below every probe, nearer than 32 bits resolve
/// (3e-5 px at x = 440). Which side that is depends on how a compiler orders sums, and some 250 pixels
/// read each probe. Measured at 8.6e-4 in `dungeon` (126 pixels, by up to 3.7e-3) and 3.5e-5 in
/// `night_street` (2 pixels, by 1.4e-3), otherwise none.
const TIES: f64 = 1e-3;
/// The fraction with the bilinear fix on a large grid of random cells, many of whose corners some ray
/// passes as closely. Measured at 2e-5 (3 pixels of 147 456, by 1.03e-3).
const TIES_OF_LARGE_GRIDS: f64 = 1e-4;

fn cascades(change: impl FnOnce(&mut Cascades)) -> Settings {
    let mut cascades = Cascades::default();
    change(&mut cascades);
    Settings::direct(cascades)
}

#[test]
fn cascades_agree_at_every_size() {
    let gpu = device();
    for [w, h] in SIZES {
        let is_large = w * h > 1 << 15;
        let ties = if is_large { TIES_OF_LARGE_GRIDS } else { 0.0 };
        // The largest takes seconds a gather.
        let bounces: &[u32] = if is_large { &[1] } else { &[0, 2] };
        for bounces in bounces.iter().copied().map(Bounces::Count) {
            let settings = Settings { wall_depth: 3.0, bounces, ..cascades(|_| ()) };
            let name = format!("{w}×{h}, {bounces:?}");
            agree_but_for(ties, &gpu, &name, &cells(w, h, 3), settings);
        }
    }
}

#[test]
fn cascades_agree_with_every_setting() {
    let gpu = device();
    let cells = cells(97, 61, 5);
    let all = |name: &str, change: &dyn Fn(&mut Cascades)| {
        for merge in [Merge::Plain, Merge::BilinearFix] {
            let settings = cascades(|c| {
                c.merge = merge;
                change(c);
            });
            let settings = Settings { bounces: Bounces::Count(1), ..settings };
            agree(&gpu, &format!("{merge:?}, {name}"), &cells, settings);
        }
    };
    for rays in [4, 16, 64] {
        all(&format!("{rays} rays"), &|c| c.rays = rays);
    }
    for interval in [0.25, 64.0] {
        all(&format!("interval {interval}"), &|c| (c.rays, c.interval) = (4, interval));
    }
    for spacing in [0.5, 1.7, 8.0] {
        all(&format!("spacing {spacing}"), &|c| c.spacing = spacing);
    }
    for overlap in [0.3, 1.0] {
        all(&format!("overlap {overlap}"), &|c| c.overlap = overlap);
    }
}

#[test]
fn cones_in_batches_add_up() {
    let max_storage_buffer_binding_size = 400 << 10;
    let gpu = device_with(|limits| {
        limits.max_storage_buffer_binding_size = max_storage_buffer_binding_size
    });
    let cells = cells(97, 61, 5);
    for (preset, batches) in [("default", 2), ("high", 8)] {
        let settings = cascades(|c| *c = Cascades::preset(preset).unwrap());
        let settings = Settings { bounces: Bounces::Count(1), ..settings };
        agree(&gpu, &format!("{preset} in {batches} batches"), &cells, settings);
    }
}

#[test]
fn cascades_agree_under_a_sky_that_changes() {
    let mut cells = cells(61, 43, 9);
    let [zenith, horizon, ground] = [[0.1, 0.4, 2.0], [1.0, 0.8, 0.2], [0.05, 0.0, 0.0]];
    cells.set_sky(Sky::Gradient(Gradient { zenith, horizon, ground }));
    agree(&device(), "sky", &cells, cascades(|_| ()));
}

/// Every `step`th cell of a scene, in both directions. Lamps are solid, as in the scenes for which the ties were
/// measured; `glow` holds those that glow to the CPU.
fn sampled(scene: &Scene, step: u32) -> Cells {
    let mut cells = scene.cells().unwrap();
    cells.lamps_mut().iter_mut().for_each(|lamp| lamp.solid = true);
    cells.draw_lamps();
    let [width, height] = [cells.width(), cells.height()].map(|side| side.div_ceil(step));
    let mut some = Cells::new(width, height).unwrap();
    some.set_sky(cells.sky().clone());
    for i in 0..some.len() {
        let [x, y] = [i as u32 % width * step, i as u32 / width * step];
        some.set_matter(i, cells.matter((y * cells.width() + x) as usize));
    }
    some
}

#[test]
fn cascades_agree_on_every_example_scene() {
    let gpu = device();
    for (name, scene) in scenes() {
        let wall_depth = scene.resolve_settings().unwrap().wall_depth;
        // Finer cascades take more time, and so fewer cells.
        for (preset, step) in [("plain", 2), ("default", 4), ("high", 7)] {
            let cells = sampled(&scene, step);
            for bounces in [0, 2].map(Bounces::Count) {
                let settings = cascades(|c| *c = Cascades::preset(preset).unwrap());
                let settings = Settings { wall_depth, bounces, ..settings };
                let ties =
                    if preset == "plain" && bounces != Bounces::Count(0) { TIES } else { 0.0 };
                let name = format!("{name}, {preset}, {bounces:?}");
                agree_but_for(ties, &gpu, &name, &cells, settings);
            }
        }
    }
}
