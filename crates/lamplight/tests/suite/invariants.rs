//! Invariants of `raymarch`, and scenes with known results.

use crate::common::*;
use lamplight::settings::{Hit, Noise, Raymarch};
use lamplight::{Bounces, Cells, Error, Lamp, Light, Matter, Rgb, Settings, Sky, Solver};
use std::f64::consts::PI;

/// Sums of some hundred f32, relative.
const ROUNDING: f32 = 1e-5;

fn rays(rays: u32) -> Settings {
    settings(|s| raymarch_of(s).rays = rays)
}

fn bounces(count: u32, rays: u32) -> Settings {
    settings(|s| (s.bounces, raymarch_of(s).rays) = (Bounces::Count(count), rays))
}

#[test]
fn under_a_uniform_sky_light_is_the_sky() {
    let sky = [0.3, 1.0, 700.0];
    let mut cells = Cells::new(37, 23).unwrap();
    cells.set_sky(Sky::Uniform(sky));
    for hit in [Hit::Edge, Hit::Distance] {
        let light = solve(&settings(|s| raymarch_of(s).hit = hit), &cells);
        for pixel in light.pixels() {
            (0..3).for_each(|c| near(pixel[c], f64::from(sky[c]), f64::from(ROUNDING)));
        }
    }
    // White walls reflect all of it and change nothing.
    cells.set(18, 11, Matter { albedo: [1.0; 3], ..WALL });
    let light = solve(&bounces(1, 64), &cells);
    (0..3).for_each(|c| near(light.at(20, 11)[c], f64::from(sky[c]), f64::from(ROUNDING)));
}

/// The most that light may change by a quarter turn with 4096 rays, which differ: 1/rays of the
/// light for each edge that is seen, and a jumble has some dozens.
const TURNED: f64 = 0.01;

#[test]
fn turning_the_scene_turns_the_light() {
    let cells = jumble(29, 18, 3);
    let settings = bounces(1, 4096);
    let light = solve(&settings, &cells);
    let around = solve(&settings, &turned(&cells));
    let back = |wrong: u32| {
        let rgb = (0..29 * 18).map(|i| around.at(17 - i / 29, (i % 29 + wrong) % 29)).collect();
        relative_rmse(&Light::from_pixels(&cells, rgb).unwrap(), &light)
    };
    println!("a quarter turn changes light by {:.3} %", 100.0 * back(0));
    assert!(back(0) < TURNED, "{}", back(0));
    assert!(back(1) > 10.0 * TURNED, "light that is off by a px passes");
}

#[test]
fn light_is_linear_in_emission() {
    for settings in [bounces(0, 16), bounces(3, 16), Settings { wall_depth: 3.0, ..rays(8) }] {
        expect_linear_in_emission(&settings, ROUNDING);
    }
}

#[test]
fn more_emission_never_darkens() {
    let mut brighter = 0;
    for seed in 1..5 {
        let random = &mut seeded(seed);
        let cells = jumble(31, 22, seed);
        let walls: Vec<usize> = (0..cells.len()).filter(|&i| cells.is_solid(i)).collect();
        let raised = walls[random.usize(..walls.len())];
        let after = relit(&cells, |i, e| if i == raised { e.map(|v| v + 2.0) } else { e }, 1.0);
        for settings in [bounces(0, 16), bounces(2, 16)] {
            let (before, after) = (solve(&settings, &cells), solve(&settings, &after));
            for (b, a) in before.pixels().iter().zip(after.pixels()) {
                assert!((0..3).all(|c| a[c] >= b[c]), "seed {seed}: {b:?} to {a:?}");
                brighter += usize::from(a[0] > b[0]);
            }
        }
    }
    assert!(brighter > 100, "only {brighter} cells changed");
}

/// A closed box whose walls emit E and reflect ρ.
fn furnace(albedo: f32) -> Cells {
    room(15, 11, Matter { emission: [0.5; 3], albedo: [albedo; 3], ..WALL })
}

fn in_the_furnace(albedo: f64, bounces: u32) -> f64 {
    (0..=bounces).map(|k| 0.5 * albedo.powi(k as i32)).sum()
}

#[track_caller]
fn all_open_cells_are(light: &Light, expected: f64, tolerance: f64) {
    for i in (0..light.pixels().len()).filter(|&i| !light.solid()[i]) {
        near(light.pixels()[i][1], expected, tolerance);
    }
}

