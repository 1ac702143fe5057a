//! The mean over frames.

use crate::common::{device, raymarch_of};
use crate::compare::{middle, scenes};
use crate::direct::without_media;
use crate::frames::{FRAMES, frames_agree, moving};
use lamplight::settings::{Denoise, Hit, Raymarch, Temporal};
use lamplight::{Bounces, Direct, Lamp, Settings, Sun};

/// Rays a pixel. Of 8, those of a pixel whose first angle is 0 run along diagonals, through the very
/// corners of cells, and rounding decides which face they meet: 2 pixels of 2 million were off by 0.03
/// and 0.1 for that, and two passes of blur spread one of them over 39. Of 7, one ray of 10 million is such
/// a tie, in `cave`.
const RAYS: u32 = 11;

fn accumulating(reject: bool) -> Settings {
    let temporal = Temporal { history_length: 8, reject };
    let raymarch = Raymarch { temporal, rays: RAYS, ..Raymarch::default() };
    Settings { wall_depth: 2.0, ..Settings::direct(raymarch) }
}

#[test]
fn means_over_frames_agree() {
    let gpu = device();
    for [w, h] in [[1, 1], [1, 37], [41, 1], [31, 17], [97, 61]] {
        for reject in [false, true] {
            for (hit, bounces) in [(Hit::Edge, 0), (Hit::Edge, 2), (Hit::Distance, 1)] {
                let bounces = Bounces::Count(bounces);
                let mut settings = Settings { bounces, ..accumulating(reject) };
                raymarch_of(&mut settings).hit = hit;
                let name = format!("{w}×{h}, reject {reject}, {hit:?}, {bounces:?}");
                frames_agree(&gpu, &name, settings, (0..FRAMES).map(|n| moving(w, h, n)));
            }
        }
    }
}

#[test]
fn rays_that_tire_on_their_way_past_changes_agree() {
    let mut settings = accumulating(true);
    raymarch_of(&mut settings).steps = 5;
    raymarch_of(&mut settings).threshold = 0.15;
    raymarch_of(&mut settings).attenuation = true;
    settings.bounces = Bounces::Count(1);
    frames_agree(&device(), "5 steps", settings, (0..6).map(|n| moving(97, 61, n)));
}

#[test]
fn history_ends_where_exact_lights_go_out_and_stays_where_they_move() {
    let settings = Settings { bounces: Bounces::Count(1), ..accumulating(true) };
    let frames = (0..8u8).map(|n| {
        let mut cells = without_media(moving(48, 32, 0));
        let position = [20.0 + f32::from(n), 12.0];
        let lamp = Lamp { position, range: 40.0, direct: Direct::Exact, ..Lamp::default() };
        if n < 4 {
            cells.lamps_mut().push(lamp);
        }
        if n != 6 {
            cells.suns_mut().push(Sun { direction: 0.5 * f32::from(n), ..Sun::default() });
        }
        cells
    });
    frames_agree(&device(), "lights", settings, frames);
}

/// Everything at once over the scenes that people see first; lamps glide, and one wall comes and goes.
#[test]
fn means_agree_on_every_example_scene() {
    let gpu = device();
    for (number, (name, scene)) in scenes().into_iter().enumerate() {
        let mut settings = Settings {
            wall_depth: scene.resolve_settings().unwrap().wall_depth,
            ..accumulating(true)
        };
        raymarch_of(&mut settings).denoise = Denoise { passes: 2, strength: 1.0 };
        settings.bounces = if number % 2 == 1 { Bounces::Feedback } else { Bounces::Count(1) };
        let still = middle(&scene);
        let frames = (0..3).map(|n| {
            let mut cells = still.clone();
            cells.lamps_mut().iter_mut().for_each(|lamp| lamp.position[0] += n as f32);
            let at = cells.index(cells.width() / 3, cells.height() / 3);
            cells.opacity_mut()[at] = (n % 2) as f32;
            cells
        });
        frames_agree(&gpu, &name, settings, frames);
    }
}
