//! The first moment of light, in every method, in walls too.

use crate::common::{cells, device, frame, seeded};
use crate::compare::{Both, TOLERANCE, differences};
use crate::direct::{methods, without_media};
use crate::lamps::{lamps, with_cookies};
use lamplight::settings::{MethodSettings, Raymarch};
use lamplight::{Bounces, Cells, Direct, Lamp, Light, Matter, Moment, Rgb, Settings, Sun};
use lamplight_wgpu::read_back::light;
use wgpu::{Device, Queue};

/// The fraction of pixels that may be off: rounding decides whether a corner hides the rim of a light, or which of two
/// equal lights is taken.
const TIES: f64 = 1e-3;

/// Random matter without media, drawn and exact lamps, and a sun.
fn lit(width: u32, height: u32, seed: u64) -> Cells {
    let mut cells = cells(width, height, seed);
    *cells.lamps_mut() = lamps(width, height, 4, seed + 1);
    let cone = cells.lamps()[0].cone;
    let mut cells = without_media(cells);
    for (lamp, direct) in
        cells.lamps_mut().iter_mut().zip([Direct::Exact, Direct::Glow].into_iter().cycle())
    {
        lamp.direct = direct;
        lamp.solid = false;
        lamp.cone = lamp.cone.filter(|_| direct == Direct::Exact).or(cone);
    }
    let mut random = seeded(seed + 2);
    let direction = random.f32() * 6.0;
    cells.suns_mut().push(Sun { direction, angle: 0.1, ..Sun::default() });
    cells
}

/// Pixels whose moment differs by more than the tolerance, relative to their light or to the mean. Those whose light
/// differs, where rounding decides which ray meets what, count elsewhere.
fn wrong(seen: &[Moment], light: &Light, right: &Light) -> usize {
    let sum: f64 = right.pixels().as_flattened().iter().map(|&v| f64::from(v)).sum();
    let mean = sum / (3 * right.pixels().len()) as f64;
    let differs = |seen: &Moment, right: &Moment, light: &Rgb| {
        (0..6).any(|k| {
            let (a, b) = (seen.as_flattened()[k], right.as_flattened()[k]);
            let off = f64::from((a - b).abs()) / f64::from(light[k % 3]).max(mean);
            off.is_nan() || off > TOLERANCE
        })
    };
    let lights = differences(light.pixels(), right.pixels());
    let pairs = seen.iter().zip(right.moment().unwrap()).zip(right.pixels()).zip(lights);
    let alike = pairs.filter(|(_, light)| *light < 0.25 * TOLERANCE);
    alike.filter(|(((seen, right), light), _)| differs(seen, right, light)).count()
}

#[track_caller]
pub fn agree((device, queue): &(Device, Queue), both: &mut Both, name: &str, cells: &Cells) {
    let settings = both.solver.settings().clone();
    let right = both.solver.solve(cells).unwrap();
    frame(device, queue, &mut both.lighting, &settings, cells);
    let seen = light(&both.lighting, cells).unwrap();
    let moments = seen.moment().expect("it was asked for");
    let found = wrong(moments, &seen, right);
    println!("{name}: {found} of {} pixels wrong", cells.len());
    assert!(found as f64 <= TIES * cells.len() as f64, "{name}: {found} pixels");
    let turned: Vec<Moment> = moments.iter().map(|[x, y]| [*y, *x]).collect();
    assert!(
        cells.len() < 100 || wrong(&turned, &seen, right) > cells.len() / 10,
        "{name}: turned passes"
    );
}

fn all() -> Vec<(&'static str, MethodSettings)> {
    let denoised = Raymarch { rays: 16, ..Raymarch::default() };
    methods().into_iter().chain([("raymarch, denoised", denoised.into())]).collect()
}

#[test]
fn moments_agree_with_every_method() {
    let gpu = device();
    for ([w, h], seed) in [([1, 1], 300), ([41, 1], 310), ([61, 43], 320)] {
        let cells = lit(w, h, seed);
        for (name, method) in all() {
            for bounces in [0, 1] {
                let bounces = Bounces::Count(bounces);
                let settings = Settings { bounces, moment: true, ..Settings::new(method.clone()) };
                let name = format!("{name}, {bounces:?}, {w}×{h}");
                agree(&gpu, &mut Both::new(&gpu, settings), &name, &cells);
            }
        }
    }
}