#[test]
fn a_furnace_is_a_geometric_series() {
    for albedo in [0.3, 0.9, 1.0] {
        for count in [0, 1, 2, 7] {
            for hit in [Hit::Edge, Hit::Distance] {
                let mut settings = bounces(count, 8);
                raymarch_of(&mut settings).hit = hit;
                let light = solve(&settings, &furnace(albedo));
                all_open_cells_are(&light, in_the_furnace(f64::from(albedo), count), 1e-4);
            }
        }
    }
    let converged = settings(|s| s.bounces = Bounces::Converged);
    for albedo in [0.3, 0.7] {
        all_open_cells_are(
            &solve(&converged, &furnace(albedo)),
            0.5 / f64::from(1.0 - albedo),
            0.005,
        );
    }
}

#[test]
fn perfect_mirrors_for_walls_stay_finite() {
    for bounces in [Bounces::Converged, Bounces::Count(Bounces::MAX)] {
        let light =
            solve(&settings(|s| (s.bounces, raymarch_of(s).rays) = (bounces, 4)), &furnace(1.0));
        let most = in_the_furnace(1.0, Bounces::MAX) as f32;
        for pixel in light.pixels() {
            assert!(pixel.iter().all(|v| *v > 0.0 && *v <= 1.001 * most + 0.5), "{pixel:?}");
        }
    }
}

#[test]
fn walls_reflect_about_the_same_under_every_hit_rule() {
    // A lamp before a white wall; the light behind a screen is reflected light alone.
    let mut cells = room(40, 30, Matter { albedo: [0.8; 3], ..WALL });
    (0..20).for_each(|y| cells.set(20, 1 + y, WALL));
    cells.lamps_mut().push(Lamp { position: [8.0, 8.0], size: 2.0, ..LAMP });
    let behind = |raymarch: Raymarch| {
        let raymarch = Raymarch { rays: 256, steps: 4096, ..raymarch };
        let settings = settings(|s| (s.method, s.bounces) = (raymarch.into(), Bounces::Count(2)));
        f64::from(solve(&settings, &cells).over([24.0, 2.0], [38.0, 12.0])[0])
    };
    let edge = behind(unfiltered(Raymarch::default()));
    for hit_distance in [0.5, 0.8, 2.0] {
        let distance = behind(Raymarch {
            hit: Hit::Distance,
            hit_distance,
            ..unfiltered(Raymarch::default())
        });
        println!("within {hit_distance} px: {distance:.5}, to the edge: {edge:.5}");
        // Shapes get fatter by the distance: the way round the screen is 9 px wide, a lamp 4.
        assert!((distance / edge - 1.0).abs() < 0.25 * hit_distance.max(1.0) as f64);
    }
}

/// A corridor 1 px high with an emitter at its end and something in between; the light in the
/// last cell, `length` px away.
fn corridor(length: u32, between: Matter, raymarch: Raymarch) -> Rgb {
    let cells = grid(length + 2, 3, |x, y| match (x, y) {
        (0, 1) => GLOW,
        (x, 1) if x == length + 1 => Matter::EMPTY,
        (_, 1) => between,
        _ => WALL,
    });
    let settings = settings(|s| *raymarch_of(s) = Raymarch { rays: 65_536, ..raymarch });
    solve(&settings, &cells).at(length + 1, 1)
}

/// `(1/2π)∫f dθ` over the emitter's face seen from the last cell's centre; `f(s)` is what comes from
/// `s` px away along the ray, of which `inside` px lie between.
fn through_the_corridor(length: u32, f: impl Fn(f64, f64) -> f64) -> f64 {
    let (far, inside) = (f64::from(length) + 0.5, f64::from(length));
    let end = (0.5 / far).atan();
    let n = 2000;
    let sum: f64 = (0..n)
        .map(|i| {
            let cos = (end * (f64::from(i) + 0.5) / f64::from(n)).cos();
            f(far / cos, inside / cos)
        })
        .sum();
    sum * end / f64::from(n) / PI
}

/// 65,536 rays hit or miss the far end by one ray of some hundred.
const CORRIDOR: f64 = 0.005;

