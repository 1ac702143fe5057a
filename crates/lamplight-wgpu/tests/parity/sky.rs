//! Skies that are panoramas.

use crate::common::{cells, device, frame, lighting, raymarch_of, seeded};
use crate::compare::{Both, TOLERANCE, agree, differences};
use crate::direct::without_media;
use lamplight::settings::{Cascades, Hit, Holographic, Merge};
use lamplight::{Bounces, Cells, Direct, Gradient, Method, Panorama, Rgb, Settings, Sky, Sun};

/// The methods that see in which direction light enters, with their common variants.
pub fn seeing_directions() -> Vec<(&'static str, Settings)> {
    let holographic = |preset| Settings::direct(Holographic::preset(preset).unwrap());
    let plain = Cascades { merge: Merge::Plain, ..Cascades::default() };
    let mut by_distance = Settings::direct(Method::Raymarch);
    raymarch_of(&mut by_distance).hit = Hit::Distance;
    vec![
        ("raymarch", Settings::direct(Method::Raymarch)),
        ("raymarch by distance", by_distance),
        ("cascades", Settings::direct(Method::Cascades)),
        ("plain cascades", Settings::direct(plain)),
        ("holographic", holographic("default")),
        ("fast holographic", holographic("fast")),
    ]
}

/// Every method that sees the sky, with its variants.
fn variants() -> Vec<(&'static str, Settings)> {
    let holographic = |preset| Settings::direct(Holographic::preset(preset).unwrap());
    let own = [("paper", holographic("paper")), ("flood", Settings::direct(Method::Flood))];
    seeing_directions().into_iter().chain(own).collect()
}

/// Random columns, of which a few are as bright as a sun.
fn panorama(columns: usize, seed: u64) -> Panorama {
    let mut random = seeded(seed);
    let mut column = |i: usize| -> Rgb {
        let bright = if i % 50 == 7 { 20.0 } else { 1.0 };
        std::array::from_fn(|_| bright * random.f32())
    };
    let columns: Vec<Rgb> = (0..columns).map(&mut column).collect();
    Panorama::new(&columns).unwrap().turned(4.0)
}

fn under(sky: impl Into<Sky>, mut cells: Cells) -> Cells {
    cells.set_sky(sky.into());
    cells
}

#[test]
fn panoramas_agree_at_every_size() {
    let gpu = device();
    for (name, settings) in variants() {
        for (columns, [w, h], bounces) in [(1, [1, 37], 0), (100, [61, 43], 1), (8192, [45, 31], 0)]
        {
            let settings = Settings { bounces: Bounces::Count(bounces), ..settings.clone() };
            let name = format!("{name}, {columns} columns, {w}×{h}");
            agree(&gpu, &name, &under(panorama(columns, 5), cells(w, h, 9)), settings);
        }
    }
}

#[test]
fn a_sky_may_become_a_panorama_and_change() {
    let gpu = device();
    let [zenith, horizon, ground] = [[0.1, 0.4, 2.0], [1.0, 0.8, 0.2], [0.05, 0.0, 0.0]];
    let skies = [
        Sky::Uniform([0.3, 0.2, 0.1]),
        panorama(60, 1).into(),
        panorama(60, 1).turned(1.0).into(),
        panorama(60, 2).into(),
        panorama(90, 3).into(),
        Gradient { zenith, horizon, ground }.into(),
        panorama(90, 3).into(),
    ];
    for (name, settings) in variants() {
        // Whose history of another sky fades.
        if name == "flood" {
            continue;
        }
        let mut both = Both::new(&gpu, settings);
        for (i, sky) in skies.iter().enumerate() {
            both.agree(&gpu, &format!("{name}, sky {i}"), &under(sky.clone(), cells(61, 43, 9)));
        }
    }
}

#[test]
fn suns_that_glow_agree_as_they_come_and_go() {
    let gpu = device();
    let sun = Sun { direction: 1.3, angle: 0.1, direct: Direct::Glow, ..Sun::default() };
    let exact = Sun { direct: Direct::Exact, ..sun };
    let suns = [&[][..], &[sun], &[Sun { direction: 1.5, ..sun }, sun], &[sun, exact], &[]];
    for (name, settings) in variants() {
        // Lights suns exactly, and its history of another sun fades.
        if name == "flood" {
            continue;
        }
        let mut both = Both::new(&gpu, settings);
        for (i, suns) in suns.into_iter().enumerate() {
            // Media between an exact sun and what it lights are looked at along other lines on the GPU.
            let mut cells = without_media(under([0.2, 0.3, 0.4], cells(61, 43, 9)));
            cells.suns_mut().extend_from_slice(suns);
            both.agree(&gpu, &format!("{name}, suns {i}"), &cells);
        }
    }
}

#[test]
fn the_light_of_another_panorama_is_rejected() {
    let (device, queue) = device();
    for (name, settings) in variants() {
        let light = |turn: f32| -> Vec<Rgb> {
            let cells = under(panorama(60, 1).turned(turn), cells(61, 43, 9));
            let light = frame(&device, &queue, &mut lighting(&device, &queue), &settings, &cells);
            light.into_iter().map(|[r, g, b, _]| [r, g, b]).collect()
        };
        let off = differences(&light(0.0), &light(0.02)).into_iter().fold(0.0, f64::max);
        println!("{name}: {off:.1e}");
        assert!(off > TOLERANCE, "{name}: a turned sky passes");
    }
}
