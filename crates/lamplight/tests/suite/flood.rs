//! `flood` is judged by what holds for it: no light through walls, symmetry, energy that never grows,
//! rest on a still scene; and by the source's rules, cell by cell.

use crate::common::*;
use lamplight::settings::{Fade, Flood, Sweeps};
use lamplight::{Cells, Cone, Falloff, Lamp, Light, Matter, Settings, Sky, Solver};
use std::f32::consts::TAU;

/// f32 over a few operations, relative.
const ROUNDING: f32 = 1e-5;
/// The most that a cell of a symmetric scene may differ from its mirror image, relative
/// to the brightest: rounding, as directions are mirrored to the bit.
const ASYMMETRY: f32 = 1e-5;
/// The most in the source's order of sweeps, which favours the left and upper sides of walls.
const ASYMMETRY_IN_ORDER: f32 = 0.1;

/// The largest difference of light from that of a grid that does not move: cells that come in have not yet received what
/// spreads from frame to frame.
const MOVED: f64 = 0.03;

fn flood(change: impl FnOnce(&mut Flood)) -> Settings {
    let mut flood = Flood::default();
    change(&mut flood);
    Settings::direct(flood)
}

fn seed() -> Settings {
    flood(|s| *s = Flood::preset("seed").unwrap())
}

/// Both kinds of sweeps.
fn variants() -> [Settings; 2] {
    [flood(|_| ()), seed()]
}

/// Rays only.
fn rays_only(change: impl FnOnce(&mut Flood)) -> Settings {
    flood(|s| {
        (s.rounds, s.bounce_rays) = (0, 0);
        change(s);
    })
}

fn lamp(x: f32, y: f32) -> Lamp {
    Lamp { position: [x, y], ..LAMP }
}

fn with_lamp(mut cells: Cells, lamp: Lamp) -> Cells {
    cells.lamps_mut().push(lamp);
    cells
}

/// Random walls of many albedos, fog, glass and emitters.
fn jumble(width: u32, height: u32, seed: u64) -> Cells {
    let random = &mut seeded(seed);
    grid(width, height, |_, _| match random.f32() {
        v if v < 0.02 => Matter { emission: rgb(random), albedo: rgb(random), ..WALL },
        v if v < 0.12 => Matter { albedo: rgb(random), ..WALL },
        v if v < 0.2 => Matter { opacity: random.f32(), tint: rgb(random), ..Matter::EMPTY },
        _ => Matter::EMPTY,
    })
}

fn frames(solver: &mut Solver, cells: &Cells, frames: u32) -> Light {
    for _ in 0..frames {
        solver.solve(cells).unwrap();
    }
    solver.light().clone()
}

fn brightest(light: &Light) -> f32 {
    light.pixels().as_flattened().iter().copied().fold(0.0, f32::max)
}

/// Sum over the open cells.
fn total(light: &Light) -> f64 {
    let open = light.pixels().iter().zip(light.solid()).filter(|(_, solid)| !**solid);
    open.flat_map(|(pixel, _)| pixel).map(|&v| f64::from(v)).sum()
}

#[test]
fn no_light_gets_through_a_wall() {
    let random = &mut fresh();
    for round in 0..40 {
        let contact = if round % 2 == 0 { Contact::Sides } else { Contact::Corners };
        let sealed = Sealed::new(random, [37, 31], 60, contact);
        let white = Matter { albedo: [1.0; 3], ..WALL };
        let mut cells = sealed.grid(white);
        for (home, dark) in sealed.sides(random) {
            let position = [(home % 37) as f32 + random.f32(), (home / 37) as f32 + random.f32()];
            *cells.lamps_mut() = vec![Lamp { position, ..LAMP }];
            for settings in variants() {
                let light = frames(&mut Solver::new(settings).unwrap(), &cells, 4);
                assert!(light.pixels()[home][0] > 0.0);
                for &i in &dark {
                    assert_eq!(light.pixels()[i], [0.0; 3], "lamp at {position:?}, cell {i}");
                }
            }
        }
    }
}

/// Half of a room, and its mirror image beside it; lamps in both.
fn mirrored(width: u32, height: u32) -> Cells {
    let half = jumble(width / 2, height, 11);
    let mut cells = grid(width, height, |x, y| half.get(x.min(width - 1 - x), y).unwrap());
    for x in [9.25, width as f32 - 9.25] {
        cells.lamps_mut().push(Lamp { intensity: 2.0, ..lamp(x, 20.75) });
    }
    cells
}

