//! Light that bounces from frame to frame, and until it has converged.

use crate::common::{cells, device, frame, lighting, raymarch_of};
use crate::compare::{Both, agree, agrees, allowed, differences, wrong};
use crate::frames::{FRAMES, frames_agree, moving};
use lamplight::settings::{Holographic, MethodSettings, Raymarch, Variant};
use lamplight::{Bounces, Cells, Matter, Method, Rgb, Settings, Sky, Solver};
use lamplight_wgpu::Lighting;
use wgpu::{Device, Queue};

fn raymarch(preset: &str, bounces: Bounces) -> Settings {
    let preset = Raymarch::preset(preset).unwrap();
    Settings { bounces, ..Settings::direct(Raymarch { rays: 16, ..preset }) }
}

#[test]
fn feedback_agrees_frame_by_frame() {
    let gpu = device();
    for [w, h] in [[1, 1], [1, 37], [31, 17], [61, 43]] {
        for preset in Raymarch::PRESETS {
            for frames in [0, 8] {
                let mut settings = raymarch(preset, Bounces::Feedback);
                raymarch_of(&mut settings).temporal.history_length = frames;
                let name = format!("{preset} at {w}×{h}, mean over {frames}");
                frames_agree(&gpu, &name, settings, (0..FRAMES).map(|n| moving(w, h, n)));
            }
        }
    }
}

#[test]
fn feedback_of_methods_without_noise_agrees_frame_by_frame() {
    let gpu = device();
    let feeds_back = |settings: &Settings| {
        settings.method.as_raymarch().is_none()
            && settings.method.bounces(Bounces::Feedback) == Bounces::Feedback
    };
    for (name, settings) in methods(Bounces::Feedback) {
        if !feeds_back(&settings) {
            continue;
        }
        for [w, h] in [[1, 1], [1, 37], [31, 17], [97, 61]] {
            let frames = (0..FRAMES).map(|n| moving(w, h, n));
            frames_agree(&gpu, &format!("{name} at {w}×{h}"), settings.clone(), frames);
        }
        let sizes = [[61, 43], [61, 43], [43, 61], [43, 60], [61, 43], [61, 43]];
        let frames = (0..).zip(sizes).map(|(n, [w, h])| moving(w, h, n));
        frames_agree(&gpu, &format!("{name}, sizes"), settings.clone(), frames);
        // Fog comes in place of a wall, and a wall in place of fog.
        let frames = (0..6).map(|n| {
            let mut cells = bright_room(true, true);
            let fog = Matter { opacity: 0.1, albedo: [0.9; 3], ..Matter::EMPTY };
            let wall = Matter { opacity: 1.0, albedo: [0.8; 3], ..Matter::EMPTY };
            cells.set(5, 10, if n < 3 { wall } else { fog });
            cells.set(25, 10, if n < 3 { fog } else { wall });
            cells
        });
        frames_agree(&gpu, &format!("{name}, fog for walls"), settings, frames);
    }
}

#[test]
fn converged_light_agrees() {
    let gpu = device();
    for [w, h] in [[1, 1], [1, 37], [31, 17], [61, 43]] {
        for preset in Raymarch::PRESETS {
            let settings = raymarch(preset, Bounces::Converged);
            agree(&gpu, &format!("{preset} at {w}×{h}"), &cells(w, h, 7), settings);
        }
    }
    let mut settings = raymarch("default", Bounces::Converged);
    raymarch_of(&mut settings).temporal.history_length = 8;
    frames_agree(&gpu, "with a mean", settings, (0..4).map(|n| moving(31, 17, n)));
}

/// The methods that light bounces in: `raymarch`, and those without noise.
fn methods(bounces: Bounces) -> Vec<(String, Settings)> {
    let of = |method, preset: &str| {
        let settings = MethodSettings::preset(method, preset).unwrap();
        (format!("{method:?}, {preset}"), Settings { bounces, ..Settings::direct(settings) })
    };
    let mut all = vec![("Raymarch".into(), raymarch("default", bounces))];
    all.extend(["default", "plain"].map(|preset| of(Method::Cascades, preset)));
    all.extend(["default", "paper"].map(|preset| of(Method::Holographic, preset)));
    all
}