/// Small walls under exact lamps at several heights, and a low sun.
fn hung(width: u32, height: u32, seed: u64) -> Cells {
    let mut random = seeded(seed);
    let mut cells = Cells::new(width, height).unwrap();
    for i in 0..cells.len() {
        if random.f32() < 0.02 {
            cells.set_matter(i, Matter { opacity: 1.0, ..Matter::EMPTY });
        }
    }
    // The lowest one lights most cells from lower than any light may come.
    for height_of_lamp in [Some(15.0), None, Some(0.5), Some(200.0)] {
        let position = [random.f32() * width as f32, random.f32() * height as f32];
        let direct = Direct::Exact;
        let lamp = Lamp { position, direct, height: height_of_lamp, size: 1.5, ..Lamp::default() };
        cells.lamps_mut().push(lamp);
    }
    let (direction, elevation) = (6.0 * random.f32(), Some(0.25));
    cells.suns_mut().push(Sun { direction, elevation, angle: 0.1, ..Sun::default() });
    cells
}

#[test]
fn moments_of_light_with_elevations_agree() {
    let gpu = device();
    let cells = hung(97, 61, 360);
    let mut higher = cells.clone();
    for lamp in higher.lamps_mut() {
        lamp.height = lamp.height.map(|height| 2.0 * height);
    }
    higher.suns_mut()[0].elevation = Some(0.5);
    for (name, method) in all() {
        let settings = Settings { moment: true, elevation: 0.6, ..Settings::direct(method) };
        let mut both = Both::new(&gpu, settings);
        agree(&gpu, &mut both, name, &cells);
        let right = both.solver.solve(&higher).unwrap().clone();
        let seen = light(&both.lighting, &cells).unwrap();
        assert_eq!(seen.elevation(), 0.6, "{name}");
        let differ = wrong(seen.moment().unwrap(), &seen, &right);
        assert!(differ > cells.len() / 2, "{name}: moments of higher lights pass: {differ}");
    }
}

#[test]
fn moments_of_light_that_lamps_take_away_agree() {
    let gpu = device();
    for (kind, mut cells) in [("", lit(61, 43, 350)), (", with heights", hung(61, 43, 350))] {
        cells.lamps_mut()[0].intensity = 8.0;
        cells.lamps_mut()[2].intensity = -4.0;
        for (name, method) in all() {
            let settings = Settings { moment: true, ..Settings::direct(method) };
            agree(&gpu, &mut Both::new(&gpu, settings), &format!("{name}{kind}"), &cells);
        }
    }
}

#[test]
fn moments_of_light_through_pictures_agree() {
    let gpu = device();
    for (kind, mut cells) in [("", lit(61, 43, 370)), (", with heights", hung(61, 43, 370))] {
        let plain = cells.clone();
        with_cookies(&mut cells, 371);
        for (name, method) in all() {
            let settings = Settings { moment: true, ..Settings::direct(method) };
            let mut both = Both::new(&gpu, settings);
            agree(&gpu, &mut both, &format!("{name}{kind}"), &cells);
            let right = both.solver.solve(&plain).unwrap().clone();
            let seen = light(&both.lighting, &cells).unwrap();
            let lights = differences(seen.pixels(), right.pixels());
            let differ = lights.into_iter().filter(|&d| d > TOLERANCE).count();
            assert!(differ > cells.len() / 10, "{name}{kind}: light without pictures passes");
        }
    }
}

#[test]
fn moments_are_averaged_over_frames_with_the_light() {
    let gpu = device();
    let mut raymarch = Raymarch { rays: 8, ..Raymarch::default() };
    raymarch.temporal.history_length = 8;
    let settings = Settings { moment: true, ..Settings::new(raymarch) };
    let mut both = Both::new(&gpu, settings);
    let cells = lit(61, 43, 330);
    for number in 0..5 {
        agree(&gpu, &mut both, &format!("frame {number}"), &cells);
    }
    let mut moved = cells.clone();
    moved.lamps_mut()[1].position[0] += 3.0;
    agree(&gpu, &mut both, "a lamp moved", &moved);
}

#[test]
fn moments_come_and_go_with_settings_and_normals() {
    let gpu = device();
    let (device, queue) = &gpu;
    let plain = lit(61, 43, 340);
    let mut tilted = plain.clone();
    tilted.normals_mut()[100] = [0.6, 0.0, 0.8];
    let settings = Settings::new(Raymarch::default());
    let asked = Settings { moment: true, ..settings.clone() };
    let mut lighting = crate::common::lighting(device, queue);
    for (settings, cells, found) in [
        (&settings, &plain, false),
        (&asked, &plain, true),
        (&settings, &plain, false),
        (&settings, &tilted, true),
        (&settings, &plain, false),
    ] {
        frame(device, queue, &mut lighting, settings, cells);
        assert_eq!(light(&lighting, cells).unwrap().moment().is_some(), found);
    }
}