/// The largest difference between a cell and its mirror image ÷ the brightest light.
fn asymmetry(light: &Light) -> f32 {
    let (w, h) = (light.width(), light.height());
    let pairs = (0..h).flat_map(|y| (0..w).map(move |x| (x, y)));
    let off = pairs.map(|(x, y)| {
        let (a, b) = (light.at(x, y), light.at(w - 1 - x, y));
        (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max)
    });
    off.fold(0.0, f32::max) / brightest(light)
}

#[test]
fn a_symmetric_scene_has_symmetric_light() {
    for (settings, allowed) in variants().into_iter().zip([ASYMMETRY, ASYMMETRY_IN_ORDER]) {
        let cells = mirrored(64, 41);
        let light = frames(&mut Solver::new(settings.clone()).unwrap(), &cells, 8);
        let off = asymmetry(&light);
        let sweeps = settings.method.as_flood().unwrap().sweeps;
        println!("{sweeps:?}: {off}");
        assert!(off < allowed, "{sweeps:?}: {off}");
        // One lamp that stands 4 px farther to the right is seen.
        let mut moved = cells.clone();
        moved.lamps_mut()[0].position[0] += 4.0;
        let light = frames(&mut Solver::new(settings).unwrap(), &moved, 8);
        let off = asymmetry(&light);
        assert!(off > allowed, "{sweeps:?}, moved: {off}");
    }
}

#[test]
fn energy_never_grows() {
    for settings in variants() {
        let lit = with_lamp(jumble(61, 47, 3), Lamp { intensity: 6.0, ..lamp(30.3, 20.7) });
        let mut solver = Solver::new(settings.clone()).unwrap();
        let mut light = frames(&mut solver, &lit, 6);
        // No cell is brighter than what gives light.
        assert!(brightest(&light) <= 6.0);
        let mut dark = grid(61, 47, |x, y| Matter { emission: [0.0; 3], ..lit.get(x, y).unwrap() });
        dark.set_sky(Sky::BLACK);
        let least = settings.method.as_flood().unwrap().decay - 1e-6;
        let mut count = 0;
        while brightest(&light) > 0.0 {
            let next = frames(&mut solver, &dark, 1);
            let fell = brightest(&light) - brightest(&next);
            assert!(fell >= least.min(brightest(&light)), "the brightest cell fell by {fell}");
            if settings.method.as_flood().unwrap().sweeps == Sweeps::Even {
                assert!(total(&next) < total(&light), "all cells together grew");
            }
            light = next;
            count += 1;
        }
        // With this decay per frame, dark after 6 ÷ 0.125 frames at the latest.
        assert!((2..=48).contains(&count), "{count} frames until dark");
    }
}

#[test]
fn even_sweeps_conserve_energy() {
    let once = flood(|s| s.decay = 0.0);
    let lit = with_lamp(jumble(61, 47, 3), lamp(30.3, 20.7));
    let mut solver = Solver::new(once).unwrap();
    let before = total(&frames(&mut solver, &lit, 1));
    let dark = grid(61, 47, |x, y| Matter { emission: [0.0; 3], ..lit.get(x, y).unwrap() });
    let after = total(&frames(&mut solver, &dark, 10));
    assert!((after / before - 1.0).abs() < 1e-4, "{before} became {after}");
}

#[test]
fn a_still_scene_comes_to_rest() {
    for settings in variants() {
        let cells = with_lamp(jumble(64, 64, 5), Lamp { intensity: 2.0, ..lamp(30.3, 33.1) });
        let mut solver = Solver::new(settings).unwrap();
        let first = frames(&mut solver, &cells, 1);
        let second = frames(&mut solver, &cells, 1);
        let change = |a: &Light, b: &Light| {
            let pairs = a.pixels().as_flattened().iter().zip(b.pixels().as_flattened());
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
        };
        assert!(change(&first, &second) > 1e-3, "the second frame is brighter than the first");
        let rest = frames(&mut solver, &cells, 60);
        let still = frames(&mut solver, &cells, 1);
        assert!(change(&rest, &still) < 1e-5, "{}", change(&rest, &still));
    }
}

