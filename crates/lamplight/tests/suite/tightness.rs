//! No light ever crosses a solid cell.
//!
//! A room of random shape with a bright light in it is closed by a wall one cell thick. Every open
//! cell outside stays 0 to the bit, whatever the settings, also where the wall holds together by
//! the corners of its cells only (`methods/raymarch/march.rs`: two solid cells that touch by
//! a corner hold light back).

use crate::common::*;
use fastrand::Rng;
use lamplight::settings::{Hit, Holographic, Noise, Raymarch, Spacing, Temporal};
use lamplight::{Bounces, Cells, Direct, Lamp, Matter, Rgb, Settings, Solver, Sun};
use proptest::prelude::*;

const BRIGHT: Rgb = [1000.0, 800.0, 1e6];

/// The room, its light and what stands round it: fog, glass and mirrors that would show a leak.
fn world(sealed: &Sealed, size: [u32; 2], random: &mut Rng) -> Cells {
    let mut cells = Cells::new(size[0], size[1]).unwrap();
    for i in 0..cells.len() {
        let albedo = rgb(random);
        let kind = random.f32();
        cells.set_matter(
            i,
            match kind {
                _ if sealed.wall[i] => Matter { albedo, ..WALL },
                k if k < 0.1 && !sealed.inside[i] => Matter { albedo, ..WALL },
                k if k < 0.2 => Matter { opacity: random.f32() * 0.9, albedo, ..Matter::EMPTY },
                k if k < 0.25 => Matter { tint: rgb(random), albedo, ..Matter::EMPTY },
                _ => Matter::EMPTY,
            },
        );
    }
    let room = sealed.room();
    let lamp = room[random.usize(..room.len())];
    let opacity = if random.f32() < 0.5 { 1.0 } else { 0.7 };
    // Cells beside it see it under every rule.
    for beside in around(size[0], size[1], lamp, Contact::Sides).filter(|&i| sealed.inside[i]) {
        cells.set_matter(beside, Matter::EMPTY);
    }
    cells.set_matter(lamp, Matter { emission: BRIGHT, opacity, ..Matter::EMPTY });
    let place = [lamp as u32 % size[0], lamp as u32 / size[0]];
    let position = place.map(|v| v as f32 + random.f32());
    let size = [0.05, 1.0, 4.0][random.usize(..3)];
    cells.lamps_mut().push(Lamp { position, size, direct: Direct::Exact, ..Lamp::default() });
    cells
}

/// None, those within a frame, and those over frames.
const BOUNCES: [Bounces; 3] = [Bounces::Count(0), Bounces::Count(2), Bounces::Feedback];

/// Light after a few frames: feedback and history have had their chance.
fn frames(settings: &Settings, cells: &Cells) -> Vec<Rgb> {
    let mut solver = Solver::new(settings.clone()).unwrap();
    for _ in 0..if settings.bounces == Bounces::Feedback { 3 } else { 2 } {
        solver.solve(cells).unwrap();
    }
    solver.light().pixels().to_vec()
}

/// Open cells outside that are lit, and open cells inside that are.
fn lit(sealed: &Sealed, cells: &Cells, light: &[Rgb]) -> (Vec<usize>, usize) {
    let lit = |&i: &usize| !cells.is_solid(i) && light[i].map(f32::to_bits) != [0; 3];
    let outside = (0..cells.len()).filter(|&i| sealed.is_outside(i)).filter(lit).collect();
    (outside, sealed.room().into_iter().filter(lit).count())
}

fn marches() -> impl Strategy<Value = Raymarch> {
    let preset = prop::sample::select(Raymarch::PRESETS.to_vec());
    let noise = prop::sample::select(vec![Noise::White, Noise::Blue, Noise::Golden]);
    let spacing = prop::sample::select(vec![Spacing::Even, Spacing::Golden]);
    let hit = prop::sample::select(vec![Hit::Edge, Hit::Distance]);
    let own = (noise, spacing, hit, 1..40u32, 0.1..8.0f32, 0.01..4.0f32).prop_map(
        |(noise, spacing, hit, rays, least_step, hit_distance)| Raymarch {
            noise,
            spacing,
            hit,
            rays,
            least_step,
            hit_distance,
            ..unfiltered(Raymarch::default())
        },
    );
    prop_oneof![own, preset.prop_map(|name| unfiltered(Raymarch::preset(name).unwrap()))]
}

