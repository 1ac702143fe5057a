//! Lamps with exact direct light, and suns, in every method.

use crate::common::{cells, device, seeded};
use crate::compare::{Both, SIZES, agree_but_for, differences, wrong};
use crate::lamps::{lamps, with_cookies};
use lamplight::settings::{Blend, Cascades, Flood, Holographic, MethodSettings, Polar, Raymarch};
use lamplight::{
    ALL_LAYERS, Bounces, Cells, Cone, Cookie, CookiePixels, Direct, Lamp, Matter, Profile, Rgb,
    Settings, Sun,
};
use lamplight_wgpu::FrameInput;
use std::f32::consts::TAU;

pub fn methods() -> [(&'static str, MethodSettings); 7] {
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
        ..Sun::default()
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
pub fn without_media(mut cells: Cells) -> Cells {
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

/// Light that is too dim to be compared by its own measure.
const DIM: f32 = 1e-3;
/// Pixels through leaves that may be off by a tenth.
const MOST_OFF: usize = 30;

#[test]
fn direct_light_through_leaves_agrees() {
    let gpu = device();
    let mut both = Both::new(&gpu, Settings::direct(Raymarch::default()));
    for share in [0.1, 0.4] {
        let random = &mut seeded(fastrand::u64(..));
        let mut leaves = Cells::new(97, 61).unwrap();
        let position = [20.0 + 57.0 * random.f32(), 20.0 + 21.0 * random.f32()];
        for i in 0..leaves.len() {
            let [x, y] = [i % 97, i / 97].map(|v| v as f32 + 0.5);
            // Not before the lamp, where they shade all alike.
            let is_far = (x - position[0]).hypot(y - position[1]) > 5.0;
            let opacity = if is_far && random.f32() < share { random.f32() } else { 0.0 };
            leaves.set_matter(i, Matter { opacity, ..Matter::EMPTY });
        }
        let sun = Sun { direction: TAU * random.f32(), direct: Direct::Exact, ..Sun::default() };
        let mut under_lamp = leaves.clone();
        leaves.suns_mut().push(sun);
        let lamp = Lamp { position, size: 3.0, range: 100.0, ..Lamp::default() };
        under_lamp.lamps_mut().push(Lamp { direct: Direct::Exact, ..lamp });
        for (name, cells) in [("sun", leaves), ("lamp", under_lamp)] {
            let [seen, right] = both.light(&gpu, &cells);
            let is_off =
                |(seen, right): (&Rgb, &Rgb)| (seen[0] - right[0]).abs() > 0.1 * right[0].max(DIM);
            let off = seen.iter().zip(&right).filter(|&pair| is_off(pair)).count();
            let found = rmse(&seen, &right);
            println!("{name}, {share}: {:.3} %, {off} off", 100.0 * found);
            assert!(found < THROUGH_MEDIA && off < MOST_OFF, "{found}, {off}");
        }
    }
}

/// The relative difference of a sliver of light, whose width rounding changes.
const SLIVERS: f32 = 0.05;

#[test]
fn slivers_of_a_lamp_past_a_wall_agree_behind_a_pane() {
    let gpu = device();
    let mut cells = Cells::new(60, 40).unwrap();
    for y in 0..40 {
        let opacity = f32::from(u8::from(y < 20));
        cells.set(30, y, Matter { opacity, ..Matter::EMPTY });
        cells.set(40, y, Matter { opacity: 0.9, ..Matter::EMPTY });
    }
    let lamp = Lamp { position: [10.5, 20.5], size: 8.0, ..Lamp::default() };
    cells.lamps_mut().push(Lamp { direct: Direct::Exact, ..lamp });
    let [seen, right] = Both::new(&gpu, Settings::direct(Raymarch::default())).light(&gpu, &cells);
    // Slivers are so dim that only a measure of their own tells them apart.
    let off = |(seen, right): (&Rgb, &Rgb)| (seen[0] - right[0]).abs() > SLIVERS * right[0];
    assert!(!seen.iter().zip(&right).any(off));
}

#[test]
fn suns_end_at_media_that_are_not_translucent() {
    let gpu = device();
    let mut cells = lit(97, 61, 310);
    cells.lamps_mut().clear();
    for translucent in [true, false] {
        let polar = Polar { translucent, ..Polar::default() };
        let settings = Settings { wall_depth: 0.0, ..Settings::direct(polar) };
        let mut both = Both::new(&gpu, settings);
        let [seen, right] = both.light(&gpu, &cells);
        let found = rmse(&seen, &right);
        assert!(found < THROUGH_MEDIA, "translucent: {translucent}: {found}");
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

/// Random matter, lit by lamps, of which every third takes light away.
fn darkened(width: u32, height: u32, seed: u64) -> Cells {
    let mut cells = without_media(lit(width, height, seed));
    cells.lamps_mut().iter_mut().step_by(3).for_each(|lamp| lamp.intensity *= -2.0);
    cells
}

#[test]
fn lamps_that_take_light_agree_with_every_method() {
    let gpu = device();
    let cells = darkened(61, 43, 230);
    let blends =
        [Blend::Max, Blend::Screen].map(|blend| Polar { blend, ..Polar::default() }.into());
    let blends = blends.into_iter().map(|polar| ("polar, blended", polar));
    for (name, method) in methods().into_iter().chain(blends) {
        for bounces in [0, 2].map(Bounces::Count) {
            let settings = Settings { bounces, ..Settings::direct(method.clone()) };
            let mut both = Both::new(&gpu, settings);
            let name = format!("{name}, {bounces:?}");
            both.agree_but_for(TIES, &gpu, &name, &cells);
            let mut without_suns = cells.clone();
            without_suns.suns_mut().clear();
            both.agree_but_for(TIES, &gpu, &format!("{name}, no suns"), &without_suns);
            let [seen, _] = both.light(&gpu, &cells);
            let mut added = cells.clone();
            added.lamps_mut().iter_mut().for_each(|lamp| lamp.intensity = lamp.intensity.abs());
            let [added, _] = both.light(&gpu, &added);
            assert!(wrong(&seen, &added) > seen.len() / 10, "{name}: added light passes");
        }
    }
}

/// Lamps and suns of one layer, of two, and of all, on cells of random layers.
fn layered(width: u32, height: u32, seed: u64) -> Cells {
    let mut cells = without_media(lit(width, height, seed));
    let masks = || [1, 6, ALL_LAYERS, 128].into_iter().cycle();
    cells.lamps_mut().iter_mut().zip(masks()).for_each(|(lamp, mask)| lamp.mask = mask);
    cells.suns_mut().iter_mut().zip(masks()).for_each(|(sun, mask)| sun.mask = mask);
    let mut random = seeded(seed + 4);
    cells.masks_mut().fill_with(|| random.u8(1..));
    cells
}

#[test]
fn masks_agree_with_every_method() {
    let gpu = device();
    let cells = layered(61, 43, 240);
    for (name, method) in methods() {
        for bounces in [0, 2].map(Bounces::Count) {
            let settings = Settings { bounces, ..Settings::direct(method.clone()) };
            let mut both = Both::new(&gpu, settings);
            let name = format!("{name}, {bounces:?}");
            both.agree_but_for(TIES, &gpu, &name, &cells);
            let [seen, _] = both.light(&gpu, &cells);
            let mut unmasked = cells.clone();
            unmasked.masks_mut().fill(ALL_LAYERS);
            let [unmasked, _] = both.light(&gpu, &unmasked);
            assert!(
                wrong(&seen, &unmasked) > seen.len() / 10,
                "{name}: light of all layers passes"
            );
        }
    }
}

#[test]
fn masks_come_and_go() {
    let gpu = device();
    let mut both = Both::new(&gpu, Settings::direct(Polar::default()));
    let masked = layered(41, 1, 250);
    let mut plain = without_media(lit(41, 1, 250));
    plain.lamps_mut().clone_from_slice(masked.lamps());
    for (number, cells) in [&plain, &masked, &plain, &masked].into_iter().enumerate() {
        both.agree_but_for(TIES, &gpu, &format!("frame {number}"), cells);
    }
}

#[test]
fn profiles_agree_with_every_method() {
    let gpu = device();
    let mut cells = without_media(lit(61, 43, 260));
    let profile = Profile::new(&[0.1, 1.0, 0.0, 0.6, 0.6]).unwrap();
    for (number, lamp) in (0..).zip(cells.lamps_mut()) {
        let (direction, softness) = (number as f32 - 2.5, [0.0, 0.4, 1.0][number % 3]);
        lamp.cone = Some(Cone { direction, angle: 1.5, softness, profile: Some(profile) });
    }
    for (name, method) in methods() {
        let mut both = Both::new(&gpu, Settings::direct(method));
        both.agree_but_for(TIES, &gpu, name, &cells);
        let [seen, _] = both.light(&gpu, &cells);
        let mut even = cells.clone();
        even.lamps_mut().iter_mut().flat_map(|lamp| &mut lamp.cone).for_each(|c| c.profile = None);
        let [even, _] = both.light(&gpu, &even);
        assert!(wrong(&seen, &even) > seen.len() / 10, "{name}: an even cone passes");
    }
}

#[test]
fn cookies_agree_with_every_method() {
    let gpu = device();
    let mut cells = without_media(lit(61, 43, 280));
    with_cookies(&mut cells, 285);
    cells.lamps_mut().iter_mut().for_each(|lamp| lamp.range += 30.0);
    let mut turned = cells.clone();
    for cookie in turned.lamps_mut().iter_mut().flat_map(|lamp| &mut lamp.cookie) {
        cookie.turn += 0.5;
    }
    for (name, method) in methods() {
        let settings = Settings { bounces: Bounces::Count(2), ..Settings::direct(method) };
        let mut both = Both::new(&gpu, settings);
        both.agree_but_for(TIES, &gpu, name, &cells);
        let [seen, _] = both.light(&gpu, &cells);
        let [turned, _] = both.light(&gpu, &turned);
        assert!(wrong(&seen, &turned) > seen.len() / 10, "{name}: turned pictures pass");
    }
}

#[test]
fn cookies_come_and_go_and_change() {
    let gpu = device();
    for method in [MethodSettings::from(Raymarch::default()), Polar::default().into()] {
        let mut both = Both::new(&gpu, Settings::direct(method));
        let plain = without_media(lit(61, 43, 290));
        let [mut few, mut other, mut many] = [0; 3].map(|_| plain.clone());
        with_cookies(&mut few, 291);
        with_cookies(&mut other, 292);
        // More than a row of the texture holds.
        with_cookies(&mut many, 293);
        let pixels: Vec<Rgb> = (0..150 * 70).map(|i| [(i % 97) as f32 / 97.0; 3]).collect();
        let picture = CookiePixels::new([150, 70], &pixels).unwrap();
        many.lamps_mut()[0].cookie = Some(Cookie::new(picture, 90.0));
        for (number, cells) in
            [&plain, &few, &many, &few, &other, &plain, &other, &many].into_iter().enumerate()
        {
            both.agree_but_for(TIES, &gpu, &format!("frame {number}"), cells);
        }
        // Lamps move with their pictures.
        let before = both.light(&gpu, &many)[0].clone();
        many.lamps_mut().iter_mut().for_each(|lamp| lamp.position[0] += 4.0);
        both.agree_but_for(TIES, &gpu, "moved", &many);
        assert!(wrong(&before, &both.light(&gpu, &many)[0]) > before.len() / 10);
    }
}

/// Texels of single pictures that are too much together for a texture of 2048×2048.
#[test]
fn cookies_beyond_the_largest_texture_are_refused_and_the_frame_before_stays() {
    let (device, queue) =
        crate::common::device_with(|limits| limits.max_texture_dimension_2d = 2048);
    let mut lighting = crate::common::lighting(&device, &queue);
    let settings = Settings::direct(Polar::default());
    let plain = without_media(lit(41, 1, 300));
    let before = crate::common::frame(&device, &queue, &mut lighting, &settings, &plain);
    let mut large = plain.clone();
    let half = CookiePixels::new([2048, 1025], &vec![[1.0; 3]; 2048 * 1025]).unwrap();
    let other = CookiePixels::new([2048, 1024], &vec![[1.0; 3]; 2048 * 1024]).unwrap();
    large.lamps_mut()[0].cookie = Some(Cookie::new(half, 90.0));
    large.lamps_mut()[1].cookie = Some(Cookie::new(other, 90.0));
    let error = lighting.prepare(&FrameInput::of_cells(&settings, &large)).unwrap_err().to_string();
    let expected =
        "needs 2049 rows of 2048 texels for the cookies of its lamps, but this device allows 2048";
    assert!(error.contains(expected), "{error}");
    let after = crate::common::frame(&device, &queue, &mut lighting, &settings, &plain);
    assert_eq!(before, after);
    large.lamps_mut()[1].cookie = None;
    crate::common::frame(&device, &queue, &mut lighting, &settings, &large);
}

#[test]
fn lamps_beside_walls_and_borders_agree() {
    let gpu = device();
    let mut both = Both::new(&gpu, Settings::direct(Raymarch::default()));
    let mut cells = Cells::new(90, 70).unwrap();
    for i in 0..cells.len() {
        // Fog over the lower half.
        let opacity = if i % 90 < 34 { 1.0 } else { 0.02 * f32::from(u8::from(i >= 90 * 40)) };
        cells.set_matter(i, Matter { opacity, albedo: [0.7; 3], ..Matter::EMPTY });
    }
    // Beside the wall and on its face, over the border, at a corner, and larger than the room.
    for (position, size) in [
        ([34.5, 35.5], 3.0),
        ([34.0, 35.5], 3.0),
        ([60.0, 2.0], 6.0),
        ([90.0, 0.0], 4.0),
        ([50.0, 30.0], 60.0),
    ] {
        *cells.lamps_mut() =
            vec![Lamp { position, size, direct: Direct::Exact, ..Lamp::default() }];
        both.agree_but_for(TIES, &gpu, &format!("{position:?}"), &cells);
    }
}

#[test]
fn suns_on_slanted_and_round_walls_agree() {
    let gpu = device();
    let mut both = Both::new(&gpu, Settings::direct(Raymarch::default()));
    for degrees in [20.0f32, 45.0, 55.0, 60.0, 65.0, 120.0, 250.0] {
        let mut cells = Cells::new(97, 61).unwrap();
        for i in 0..cells.len() {
            let [x, y] = [i % 97, i / 97].map(|v| v as f32 + 0.5);
            let slanted = (34.0 * (x - 10.0) + 60.0 * (y - 50.0)).abs() < 170.0 && x < 70.0;
            if slanted || (x - 80.0).hypot(y - 30.0) < 9.0 {
                cells.set_matter(i, Matter { opacity: 1.0, albedo: [0.7; 3], ..Matter::EMPTY });
            }
        }
        cells.suns_mut().push(Sun { direction: degrees.to_radians(), ..Sun::default() });
        both.agree_but_for(TIES, &gpu, &format!("{degrees} degrees"), &cells);
    }
}