#[test]
fn rays_follow_the_sources_attenuation() {
    let (w, h) = (64, 48);
    let cells = with_lamp(Cells::new(w, h).unwrap(), Lamp { range: 1e3, ..lamp(10.5, 20.5) });
    let light = solve(&rays_only(|s| (s.rays, s.fade) = (4, Fade::Seed)), &cells);
    for x in 11..w {
        // The middle of the cell along the ray; d in grids of D = 64 px.
        let d = f64::from(x - 10) / 64.0;
        let want = |d: f64| 1.0 / (1.0 + 64.0 * 0.75 * d * d);
        let found = f64::from(light.at(x, 20)[0]);
        assert!((found / want(d) - 1.0).abs() < f64::from(ROUNDING), "{x}: {found}");
        assert!((found / want(d * 1.01) - 1.0).abs() > f64::from(ROUNDING), "{x}: {found}");
        // Four rays: between them it is dark.
        assert_eq!(light.at(x, 21), [0.0; 3]);
    }
    // It ends where the attenuation falls under 0.01: 91.9 px at D = 64, 205 at D = 320.
    let wide = with_lamp(Cells::new(320, 1).unwrap(), Lamp { range: 1e3, ..lamp(0.5, 0.5) });
    let light = solve(&rays_only(|s| (s.rays, s.fade) = (4, Fade::Seed)), &wide);
    let end = (0..320).find(|&x| light.at(x, 0) == [0.0; 3]).unwrap();
    assert_eq!(end, (0.5f64 + (99.0f64 * 320.0 / 0.75).sqrt()).ceil() as u32);
}

#[test]
fn lamps_fade_by_their_falloff_and_range() {
    for falloff in [Falloff::Linear, Falloff::Smooth, Falloff::Inverse] {
        let lamp = Lamp { falloff, range: 30.0, intensity: 3.0, ..lamp(10.5, 8.5) };
        let light = solve(
            &rays_only(|s| s.rays = 4),
            &with_lamp(Cells::new(64, 17).unwrap(), lamp.clone()),
        );
        for x in 13..64 {
            let d = (x - 10) as f32;
            // A ray stands for all light between it and the next one.
            let want = 3.0 * falloff.at(d, &lamp) * (TAU / 4.0 * d).max(1.0);
            let found = light.at(x, 8)[0];
            // In the last cell the ray ends half way.
            assert!(
                (found - want).abs() < ROUNDING * want.max(1.0) || x == 40,
                "{falloff:?} {x}: {found} {want}"
            );
        }
    }
}

#[test]
fn tinted_matter_recolours_rays() {
    let glass = Matter { opacity: 0.5, tint: [1.0, 0.5, 0.25], ..Matter::EMPTY };
    let cells = grid(40, 1, |x, _| if x == 20 { glass } else { Matter::EMPTY });
    let source = Lamp { range: 1e5, ..lamp(10.5, 0.5) };
    let light = solve(&rays_only(|_| ()), &with_lamp(cells, source));
    for c in 0..3 {
        // In the glass as before it; behind it by colour·(1 − opacity).
        assert!((light.at(20, 0)[c] - 1.0).abs() < 1e-3);
        assert!((light.at(30, 0)[c] - 0.5 * glass.tint[c]).abs() < 1e-3);
    }
}

#[test]
fn a_bounce_takes_the_colour_of_the_wall_and_the_energy_of_the_ray() {
    let red = Matter { albedo: [1.0, 0.25, 0.0], ..WALL };
    let cells = grid(64, 33, |x, _| if x == 40 { red } else { Matter::EMPTY });
    let source = Lamp {
        range: 100.0,
        cone: Some(Cone { direction: 0.0, angle: 0.01, softness: 0.0, profile: None }),
        ..lamp(10.5, 16.5)
    };
    let cells = with_lamp(cells, source);
    let settings = rays_only(|s| (s.rays, s.bounce_rays) = (8, 8));
    let light = solve(&settings, &cells);
    // The ray meets the wall after 29.5 px; straight up from the cell before it goes a bounced one.
    for up in 1..16u32 {
        let energy = 0.705 * (1.0 - up as f32 / 100.0);
        for c in 0..3 {
            let found = light.at(39, 16 - up)[c];
            assert!((found - energy * red.albedo[c]).abs() < 1e-4, "{up}: {found}");
        }
    }
    // Nothing of it on the other side.
    assert!((41..64).all(|x| (0..33).all(|y| light.at(x, y) == [0.0; 3])));
    // Without bounces it is dark there.
    let light = solve(&rays_only(|s| s.rays = 8), &cells);
    assert_eq!(light.at(39, 10), [0.0; 3]);
}

#[test]
fn matter_and_sky_give_light_too() {
    let mut cells = grid(48, 48, |x, y| if [x, y] == [24, 24] { GLOW } else { Matter::EMPTY });
    let light = solve(&flood(|_| ()), &cells);
    assert!(light.at(26, 24)[0] > 0.1 && light.at(24, 24)[0] >= 1.0);
    cells = grid(48, 48, |_, _| Matter::EMPTY);
    assert_eq!(brightest(&solve(&flood(|_| ()), &cells)), 0.0);
    cells.set_sky(Sky::Uniform([0.25, 0.5, 1.0]));
    let light = solve(&flood(|_| ()), &cells);
    let middle = light.at(24, 24);
    assert!(middle[2] > 0.05 && middle[2] <= 1.0 && (middle[2] - 4.0 * middle[0]).abs() < 1e-4);
}