fn any_settings() -> impl Strategy<Value = Settings> {
    (marches(), prop::sample::select(BOUNCES.to_vec()), prop::bool::ANY, prop::bool::ANY).prop_map(
        |(raymarch, bounces, denoise, temporal)| {
            settings(|s| {
                *raymarch_of(s) = raymarch;
                s.bounces = bounces;
                raymarch_of(s).denoise.passes = if denoise { 5 } else { 0 };
                raymarch_of(s).temporal =
                    Temporal { history_length: if temporal { 8 } else { 0 }, reject: true };
            })
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 192,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_sealed_room_stays_dark_outside(
        size in prop::array::uniform2(1..98u32).prop_map(|[w, h]| [w, h.min(61)]),
        share in 0.0..0.6f32,
        seed: u64,
        corners: bool,
        settings in any_settings(),
    ) {
        let random = &mut Rng::with_seed(seed);
        let contact = if corners { Contact::Corners } else { Contact::Sides };
        let room = 2 + (share * share * (size[0] * size[1]) as f32) as usize;
        let sealed = Sealed::new(random, size, room, contact);
        let cells = world(&sealed, size, random);
        let light = frames(&settings, &cells);
        let (leaks, _) = lit(&sealed, &cells, &light);
        let places: Vec<_> = leaks
            .iter()
            .take(5)
            .map(|&i| ((i as u32 % size[0], i as u32 / size[0]), light[i]))
            .collect();
        prop_assert!(leaks.is_empty(), "{} cells lit outside: {places:?}", leaks.len());
    }
}

#[test]
fn no_sun_shines_into_a_sealed_room() {
    let random = &mut fresh();
    for _ in 0..200 {
        let size = [random.u32(4..60), random.u32(4..60)];
        let room = 2 + (random.f32().powi(2) * 0.3 * (size[0] * size[1]) as f32) as usize;
        let contact = [Contact::Sides, Contact::Corners][random.usize(..2)];
        let sealed = Sealed::new(random, size, room, contact);
        let mut cells = world(&sealed, size, random);
        cells.emission_mut().fill([0.0; 3]);
        cells.lamps_mut().clear();
        let (direction, angle) = (6.0 * random.f32(), [1e-4, 0.02, 0.5][random.usize(..3)]);
        cells.suns_mut().push(Sun { direction, angle, ..Sun::default() });
        let settings = settings(|s| s.bounces = Bounces::Count(1));
        let light = frames(&settings, &cells);
        let inside = sealed.room().into_iter();
        let lit = inside.filter(|&i| !cells.is_solid(i) && light[i] != [0.0; 3]).count();
        let on_the_border = sealed.room().iter().any(|&i| {
            let [x, y] = [i as u32 % size[0], i as u32 / size[0]];
            x == 0 || y == 0 || x + 1 == size[0] || y + 1 == size[1]
        });
        assert!(lit == 0 || on_the_border, "{lit} cells inside are lit");
    }
}

/// Every setting on the same rooms.
fn every_setting() -> Vec<Settings> {
    let mut all = Vec::new();
    for preset in Raymarch::PRESETS {
        for hit in [Hit::Edge, Hit::Distance] {
            for noise in [Noise::White, Noise::Blue, Noise::Golden] {
                for spacing in [Spacing::Even, Spacing::Golden] {
                    for bounces in BOUNCES {
                        all.push(settings(|s| {
                            let preset = unfiltered(Raymarch::preset(preset).unwrap());
                            *raymarch_of(s) = Raymarch { hit, noise, spacing, ..preset };
                            s.bounces = bounces;
                        }));
                    }
                }
            }
        }
    }
    all
}

#[test]
fn every_setting_lights_only_the_inside() {
    let random = &mut fresh();
    for contact in [Contact::Sides, Contact::Corners] {
        for settings in every_setting() {
            let sealed = Sealed::new(random, [23, 17], 60, contact);
            let cells = world(&sealed, [23, 17], random);
            let (leaks, inside) = lit(&sealed, &cells, &frames(&settings, &cells));
            assert!(leaks.is_empty(), "{contact:?}, {settings:?}: lit outside: {leaks:?}");
            assert!(inside > 0, "{contact:?}, {settings:?}: dark inside");
        }
    }
}

#[test]
fn no_preset_of_holographic_lets_light_out() {
    let random = &mut fresh();
    for contact in [Contact::Sides, Contact::Corners] {
        for preset in ["default", "fast", "coarse", "high"] {
            for bounces in BOUNCES {
                for _ in 0..8 {
                    let holographic = Holographic::preset(preset).unwrap();
                    let settings = Settings { bounces, ..Settings::direct(holographic) };
                    let sealed = Sealed::new(random, [71, 37], 300, contact);
                    let cells = world(&sealed, [71, 37], random);
                    let (leaks, inside) = lit(&sealed, &cells, &frames(&settings, &cells));
                    assert!(leaks.is_empty(), "{contact:?}, {preset}: lit outside: {leaks:?}");
                    assert!(inside > 0, "{contact:?}, {preset}: dark inside");
                }
            }
        }
    }
}

/// A diamond of walls that touch by their corners only; `gap` opens one of them.
fn diamond(gap: bool) -> Cells {
    grid(31, 31, |x, y| match x.abs_diff(15) + y.abs_diff(15) {
        0 => Matter { emission: BRIGHT, ..WALL },
        8 if !(gap && x == 23) => Matter { albedo: [0.5; 3], ..WALL },
        _ => Matter::EMPTY,
    })
}

#[test]
fn one_open_cell_lets_light_out() {
    for mut settings in every_setting() {
        // Fewer rays miss a gap of one cell if all of them belong to one frame.
        if settings.bounces != Bounces::Feedback {
            let rays = &mut raymarch_of(&mut settings).rays;
            *rays = (*rays).max(32);
        }
        for gap in [false, true] {
            let cells = diamond(gap);
            let light = frames(&settings, &cells);
            let out = (0..cells.len()).any(|i| {
                let (x, y) = (i as u32 % 31, i as u32 / 31);
                x.abs_diff(15) + y.abs_diff(15) > 8 && light[i] != [0.0; 3]
            });
            assert_eq!(out, gap, "{settings:?}");
        }
    }
}

#[test]
fn inside_every_open_cell_that_sees_the_light_is_lit() {
    // A convex room: all of it sees the light, and 64 rays cannot miss 3×3 cells from 8 px away.
    let mut cells = room(17, 13, WALL);
    for (x, y) in (7..10).flat_map(|x| (5..8).map(move |y| (x, y))) {
        cells.set(x, y, Matter { emission: BRIGHT, ..WALL });
    }
    for hit in [Hit::Edge, Hit::Distance] {
        let settings = settings(|s| (raymarch_of(s).hit, raymarch_of(s).rays) = (hit, 64));
        let light = solve(&settings, &cells);
        let dark = |&i: &usize| !light.solid()[i] && light.pixels()[i][0] <= 0.0;
        assert_eq!((0..cells.len()).find(dark), None, "{hit:?}");
    }
}