#[test]
fn fog_and_glass_follow_beer_and_lambert() {
    for length in [3, 12, 30] {
        let (opacity, tint) = (0.1, [1.0, 0.9, 0.5]);
        let light = corridor(
            length,
            Matter { opacity, tint, ..Matter::EMPTY },
            unfiltered(Raymarch::default()),
        );
        for c in 0..3 {
            let per_px = (1.0 - f64::from(opacity)) * f64::from(tint[c]);
            let expected = through_the_corridor(length, |_, inside| per_px.powf(inside));
            // Under a millionth rays may give up.
            near(light[c], expected, CORRIDOR + 1e-6 / per_px.powi(length as i32));
        }
    }
}

#[test]
fn attenuation_follows_its_formula() {
    // Range is in heights of the grid: 3 px here.
    for (emission_range, emission_dropoff) in [(8.0, 2.0), (20.0, 0.5), (5.0, 1.0)] {
        let raymarch = Raymarch {
            attenuation: true,
            emission_range,
            emission_dropoff,
            ..unfiltered(Raymarch::default())
        };
        for length in [2, 10] {
            let light = corridor(length, Matter::EMPTY, raymarch.clone());
            let expected = through_the_corridor(length, |s, _| {
                let share = 1.0 - (s / (3.0 * f64::from(emission_range))).powi(2);
                share.max(0.0).powf(f64::from(emission_dropoff))
            });
            near(light[0], expected, CORRIDOR);
        }
        let beyond = corridor(3 * emission_range as u32 + 1, Matter::EMPTY, raymarch);
        assert_eq!(beyond, [0.0; 3]);
    }
}

#[test]
fn the_emission_multiplier_multiplies_emission_and_not_the_sky() {
    let cells = jumble(23, 17, 5);
    let times = |factor: f32| {
        let mut settings = bounces(1, 16);
        raymarch_of(&mut settings).emission_multiplier = factor;
        settings
    };
    for factor in [0.0, 0.5, 4.0] {
        let multiplied = solve(&times(factor), &cells);
        let brighter = solve(&times(1.0), &relit(&cells, |_, e| e.map(|v| v * factor), 1.0));
        for i in (0..cells.len()).filter(|&i| !cells.is_solid(i)) {
            assert_eq!(multiplied.pixels()[i], brighter.pixels()[i], "cell {i}, × {factor}");
        }
    }
}

#[test]
fn fog_below_the_threshold_counts_as_empty() {
    let raymarch = |threshold| Raymarch { threshold, ..unfiltered(Raymarch::default()) };
    let fog = Matter { opacity: 0.2, ..Matter::EMPTY };
    let empty = corridor(5, Matter::EMPTY, unfiltered(Raymarch::default()));
    assert_eq!(corridor(5, fog, raymarch(0.2)), empty);
    assert!(corridor(5, fog, raymarch(0.19))[0] < 0.5 * empty[0]);
}

#[test]
fn few_steps_darken_and_never_brighten() {
    let cells = jumble(40, 30, 6);
    let with = |steps| {
        let settings = settings(|s| raymarch_of(s).steps = steps);
        solve(&settings, &cells)
    };
    let all = with(4096);
    let mut darker = 0;
    for steps in [1, 2, 5, 20] {
        for (few, all) in with(steps).pixels().iter().zip(all.pixels()) {
            assert!((0..3).all(|c| few[c] <= all[c] * (1.0 + ROUNDING)), "{few:?}, {all:?}");
            darker += usize::from(few[0] < all[0]);
        }
    }
    assert!(darker > 100, "{darker}");
}

