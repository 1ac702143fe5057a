//! Light that enters by place on the border.

use crate::common::{cells, device, frame, lighting, seeded};
use crate::compare::{Both, TOLERANCE, agree, differences};
use crate::frames::{frames_agree, moving};
use crate::moments;
use crate::sky::seeing_directions;
use lamplight::settings::Holographic;
use lamplight::{Bounces, Cells, Inflow, Lamp, Method, Panorama, Rgb, Settings, Sky, Solver};
use lamplight_wgpu::FrameInput;

/// Every method that reads inflow, with its variants.
fn variants() -> Vec<(&'static str, Settings)> {
    let holographic = |preset| Settings::direct(Holographic::preset(preset).unwrap());
    let own = [
        ("high holographic", holographic("high")),
        ("fast holographic", holographic("fast")),
        ("coarse holographic", holographic("coarse")),
    ];
    seeing_directions().into_iter().chain(own).collect()
}

/// Random radiance in every column of every border cell, of which a few are bright. Both sides of a corner cell have the
/// same, so that rounding does not decide what a ray through the corner sees.
fn inflow(size: [u32; 2], columns: usize, seed: u64) -> Inflow {
    let mut random = seeded(seed);
    let mut value = |i: usize| -> Rgb {
        let bright = if i % 50 == 7 { 20.0 } else { 1.0 };
        std::array::from_fn(|_| bright * random.f32())
    };
    let values: Vec<Rgb> = (0..4099).map(&mut value).collect();
    let radiance = |place: [f32; 2], angle: f64| {
        let [x, y] = [0, 1].map(|a| place[a].min(size[a] as f32 - 0.5) as usize);
        let number = 1021 * y + 31 * x + (1000.0 * angle) as usize;
        values[number % values.len()]
    };
    Inflow::new(size, columns, |place, angle| radiance(place.at, angle)).unwrap()
}

/// The cells with that inflow.
pub fn entered(mut cells: Cells, columns: usize, seed: u64) -> Cells {
    let size = [cells.width(), cells.height()];
    cells.set_inflow(Some(inflow(size, columns, seed))).unwrap();
    cells
}

#[test]
fn inflow_agrees_at_every_size() {
    let gpu = device();
    for (name, settings) in variants() {
        for (columns, size, bounces) in [
            (1, [1, 1], 0),
            (60, [1, 37], 0),
            (7, [41, 1], 1),
            (512, [61, 43], 1),
            (100, [127, 131], 0),
            (64, [60, 70], 2),
        ] {
            let settings = Settings { bounces: Bounces::Count(bounces), ..settings.clone() };
            let name = format!("{name}, {columns} columns, {size:?}");
            agree(&gpu, &name, &entered(cells(size[0], size[1], 9), columns, 5), settings);
        }
    }
    // More strips than lie one below the other.
    let wide = entered(cells(2060, 3, 9), 16, 5);
    agree(&gpu, "wide", &wide, Settings::direct(Method::Holographic));
}

#[test]
fn the_moment_of_inflow_agrees() {
    let gpu = device();
    let cells = entered(cells(61, 43, 9), 64, 5);
    for (name, settings) in variants() {
        let mut both = Both::new(&gpu, Settings { moment: true, ..settings });
        moments::agree(&gpu, &mut both, name, &cells);
    }
}

#[test]
fn points_of_the_border_follow_the_settings() {
    let gpu = device();
    let cells = entered(cells(61, 43, 9), 60, 1);
    let settings = |preset| Settings::direct(Holographic::preset(preset).unwrap());
    let mut both = Both::new(&gpu, settings("default"));
    for preset in ["default", "fast", "coarse", "default"] {
        both.solver = Solver::new(settings(preset)).unwrap();
        both.agree(&gpu, preset, &cells);
    }
}