/// A room in which light goes on for a while: with fog that scatters it, and with a pane of glass.
fn bright_room(fog: bool, tinted: bool) -> Cells {
    let mut cells = Cells::new(33, 21).unwrap();
    let wall = Matter { opacity: 1.0, albedo: [0.8, 0.7, 0.6], ..Matter::EMPTY };
    for y in 0..21 {
        for x in 0..33 {
            if x % 32 == 0 || y % 20 == 0 {
                cells.set(x, y, wall);
            } else if fog && x > 20 {
                cells.set(x, y, Matter { opacity: 0.1, albedo: [0.9; 3], ..Matter::EMPTY });
            } else if tinted && x == 15 {
                cells.set(x, y, Matter { tint: [0.9, 1.0, 0.8], ..Matter::EMPTY });
            }
        }
    }
    cells.set(9, 7, Matter { emission: [5.0; 3], ..wall });
    cells
}

/// The light of the CPU with lamps a little darker, as they are, and a little brighter. Intervals
/// have 8 significant bits: by a millionth more light, `holographic` changes that of a pixel in a bright room full of fog by
/// up to 1.5e-3, as the radiance of all of it is rounded up a round earlier. Nothing of frames before is in its light.
fn around(settings: &Settings, cells: &Cells) -> [Vec<Rgb>; 5] {
    [-1e-4, -1e-5, 0.0, 1e-5, 1e-4].map(|more| {
        let mut cells = cells.clone();
        cells.emission_mut().as_flattened_mut().iter_mut().for_each(|v| *v *= 1.0 + more);
        Solver::new(settings.clone()).unwrap().solve(&cells).unwrap().pixels().to_vec()
    })
}

/// The light between several that is nearest to another.
fn nearest(lights: &[Vec<Rgb>; 5], seen: &[Rgb]) -> Vec<Rgb> {
    let component = |i: usize, c: usize| {
        let found = lights.each_ref().map(|light| light[i][c]);
        seen[i][c].clamp(
            found.into_iter().fold(f32::INFINITY, f32::min),
            found.into_iter().fold(0.0, f32::max),
        )
    };
    (0..seen.len()).map(|i| [0, 1, 2].map(|c| component(i, c))).collect()
}

#[track_caller]
fn agree_where_rounding_decides(gpu: &(Device, Queue), both: &mut Both, name: &str, cells: &Cells) {
    let is_rounded = |settings: &Holographic| settings.variant == Variant::Bundles;
    if !matches!(&both.solver.settings().method, MethodSettings::Holographic(s) if is_rounded(s)) {
        return both.agree(gpu, name, cells);
    }
    let [seen, _] = both.light(gpu, cells);
    let settings = both.solver.settings();
    let lights = around(settings, cells);
    agrees(name, &seen, &nearest(&lights, &seen), allowed(0.0, settings.method()));
    let brighter: Vec<Rgb> = seen.iter().map(|rgb| rgb.map(|v| 1.005 * v)).collect();
    assert!(wrong(&brighter, &nearest(&lights, &brighter)) > 0, "{name}: more light passes");
}

#[test]
fn every_method_converges_frame_by_frame() {
    let gpu = device();
    for (name, settings) in methods(Bounces::Converged) {
        let mut both = Both::new(&gpu, settings);
        for [w, h] in [[1, 1], [1, 37], [31, 17]] {
            both.agree(&gpu, &format!("{name} at {w}×{h}"), &cells(w, h, 7));
        }
        for (fog, tinted) in [(false, false), (false, true), (true, false), (true, true)] {
            let mut cells = bright_room(fog, tinted);
            let name = format!("{name}, fog: {fog}, tint: {tinted}");
            agree_where_rounding_decides(&gpu, &mut both, &name, &cells);
            // Nothing of the frame before is left.
            cells.set(9, 7, Matter { emission: [0.0, 0.2, 3.0], opacity: 1.0, ..Matter::EMPTY });
            let name = format!("{name}, another light");
            agree_where_rounding_decides(&gpu, &mut both, &name, &cells);
        }
        // Nothing that reflects light, then nothing that is lit.
        let mut dark = Cells::new(20, 13).unwrap();
        dark.set(7, 5, Matter { emission: [2.0; 3], opacity: 1.0, ..Matter::EMPTY });
        both.agree(&gpu, &format!("{name}, black"), &dark);
        dark.set(7, 5, Matter { opacity: 1.0, albedo: [0.5; 3], ..Matter::EMPTY });
        dark.set_sky(Sky::BLACK);
        both.agree(&gpu, &format!("{name}, dark"), &dark);
    }
}