#[test]
fn walls_show_the_light_in_front_of_their_faces() {
    let cells = grid(32, 32, |x, _| if x >= 20 { WALL } else { Matter::EMPTY });
    let light = solve(&flood(|_| ()), &with_lamp(cells, lamp(10.5, 16.5)));
    assert!(light.at(20, 16)[0] > 0.0);
    assert_eq!(light.at(20, 16), light.at(19, 16));
    assert_eq!(light.at(22, 16), [0.0; 3]);
}

#[test]
fn energy_stays_between_frames_until_reset() {
    let lit = with_lamp(Cells::new(33, 33).unwrap(), Lamp { intensity: 2.0, ..lamp(16.5, 16.5) });
    let dark = Cells::new(33, 33).unwrap();
    let mut solver = Solver::new(flood(|_| ())).unwrap();
    let first = frames(&mut solver, &lit, 1);
    let energy = solver.stages().energy.to_vec();
    assert!(energy.len() == 33 * 33 && energy[16 * 33 + 16] > 0.0);
    assert!(brightest(&frames(&mut solver, &dark, 1)) > 0.0, "a trail is left");
    solver.reset();
    assert_eq!(brightest(&frames(&mut solver, &dark, 1)), 0.0);
    solver.reset();
    assert_eq!(bits(&frames(&mut solver, &lit, 1)), bits(&first));
    // Another size is another scene.
    assert_eq!(brightest(&frames(&mut solver, &Cells::new(32, 33).unwrap(), 1)), 0.0);
    // A cell that becomes a wall keeps nothing of its light.
    frames(&mut solver, &lit, 3);
    let mut walled = Cells::new(33, 33).unwrap();
    walled.set(16, 16, WALL);
    frames(&mut solver, &walled, 1);
    assert_eq!(solver.stages().energy[16 * 33 + 16], 0.0);
}

#[test]
fn energy_stays_in_the_world_as_the_grid_moves() {
    // The grid at a place of a world with a pillar and a lamp.
    let at = |[left, top]: [i32; 2]| {
        let pillar = |x: u32, y: u32| {
            (44..48).contains(&(x as i32 + left)) && (20..30).contains(&(y as i32 + top))
        };
        let cells = grid(72, 48, |x, y| if pillar(x, y) { WALL } else { Matter::EMPTY });
        with_lamp(cells, lamp(34.5 - left as f32, 24.5 - top as f32))
    };
    let still = frames(&mut Solver::new(flood(|_| ())).unwrap(), &at([8, -8]), 9);
    let [kept, left_behind] = [true, false].map(|shifts| {
        let mut solver = Solver::new(flood(|_| ())).unwrap();
        for step in 0..9 {
            if shifts && step > 0 {
                solver.shift([1, -1]);
            }
            solver.solve(&at([step, -step])).unwrap();
        }
        relative_rmse(solver.light(), &still)
    });
    println!("{kept:.4}, without the shift {left_behind:.4}");
    assert!(kept < MOVED && left_behind > MOVED, "{kept}, without the shift {left_behind}");
    // As far as the grid is wide, nothing is left.
    let mut solver = Solver::new(flood(|_| ())).unwrap();
    solver.solve(&at([0, 0])).unwrap();
    solver.shift([i32::MIN, 0]);
    assert_eq!(brightest(solver.solve(&Cells::new(72, 48).unwrap()).unwrap()), 0.0);
}

#[test]
fn every_size_and_place_is_lit() {
    for (w, h) in [(1, 1), (1, 7), (7, 1), (97, 101)] {
        let [width, height] = [w as f32, h as f32];
        for position in [[0.0, 0.0], [width, height], [width / 2.0, height / 2.0], [-7.5, 3.0]] {
            let mut cells = with_lamp(jumble(w, h, 9), Lamp { position, ..LAMP });
            cells.set_sky(Sky::Uniform([0.5; 3]));
            for settings in variants() {
                let light = frames(&mut Solver::new(settings).unwrap(), &cells, 3);
                assert!(light.pixels().as_flattened().iter().all(|v| (0.0..=2.0).contains(v)));
                assert_eq!(light.at(w - 1, h - 1), *light.pixels().last().unwrap());
            }
        }
    }
}

#[test]
fn non_finite_values_are_rejected() {
    let mut cells = Cells::new(4, 4).unwrap();
    cells.emission_mut()[5][1] = f32::NAN;
    let error = Solver::new(flood(|_| ())).unwrap().solve(&cells).unwrap_err().to_string();
    assert_eq!(error, "cell (1, 1): emission is NaN, but must be 0 to 1e12");
}
