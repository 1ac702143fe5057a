//! Lamps with exact direct light, and suns, in every method.

use crate::common::{cells, device, seeded};
use crate::compare::{Both, SIZES, agree_but_for, differences};
use crate::lamps::lamps;
use lamplight::settings::{Cascades, Flood, Holographic, MethodSettings, Polar, Raymarch};
use lamplight::{Bounces, Cells, Direct, Matter, Rgb, Settings, Sun};
use std::f32::consts::TAU;

fn methods() -> [(&'static str, MethodSettings); 7] {
    [
        ("raymarch", Raymarch::default().into()),
        ("raymarch, feedback", Raymarch::preset("unity").unwrap().into()),
        ("cascades", Cascades::default().into()),
        ("holographic", Holographic::default().into()),
        ("holographic, paper", Holographic::preset("paper").unwrap().into()),
        ("flood", Flood::default().into()),
        ("polar", Polar::default().into()),
    ]
}

/// Random suns: narrow, wide, and along an axis.
fn suns(seed: u64) -> Vec<Sun> {
    let mut random = seeded(seed);
    let sun = |angle| Sun {
        direction: TAU * random.f32(),
        angle,
        color: std::array::from_fn(|_| random.f32()),
        intensity: 3.0 * random.f32(),
    };
    let mut suns: Vec<_> = [1e-4, 0.02, 0.5].map(sun).into();
    suns[0].direction = 0.0;
    suns
}

/// Random matter, lit by lamps, of which every other is exact, and by suns.
fn lit(width: u32, height: u32, seed: u64) -> Cells {
    let mut cells = cells(width, height, seed);
    *cells.lamps_mut() = lamps(width, height, 6, seed + 1);
    let every_other = cells.lamps_mut().iter_mut().step_by(2);
    every_other.for_each(|lamp| lamp.direct = Direct::Exact);
    *cells.suns_mut() = suns(seed + 2);
    cells
}

/// Removes media, through which the CPU looks by other rays. The rims of drawn lamps are such.
fn without_media(mut cells: Cells) -> Cells {
    cells.lamps_mut().iter_mut().for_each(|lamp| lamp.direct = Direct::Exact);
    for i in 0..cells.len() {
        if !cells.is_solid(i) {
            cells.set_matter(i, Matter::EMPTY);
        }
    }
    cells
}

/// The fraction of pixels that may be off: rounding decides whether a corner hides the rim of a light.
const TIES: f64 = 1e-3;

#[test]
fn direct_light_agrees_at_every_size() {
    let gpu = device();
    let mut both = Both::new(&gpu, Settings::direct(Raymarch::default()));
    for (number, [w, h]) in (0..).zip(SIZES) {
        let cells = without_media(lit(w, h, 70 + 3 * number));
        both.agree_but_for(TIES, &gpu, &format!("{w}×{h}"), &cells);
    }
}

#[test]
fn direct_light_agrees_with_every_method_and_bounces() {
    let gpu = device();
    for ([w, h], seed) in [([41, 1], 170), ([61, 43], 180)] {
        let cells = without_media(lit(w, h, seed));
        for (name, method) in methods() {
            for bounces in [Bounces::Count(0), Bounces::Count(2), Bounces::Converged] {
                let settings = Settings { bounces, ..Settings::direct(method.clone()) };
                let name = format!("{name}, {bounces:?}, {w}×{h}");
                agree_but_for(TIES, &gpu, &name, &cells, settings);
            }
        }
    }
}

/// The relative RMSE between the two where media lie before lights.
const THROUGH_MEDIA: f64 = 0.005;

/// The relative RMSE without ties.
fn rmse(seen: &[Rgb], right: &[Rgb]) -> f64 {
    let mut differences = differences(seen, right);
    differences.sort_by(f64::total_cmp);
    let ties = (TIES * right.len() as f64) as usize;
    let (counted, _) = differences.split_at(right.len() - ties);
    (counted.iter().map(|d| d * d).sum::<f64>() / counted.len() as f64).sqrt()
}

#[test]
fn direct_light_through_media_agrees_but_for_the_choice_of_rays() {
    let gpu = device();
    let mut both = Both::new(&gpu, Settings::direct(Raymarch::default()));
    for seed in [190, 200, 210] {
        let cells = lit(97, 61, seed);
        let [seen, right] = both.light(&gpu, &cells);
        let found = rmse(&seen, &right);
        println!("seed {seed}: {:.2} %", 100.0 * found);
        assert!(found < THROUGH_MEDIA, "{found}");
        let clear = without_media(cells);
        let [clear, _] = both.light(&gpu, &clear);
        let off = rmse(&clear, &right);
        assert!(off > THROUGH_MEDIA, "media do not matter: {off}");
    }
}

#[test]
fn lights_come_and_go() {
    let gpu = device();
    let mut both = Both::new(&gpu, Settings::direct(Raymarch::default()));
    let all = without_media(lit(61, 43, 220));
    for [lamps, suns] in [[0, 0], [1, 0], [0, 3], [6, 1], [0, 0], [6, 3]] {
        let mut cells = all.clone();
        cells.lamps_mut().truncate(lamps);
        cells.suns_mut().truncate(suns);
        both.agree_but_for(TIES, &gpu, &format!("{lamps} lamps, {suns} suns"), &cells);
    }
}