#[test]
fn inflow_may_come_change_and_go() {
    let gpu = device();
    let plain = || cells(61, 43, 9);
    let mut under = plain();
    under.set_sky(Panorama::new(&[[1.0, 0.2, 0.1], [0.0, 0.5, 0.9]]).unwrap().into());
    let frames = [
        plain(),
        entered(plain(), 60, 1),
        entered(under.clone(), 60, 2),
        entered(plain(), 90, 3),
        under,
        entered(cells(43, 61, 9), 90, 3),
        plain(),
    ];
    for (name, settings) in variants() {
        let mut both = Both::new(&gpu, settings);
        for (i, cells) in frames.iter().enumerate() {
            both.agree(&gpu, &format!("{name}, frame {i}"), cells);
        }
    }
}

#[test]
fn feedback_with_inflow_agrees_frame_by_frame() {
    let gpu = device();
    for (name, settings) in variants() {
        let settings = Settings { bounces: Bounces::Feedback, ..settings };
        let frames = (0..6u32).map(|n| entered(moving(61, 43, n), 64, u64::from(n / 2)));
        frames_agree(&gpu, name, settings, frames);
    }
}

#[test]
fn a_uniform_inflow_is_a_uniform_sky() {
    let (device, queue) = device();
    let rgb = [0.3, 0.5, 1.0];
    // `cascades` sees no matter from beyond the border under inflow, and some under a sky.
    let equal = |(_, settings): &(_, Settings)| settings.method() != Method::Cascades;
    for (name, settings) in variants().into_iter().filter(equal) {
        let light = |cells: &Cells| -> Vec<Rgb> {
            let light = frame(&device, &queue, &mut lighting(&device, &queue), &settings, cells);
            light.into_iter().map(|[r, g, b, _]| [r, g, b]).collect()
        };
        let mut cells = cells(61, 43, 9);
        cells.set_sky(Sky::Uniform(rgb));
        let sky = light(&cells);
        cells.set_sky(Sky::BLACK);
        cells.set_inflow(Some(Inflow::new([61, 43], 16, |_, _| rgb).unwrap())).unwrap();
        let off = differences(&light(&cells), &sky).into_iter().fold(0.0, f64::max);
        println!("{name}: {off:.1e}");
        assert!(off < TOLERANCE, "{name}: {off}");
    }
}

#[test]
fn the_light_of_another_inflow_is_rejected() {
    let (device, queue) = device();
    for (name, settings) in variants() {
        let light = |brighter: f32| -> Vec<Rgb> {
            let mut cells = cells(61, 43, 9);
            let size = [61, 43];
            let known = inflow(size, 64, 1);
            // A single strip is another.
            let changed = Inflow::new(size, 64, |place, angle| {
                let direction = [angle.cos() as f32, angle.sin() as f32];
                let by = if place.at == [20.5, 0.0] { brighter } else { 1.0 };
                known.radiance(place.at, direction).map(|v| v * by)
            });
            cells.set_inflow(Some(changed.unwrap())).unwrap();
            let light = frame(&device, &queue, &mut lighting(&device, &queue), &settings, &cells);
            light.into_iter().map(|[r, g, b, _]| [r, g, b]).collect()
        };
        let off = differences(&light(1.0), &light(1.1)).into_iter().fold(0.0, f64::max);
        println!("{name}: {off:.1e}");
        assert!(off > TOLERANCE, "{name}: another strip passes");
    }
}

#[test]
fn methods_that_read_no_inflow_refuse_it() {
    let (device, queue) = device();
    let mut cells = entered(cells(20, 10, 9), 8, 1);
    cells.lamps_mut().push(Lamp::default());
    let paper = Settings::direct(Holographic::preset("paper").unwrap());
    for settings in [Settings::direct(Method::Flood), Settings::direct(Method::Polar), paper] {
        let mut lighting = lighting(&device, &queue);
        let error = lighting.prepare(&FrameInput::of_cells(&settings, &cells)).unwrap_err();
        assert!(error.to_string().contains("knows no light from beyond a grid"), "{error}");
    }
}