#[test]
fn every_size_and_setting_gives_finite_light() {
    let fog = Matter { opacity: 0.3, albedo: [0.5; 3], ..Matter::EMPTY };
    for (w, h) in [(1, 1), (1, 40), (40, 1), (2, 2), (257, 1), (1, 257), (17, 3)] {
        for matter in [Matter::EMPTY, WALL, GLOW, fog] {
            for hit in [Hit::Edge, Hit::Distance] {
                let mut cells = grid(w, h, |x, y| if (x + y) % 3 == 0 { matter } else { fog });
                if matter == Matter::EMPTY {
                    cells = grid(w, h, |_, _| matter);
                }
                cells.set_sky(Sky::Uniform([0.5; 3]));
                let settings = settings(|s| {
                    (s.bounces, s.wall_depth) = (Bounces::Count(2), 2.0);
                    (raymarch_of(s).temporal.history_length, raymarch_of(s).denoise.passes) =
                        (8, 5);
                    (raymarch_of(s).hit, raymarch_of(s).noise) = (hit, Noise::White);
                });
                let mut solver = Solver::new(settings).unwrap();
                for _ in 0..2 {
                    let light = solver.solve(&cells).unwrap();
                    let sane = |v: &f32| (0.0..=2.5).contains(v);
                    assert!(light.pixels().as_flattened().iter().all(sane), "{w}×{h}, {matter:?}");
                }
                let light = solver.light();
                if matter == Matter::EMPTY {
                    all_open_cells_are(light, 0.5, f64::from(ROUNDING));
                }
                assert_eq!((light.width(), light.height()), (w, h));
            }
        }
    }
}

#[test]
fn invalid_matter_is_rejected_with_its_cell() {
    type Spoil = fn(&mut Cells);
    let cases: [(&str, Spoil); 13] = [
        ("cell (2, 1): emission is NaN, but must be 0 to 1e12", |c| {
            c.emission_mut()[7][1] = f32::NAN;
        }),
        ("cell (0, 3): emission is -1, but must be 0 to 1e12", |c| {
            c.emission_mut()[15][0] = -1.0;
        }),
        ("cell (4, 3): emission is inf, but must be 0 to 1e12", |c| {
            c.emission_mut()[19][2] = f32::INFINITY;
        }),
        ("cell (2, 1): opacity is NaN, but must be 0 to 1", |c| c.opacity_mut()[7] = f32::NAN),
        ("cell (1, 0): opacity is 1.5, but must be 0 to 1", |c| c.opacity_mut()[1] = 1.5),
        ("cell (0, 0): tint is -0.5, but must be 0 to 1", |c| c.tint_mut()[0][2] = -0.5),
        ("cell (3, 2): albedo is 2, but must be 0 to 1", |c| c.albedo_mut()[13][0] = 2.0),
        ("cell (3, 2): color is NaN, but must be 0 to 1e12", |c| c.color_mut()[13][0] = f32::NAN),
        ("cell (0, 0): color is -1, but must be 0 to 1e12", |c| c.color_mut()[0][2] = -1.0),
        ("`sky` is NaN, but must be a radiance from 0 to 1e12", |c| {
            c.set_sky(Sky::Uniform([0.0, f32::NAN, 0.0]));
        }),
        // Sums and products of brighter light overflow.
        ("cell (2, 1): emission is 2000000000000, but must be 0 to 1e12", |c| {
            c.emission_mut()[7][1] = 2e12;
        }),
        ("cell (2, 1): glow is 2000000000000, but must be 0 to 1e12", |c| {
            c.glow_mut()[7][1] = 2e12;
        }),
        ("`sky` is 2000000000000, but must be a radiance from 0 to 1e12", |c| {
            c.set_sky(Sky::Uniform([2e12; 3]));
        }),
    ];
    let good = jumble(5, 4, 1);
    let mut solver = Solver::new(Settings::default()).unwrap();
    for (message, spoil) in cases {
        let mut bad = good.clone();
        spoil(&mut bad);
        let error = solver.solve(&bad).unwrap_err();
        assert_eq!(error.to_string(), message);
        assert!(matches!(error, Error::Cell { .. }) || message.starts_with("`sky`"));
    }
    // A far cell, beyond the first chunk that is checked at once; and the solver still works.
    let mut large = Cells::new(300, 200).unwrap();
    large.albedo_mut()[200 * 300 - 1][2] = f32::NAN;
    let error = solver.solve(&large).unwrap_err().to_string();
    assert!(error.starts_with("cell (299, 199): albedo is NaN"), "{error}");
    assert_eq!(bits(solver.solve(&good).unwrap()), bits(&solve(&Settings::default(), &good)));
}

#[test]
fn empty_and_oversized_grids_are_rejected() {
    for (w, h) in [(0, 5), (5, 0), (40_000, 40_000), (16_385, 1), (16_384, 16_384)] {
        let error = Cells::new(w, h).unwrap_err().to_string();
        assert!(error.starts_with(&format!("a grid of {w}×{h} cells is refused: ")), "{error}");
    }
}