/// Rounds by which both may end apart. In `holographic` rounding decides now and then how many rays a
/// pixel sends; light that comes and goes with them is a change, too.
fn slack(settings: &Settings) -> u32 {
    u32::from(settings.method() == Method::Holographic)
}

#[test]
fn rounds_end_where_the_cpu_ends_them() {
    let (device, queue) = device();
    let cells = bright_room(false, true);
    for (name, settings) in methods(Bounces::Converged) {
        let cpu = |bounces| {
            let mut solver = Solver::new(Settings { bounces, ..settings.clone() }).unwrap();
            solver.solve(&cells).unwrap().pixels().to_vec()
        };
        let right = cpu(Bounces::Converged);
        let rounds = (1..100).find(|&n| cpu(Bounces::Count(n)) == right).unwrap();

        let gpu = |bounces| {
            let settings = Settings { bounces, ..settings.clone() };
            let mut lighting = lighting(&device, &queue);
            // Two frames: the second one restarts.
            [(), ()].map(|()| frame(&device, &queue, &mut lighting, &settings, &cells))
        };
        let seen = gpu(Bounces::Converged);
        let near = [rounds, rounds - 1, rounds + 1];
        // Equal to that number of bounces, bit by bit: bounces that are skipped do nothing.
        let here = near.into_iter().find(|&n| gpu(Bounces::Count(n)) == seen);
        println!("{name}: {rounds} rounds on the CPU, {here:?} on the GPU");
        let apart = here.map_or(u32::MAX, |here| here.abs_diff(rounds));
        assert!(rounds > 10 && apart <= slack(&settings), "{name}: {rounds}, but {here:?}");
    }
}

#[test]
fn rounds_in_fog_end_where_the_cpu_ends_them() {
    let gpu = device();
    let cells = bright_room(true, true);
    let exact = |settings: &Settings| slack(settings) == 0;
    for (name, settings) in methods(Bounces::Converged).into_iter().filter(|(_, s)| exact(s)) {
        let worst =
            |seen: &[Rgb], right: &[Rgb]| differences(seen, right).into_iter().fold(0.0, f64::max);
        let after = |bounces| {
            let mut solver = Solver::new(Settings { bounces, ..settings.clone() }).unwrap();
            solver.solve(&cells).unwrap().pixels().to_vec()
        };
        let [seen, right] = Both::new(&gpu, settings.clone()).light(&gpu, &cells);
        let rounds = (1..100).find(|&n| after(Bounces::Count(n)) == right).unwrap();
        let here = worst(&seen, &right);
        let [less, more] =
            [rounds - 1, rounds + 1].map(|n| worst(&seen, &after(Bounces::Count(n))));
        println!("{name}, {rounds} rounds: {here:.1e}; one less {less:.1e}, one more {more:.1e}");
        assert!(rounds > 10 && 10.0 * here < less.min(more), "{name}");
    }
}

#[test]
fn the_albedo_limits_the_number_of_planned_bounces() {
    let (device, queue) = device();
    let [dull, bright] = [0.3, 0.9].map(|albedo| {
        let mut cells = cells(31, 17, 7);
        cells.albedo_mut().fill([albedo; 3]);
        cells
    });
    let [converged, one] = [Bounces::Converged, Bounces::Count(1)]
        .map(|bounces| Settings { bounces, ..Settings::direct(Method::Holographic) });
    let planned = |lighting: &Lighting| lighting.cost().unwrap().dispatches();
    let lit = |cells| {
        let mut lighting = lighting(&device, &queue);
        (frame(&device, &queue, &mut lighting, &converged, cells), planned(&lighting))
    };
    let [(dull_light, few), (bright_light, many)] = [&dull, &bright].map(lit);
    assert!(3 * few < many, "{few} dispatches, and {many}");

    // Whatever was planned before: fewer bounces, more, or none.
    let mut one_by_one = lighting(&device, &queue);
    for (cells, light, dispatches) in
        [(&dull, &dull_light, few), (&bright, &bright_light, many), (&dull, &dull_light, many)]
    {
        assert_eq!(&frame(&device, &queue, &mut one_by_one, &converged, cells), light);
        assert_eq!(planned(&one_by_one), dispatches);
    }
    let mut lighting = lighting(&device, &queue);
    frame(&device, &queue, &mut lighting, &one, &bright);
    assert!(planned(&lighting) < few);
    assert_eq!(frame(&device, &queue, &mut lighting, &converged, &bright), bright_light);
    assert_eq!(planned(&lighting), many);
}
