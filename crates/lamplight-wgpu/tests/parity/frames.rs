//! Many frames on both, one after the other, with matter that moves.

use crate::common::{cells, device, frame, lighting, raymarch_of};
use crate::compare::{TIES, allowed, differences, wrong};
use lamplight::settings::{Hit, Raymarch, Temporal};
use lamplight::{Bounces, Cells, Lamp, Matter, Rgb, Settings, Sky, Solver};
use lamplight_wgpu::Lighting;
use wgpu::{Device, Queue};

/// Frames of a run: more than feedback takes to forget.
pub const FRAMES: u32 = 12;

/// The cells of one of many frames: [`cells`] at rest; a light, a lamp, a wall and a puff of fog on the
/// move, all still in every third frame; and a wall that turns black.
pub fn moving(width: u32, height: u32, number: u32) -> Cells {
    let mut cells = cells(width, height, 3);
    let at = number - number / 3;
    let mut put = |from: [u32; 2], size: [u32; 2], matter: Matter| {
        for y in from[1]..from[1] + size[1] {
            for x in from[0]..from[0] + size[0] {
                cells.set(x % width, y % height, matter);
            }
        }
    };
    let solid = Matter { opacity: 1.0, ..Matter::EMPTY };
    put([3 + 2 * at, 5], [3, 2], Matter { emission: [9.0, 6.0, 3.0], ..solid });
    put([width / 2, at], [2, 6], Matter { albedo: [0.7; 3], ..solid });
    put([7, height / 2 + at], [5, 4], Matter { opacity: 0.2, albedo: [0.6; 3], ..Matter::EMPTY });
    let albedo = if number < 6 { [0.9, 0.5, 0.1] } else { [0.0; 3] };
    put([width / 3, height / 3], [4, 4], Matter { albedo, ..solid });
    let position = [0.8 * width as f32, 0.2 * height as f32 + 0.3 * at as f32];
    cells.lamps_mut().push(Lamp { position, size: 1.5, intensity: 4.0, ..Lamp::default() });
    cells
}

/// `raymarch` with a mean over frames that drops what changed, and feedback.
fn remembering() -> Settings {
    let temporal = Temporal { history_length: 8, reject: true };
    let raymarch = Raymarch { temporal, rays: 8, ..Raymarch::default() };
    Settings { bounces: Bounces::Feedback, ..Settings::direct(raymarch) }
}

fn lit(
    (device, queue): &(Device, Queue),
    lighting: &mut Lighting,
    settings: &Settings,
    cells: &Cells,
) -> Vec<Rgb> {
    let seen = frame(device, queue, lighting, settings, cells);
    seen.into_iter().map(|[r, g, b, _]| [r, g, b]).collect()
}

/// Light of frames, one after the other, on the GPU and on the CPU.
fn light_of_frames(
    gpu: &(Device, Queue),
    settings: Settings,
    frames: impl Iterator<Item = [Cells; 2]>,
) -> Vec<[Vec<Rgb>; 2]> {
    let mut solver = Solver::new(settings.clone()).unwrap();
    let mut lighting = lighting(&gpu.0, &gpu.1);
    frames
        .map(|[seen, right]| {
            let right = solver.solve(&right).unwrap().pixels().to_vec();
            [lit(gpu, &mut lighting, &settings, &seen), right]
        })
        .collect()
}

/// Holds each of many frames to the CPU.
#[track_caller]
pub fn frames_agree(
    gpu: &(Device, Queue),
    name: &str,
    settings: Settings,
    frames: impl Iterator<Item = Cells>,
) {
    let by_distance = |raymarch: &Raymarch| raymarch.hit == Hit::Distance;
    let ties = if settings.method.as_raymarch().is_some_and(by_distance) { TIES } else { 0.0 };
    let [ties, _] = allowed(ties, settings.method());
    let (mut worst, mut most) = (0.0f64, 0.0f64);
    let both = frames.map(|cells| [cells.clone(), cells]);
    for [seen, right] in light_of_frames(gpu, settings, both) {
        worst = differences(&seen, &right).into_iter().fold(worst, f64::max);
        most = most.max(wrong(&seen, &right) as f64 / right.len() as f64);
    }
    println!("{name}: {worst:.1e}, at most {most:.1e} of the pixels of a frame wrong");
    assert!(most <= ties, "{name}: {most:e} of the pixels, {worst:e}");
}

#[test]
fn a_wrong_frame_in_history_is_rejected() {
    let gpu = device();
    let [w, h] = [61, 43];
    let mean =
        |s: &mut Settings| (s.bounces, raymarch_of(s).temporal.reject) = (Bounces::Count(0), false);
    let feedback = |s: &mut Settings| raymarch_of(s).temporal.history_length = 0;
    for change in [mean as fn(&mut _), feedback] {
        let mut settings = remembering();
        change(&mut settings);
        // The GPU is shown the fourth frame twice, and never the fifth.
        let frames = (0..7u32).map(|n| [if n == 4 { 3 } else { n }, n].map(|n| moving(w, h, n)));
        let wrong: Vec<_> = light_of_frames(&gpu, settings, frames)
            .iter()
            .map(|[seen, right]| wrong(seen, right))
            .collect();
        println!("wrong pixels by frame: {wrong:?}");
        assert!(wrong[..4].iter().all(|&wrong| wrong == 0));
        assert!(wrong[5] > 0 && wrong[6] > 0, "only history differs: {wrong:?}");
    }
}

#[test]
fn another_size_or_another_sky_drops_history_as_on_the_cpu() {
    let gpu = device();
    let sizes = [[61, 43], [61, 43], [43, 61], [43, 61], [61, 43], [61, 43]];
    let frames = (0..).zip(sizes).map(|(n, [w, h])| moving(w, h, n));
    frames_agree(&gpu, "sizes", remembering(), frames);
    for reject in [true, false] {
        let mut settings = remembering();
        raymarch_of(&mut settings).temporal.reject = reject;
        let frames = (0..FRAMES).map(|n| {
            let mut cells = moving(61, 43, n);
            cells.set_sky(Sky::Uniform([0.1 * (n / 4) as f32; 3]));
            cells
        });
        frames_agree(&gpu, &format!("skies, reject {reject}"), settings, frames);
    }
}

#[test]
fn nothing_is_left_after_a_reset() {
    let gpu = device();
    for hit in [Hit::Edge, Hit::Distance] {
        let mut settings = remembering();
        raymarch_of(&mut settings).hit = hit;
        let mut lighting = lighting(&gpu.0, &gpu.1);
        let mut run = || -> Vec<_> {
            lighting.reset();
            (0..5).map(|n| lit(&gpu, &mut lighting, &settings, &moving(61, 43, n))).collect()
        };
        assert_eq!(run(), run());
    }
}
