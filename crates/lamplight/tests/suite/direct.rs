//! Exact direct light below the light of other methods.

use crate::common::{fresh, grid, solve};
use lamplight::settings::{Blend, MethodSettings, Polar};
use lamplight::{
    Bounces, Cells, Direct, Falloff, Lamp, Light, Matter, Method, Moment, Relief, Settings, Sun,
};
use std::f32::consts::TAU;

fn direct(cells: &Cells) -> Light {
    solve(&Settings::direct(Method::Cascades), cells)
}

fn exact(position: [f32; 2]) -> Lamp {
    Lamp { position, direct: Direct::Exact, ..Lamp::default() }
}

#[test]
fn a_lamp_right_before_a_wall_in_fog_gives_finite_light() {
    // The lamp is in the middle of the cell before the wall, half in the fog.
    let mut cells = grid(40, 30, |x, y| match (x, y) {
        (20, _) => Matter { opacity: 1.0, albedo: [0.5; 3], ..Matter::EMPTY },
        (_, 0..15) => Matter { opacity: 0.05, albedo: [0.5; 3], ..Matter::EMPTY },
        _ => Matter::EMPTY,
    });
    cells.lamps_mut().push(exact([19.5, 14.5]));
    let light = direct(&cells);
    assert!(light.pixels().as_flattened().iter().all(|v| v.is_finite()));
    assert!(light.at(10, 20)[0] > 0.1);
}

#[test]
fn light_of_a_lamp_over_the_border_has_no_steps_before_a_shadow() {
    let mut cells = grid(60, 60, |x, y| {
        let opacity = f32::from(u8::from(y == 20 && x >= 35));
        Matter { opacity, ..Matter::EMPTY }
    });
    cells.lamps_mut().push(exact([59.0, 3.0]));
    let light = direct(&cells);
    let row: Vec<f32> = (10..35).map(|x| light.at(x, 28)[0]).collect();
    let (open, shadow) = row.split_at(11);
    assert!(open.windows(2).all(|pair| pair[1] > pair[0]), "{row:?}");
    assert!(shadow.windows(2).all(|pair| pair[1] <= pair[0]), "{row:?}");
    assert!(open[0] > 0.1 && shadow[13] == 0.0, "{row:?}");
}

#[test]
fn a_lamp_beside_a_wall_is_as_bright_as_in_the_open() {
    let light = |position, is_wall: fn(u32) -> bool| {
        let mut cells = grid(80, 60, |x, _| Matter {
            opacity: f32::from(u8::from(is_wall(x))),
            ..Matter::EMPTY
        });
        cells.lamps_mut().push(Lamp { size: 3.0, ..exact(position) });
        direct(&cells)
    };
    // From on the face of the wall to out of its reach: no beam along the normal, and no jump.
    for x in [20.0, 20.05, 20.5, 22.0, 24.0] {
        let [beside, open] = [|x| x < 20, |_| false].map(|is_wall| light([x, 30.5], is_wall));
        for (x, y) in (0..60).flat_map(|y| (26..80).map(move |x| (x, y))) {
            let [beside, open] = [beside.at(x, y)[0], open.at(x, y)[0]];
            assert!((beside / open - 1.0).abs() < 1e-3, "{x}, {y}: {beside}, not {open}");
        }
    }
    // Behind the wall, and of a lamp in it, there is nothing.
    assert!((0..20).all(|x| light([24.0, 30.5], |x| x == 20).at(x, 30) == [0.0; 3]));
    assert_eq!(light([15.5, 30.5], |x| x < 20).at(40, 30), [0.0; 3]);
}

/// All methods, `polar` with each of its blends.
fn methods() -> Vec<MethodSettings> {
    let blends = [Blend::Add, Blend::Max, Blend::Screen];
    let polar = blends.map(|blend| Polar { blend, ..Polar::default() }.into());
    let others = Method::ALL.iter().map(|&method| method.into());
    others
        .chain([MethodSettings::preset(Method::Holographic, "paper").unwrap()])
        .chain(polar)
        .collect()
}

/// White walls round a room, with a pillar and fog.
fn room() -> Cells {
    grid(60, 50, |x, y| match (x, y) {
        (3..57, 3..47) if !((30..34).contains(&x) && (20..30).contains(&y)) => Matter {
            opacity: 0.01 * f32::from(u8::from(x < 20)),
            albedo: [0.5; 3],
            ..Matter::EMPTY
        },
        _ => Matter { opacity: 1.0, albedo: [0.8; 3], ..Matter::EMPTY },
    })
}

/// Rounding of light that is added and taken away again, relative to it.
const ROUNDING: f32 = 1e-5;

#[test]
fn a_lamp_of_negative_intensity_takes_what_another_gives() {
    // So dim that `Blend::Screen` does not cap it.
    let lamp = Lamp { intensity: 0.9, ..exact([20.3, 15.6]) };
    for method in methods() {
        let name = method.method().name();
        // The rule of `flood` is another one than that of light that is taken away.
        let same_rule = method.method() != Method::Flood;
        let bounces = Bounces::Count(2);
        let settings = Settings { bounces, moment: true, ..Settings::new(method) };
        let light = |lamps: &[Lamp]| {
            let mut cells = room();
            cells.lamps_mut().extend_from_slice(lamps);
            solve(&settings, &cells)
        };
        let of = |light: &Light| light.pixels().as_flattened().iter().sum::<f32>();
        let one = light(std::slice::from_ref(&lamp));
        let takes = |intensity| Lamp { intensity, ..lamp.clone() };
        let none = light(&[takes(-20.0), lamp.clone(), takes(-20.0)]);
        assert!(none.pixels().as_flattened().iter().all(|&v| v == 0.0) || !same_rule, "{name}");
        assert!(of(&none) < 0.2 * of(&one), "{name}");
        assert!(none.pixels().as_flattened().iter().all(|&v| v >= 0.0), "{name}");
        if !same_rule {
            continue;
        }
        let half = light(&[takes(-0.5 * lamp.intensity), lamp.clone()]);
        for (half, one) in half.pixels().iter().zip(one.pixels()) {
            let off = (0..3).map(|c| (half[c] - 0.5 * one[c]).abs() - ROUNDING * one[c]);
            assert!(off.fold(0.0, f32::max) <= ROUNDING, "{name}: {half:?}, whole {one:?}");
        }
    }
}

#[test]
fn light_that_is_left_comes_from_no_farther_than_it_is_bright() {
    for method in methods() {
        let name = method.method().name();
        let mut cells = room();
        let takes = Lamp { intensity: -6.0, ..exact([45.0, 40.0]) };
        cells.lamps_mut().extend([exact([12.0, 12.0]), takes]);
        cells.suns_mut().push(Sun::default());
        let settings = Settings { moment: true, ..Settings::direct(method) };
        let light = solve(&settings, &cells);
        let lengths = light.moment().unwrap().iter().map(|[x, y]| x[1].hypot(y[1]));
        for ((length, rgb), solid) in lengths.zip(light.pixels()).zip(light.solid()) {
            assert!(*solid || length <= rgb[1] * (1.0 + ROUNDING), "{name}: {length}, {rgb:?}");
        }
        assert!(light.pixels().contains(&[0.0; 3]), "{name}");
    }
}

#[test]
fn heights_and_elevations_change_nothing_but_the_moment() {
    for method in methods() {
        let name = method.method().name();
        let settings = Settings { moment: true, ..Settings::new(method) };
        let light = |height: Option<f32>, elevation: Option<f32>| {
            let mut cells = room();
            // A window for the sun.
            (5..25).for_each(|x| (0..3).for_each(|y| cells.set(x, y, Matter::EMPTY)));
            // A mask makes it exact without a height, too.
            cells.masks_mut().fill(1);
            cells.lamps_mut().push(Lamp { height, mask: 1, ..exact([20.3, 35.6]) });
            cells.suns_mut().push(Sun { elevation, direction: 1.0, ..Sun::default() });
            solve(&settings, &cells)
        };
        let plain = light(None, None);
        for (height, elevation) in [(Some(10.0), None), (None, Some(0.2))] {
            let other = light(height, elevation);
            assert!(other.pixels() == plain.pixels(), "{name}: {height:?}, {elevation:?}");
            assert!(other.moment() != plain.moment(), "{name}: {height:?}, {elevation:?}");
        }
        let same = light(None, Some(settings.elevation));
        for (same, plain) in same.moment().unwrap().iter().zip(plain.moment().unwrap()) {
            for (same, plain) in same.as_flattened().iter().zip(plain.as_flattened()) {
                assert!((same - plain).abs() <= ROUNDING * plain.abs().max(1.0), "{name}");
            }
        }
    }
}

/// The largest error of the cosine law on tilted surfaces, relative to the light of a flat one: a lamp is a disc whose
/// edges are seen in other directions than its middle, `(size/d)²/6` at distance d.
const COSINE_LAW: f32 = 0.005;

#[test]
fn a_lamp_with_a_height_lights_tilted_surfaces_by_the_cosine_law() {
    let center = [30.3, 40.7];
    for method in methods() {
        for (height, elevation) in [(6.0, 0.8f32), (20.0, 0.3), (300.0, 1.4)] {
            let name = format!("{}, height {height}", method.method().name());
            let settings = Settings { moment: true, elevation, ..Settings::direct(method.clone()) };
            let mut cells = Cells::new(120, 90).unwrap();
            let lamp = Lamp { height: Some(height), intensity: 0.9, size: 1.0, ..exact(center) };
            cells.lamps_mut().push(lamp);
            let light = solve(&settings, &cells);
            assert_eq!(light.elevation(), elevation);
            for (x, y) in [(37, 40), (30, 60), (50, 20), (110, 80)] {
                let to = [center[0] - x as f32 - 0.5, center[1] - y as f32 - 0.5];
                let distance = to[0].hypot(to[1]);
                let (sin, cos) = height.atan2(distance).sin_cos();
                let towards = to.map(|v| v / distance * cos);
                let moment = &light.moment().unwrap()[cells.index(x, y)];
                let flat = light.at(x, y)[1];
                for tilt in [-0.9f32, -0.3, 0.2, 0.8] {
                    let normal = [0.6 * tilt.sin(), 0.8 * tilt.sin(), tilt.cos()];
                    let along = normal[0] * towards[0] + normal[1] * towards[1];
                    let expected = flat * (along + normal[2] * sin).max(0.0) / sin;
                    let shade = |elevation| {
                        Relief::default().shade(normal, light.at(x, y), moment, elevation).0[1]
                    };
                    let (found, bound) = (shade(elevation), COSINE_LAW * flat.max(expected));
                    assert!(
                        (found - expected).abs() < bound,
                        "{name}, {x}, {y}, {tilt}: {found}, not {expected}"
                    );
                    let steeper = shade(elevation + 0.1);
                    assert!(
                        (steeper - expected).abs() > bound || along.abs() < 0.1 || expected == 0.0,
                        "{name}: a steeper elevation passes at {x}, {y}, {tilt}"
                    );
                }
            }
        }
    }
}

/// [`room`] in two layers: the upper left is in 1, the lower left in 2, and the right in both.
fn layered_room() -> Cells {
    let mut cells = room();
    let width = cells.width() as usize;
    for (i, mask) in cells.masks_mut().iter_mut().enumerate() {
        *mask = match (i % width, i / width) {
            (30.., _) => 3,
            (_, 25..) => 2,
            _ => 1,
        };
    }
    cells
}

#[test]
fn lamps_and_suns_light_the_layers_of_their_mask_and_shadows_are_of_all() {
    let lamp = Lamp { falloff: Falloff::Smooth, ..exact([24.3, 26.6]) };
    for method in methods() {
        let name = method.method().name();
        let settings = Settings { moment: true, wall_depth: 0.0, ..Settings::direct(method) };
        let light = |cells: &mut Cells, mask: u8| {
            // Those of a single layer are lit by the same rule in `flood`.
            cells.lamps_mut().push(Lamp { mask, ..lamp.clone() });
            cells.suns_mut().push(Sun { mask, direction: 1.0, ..Sun::default() });
            solve(&settings, cells)
        };
        let (whole, cells) = (light(&mut room(), 4), layered_room());
        for mask in [1, 2, 3] {
            let seen = light(&mut cells.clone(), mask);
            let lit = |i: usize| cells.masks().unwrap()[i] & mask != 0;
            for (i, (seen, whole)) in seen.pixels().iter().zip(whole.pixels()).enumerate() {
                let expected = if lit(i) { *whole } else { [0.0; 3] };
                assert_eq!(*seen, expected, "{name}, mask {mask}, cell {i}");
            }
            let moments = seen.moment().unwrap().iter().enumerate().filter(|(i, _)| !lit(*i));
            moments.for_each(|(i, moment)| assert_eq!(*moment, Moment::default(), "{name}, {i}"));
        }
    }
}

#[test]
fn what_a_lamp_does_not_light_reflects_nothing_of_it() {
    let mut cells = room();
    cells.lamps_mut().push(Lamp { mask: 2, ..exact([40.3, 26.6]) });
    let width = cells.width() as usize;
    let in_room = |i: usize| (4..56).contains(&(i % width)) && (4..46).contains(&(i / width));
    let lit = |mask: u8| {
        let mut cells = cells.clone();
        // Walls and fog are in another layer than the air within.
        for i in 0..cells.len() {
            let is_air = cells.matter(i).opacity == 0.0 && in_room(i);
            cells.masks_mut()[i] = if is_air { 2 } else { mask };
        }
        [0, 2].map(|bounces| {
            let bounces = Bounces::Count(bounces);
            solve(&Settings { bounces, ..Settings::direct(Method::Holographic) }, &cells)
        })
    };
    let [direct, bounced] = lit(1);
    assert_eq!(direct.pixels(), bounced.pixels());
    let [direct, bounced] = lit(3);
    assert_ne!(direct.pixels(), bounced.pixels());
}

#[test]
fn cells_in_no_layer_are_refused() {
    let mut cells = room();
    cells.masks_mut()[60 * 3 + 7] = 0;
    let error = cells.check().unwrap_err().to_string();
    assert_eq!(error, "cell (7, 3): mask is 0, but must be a whole number from 1 to 255");
    cells.clear();
    assert!(cells.masks().is_none());
}

/// The transmittance of the straight line between a point and another, by where it crosses the lines between cells.
fn transmittance(cells: &Cells, from: [f64; 2], to: [f64; 2]) -> f64 {
    let size = [cells.width(), cells.height()];
    let way = [to[0] - from[0], to[1] - from[1]];
    let mut parts = vec![0.0, 1.0];
    for a in 0..2 {
        let crossings = (0..=size[a]).map(|line| (f64::from(line) - from[a]) / way[a]);
        parts.extend(crossings.filter(|part| (0.0..1.0).contains(part)));
    }
    parts.sort_by(f64::total_cmp);
    let length = way[0].hypot(way[1]);
    let stretches = parts.windows(2).filter(|ends| ends[0] < ends[1]);
    let left = stretches.map(|ends| {
        let at = [0, 1].map(|a| from[a] + 0.5 * (ends[0] + ends[1]) * way[a]);
        if (0..2).any(|a| !(0.0..f64::from(size[a])).contains(&at[a])) {
            return 1.0;
        }
        let opacity = cells.matter(cells.index(at[0] as u32, at[1] as u32)).opacity;
        (1.0 - f64::from(opacity)).powf((ends[1] - ends[0]) * length)
    });
    left.product()
}

/// The mean transmittance of lines from a cell to points across a light: `reach` px ahead, `beside` px to either side.
fn mean_transmittance(
    cells: &Cells,
    cell: usize,
    [x, y]: [f64; 2],
    [along, beside]: [f64; 2],
) -> f64 {
    const LINES: u32 = 32;
    let width = cells.width() as usize;
    let from = [cell % width, cell / width].map(|v| v as f64 + 0.5);
    let line = |number: u32| {
        let aside = (f64::from(2 * number + 1) / f64::from(LINES) - 1.0) * beside;
        let to = [from[0] + along * x - aside * y, from[1] + along * y + aside * x];
        transmittance(cells, from, to)
    };
    (0..LINES).map(line).sum::<f64>() / f64::from(LINES)
}

/// Leaves of any opacity in a fraction of all cells.
fn leaves(random: &mut fastrand::Rng, [width, height]: [u32; 2], fraction: f32) -> Cells {
    grid(width, height, |_, _| {
        let is_leaf = random.f32() < fraction;
        Matter { opacity: if is_leaf { random.f32() } else { 0.0 }, ..Matter::EMPTY }
    })
}

/// The largest rms error of light through leaves, relative to light without them: media are known by few rays.
/// Measured at up to 0.006.
const BY_FEW_RAYS: f64 = 0.012;

fn assert_rms(errors: &[f64], case: &str) {
    let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    println!("{case}: rms {rms:.5}");
    assert!(rms < BY_FEW_RAYS, "{case}: {rms}");
}

#[test]
fn a_sun_shines_through_leaves_as_lines_to_it_do() {
    let random = &mut fresh();
    let small = [60, 40];
    // The last is so long that its rays cannot keep all leaves, and lies along them.
    let cases =
        [(small, 0.1, 0.02), (small, 0.4, 0.02), (small, 0.1, 0.1), ([400, 12], 0.03, 0.02)];
    for (size, fraction, angle) in cases {
        let mut cells = leaves(random, size, fraction);
        let direction = if size == small { TAU * random.f32() } else { 0.05 };
        let sun = Sun { direction, angle, direct: Direct::Exact, ..Sun::default() };
        let mut open = Cells::new(1, 1).unwrap();
        [&mut cells, &mut open].into_iter().for_each(|cells| cells.suns_mut().push(sun));
        let (light, whole) = (direct(&cells), f64::from(direct(&open).at(0, 0)[0]));
        let towards = [-f64::from(direction).cos(), -f64::from(direction).sin()];
        let fan = [1000.0, 1000.0 * (0.5 * f64::from(angle)).tan()];
        let errors = (0..cells.len()).map(|cell| {
            let right = mean_transmittance(&cells, cell, towards, fan);
            f64::from(light.pixels()[cell][0]) / whole - right
        });
        assert_rms(&errors.collect::<Vec<_>>(), &format!("{size:?}, {fraction}, {angle} rad"));
    }
}

#[test]
fn slivers_of_a_light_past_a_wall_are_seen_through_the_pane_behind_it() {
    let scene = |opacity| {
        grid(60, 40, |x, y| match (x, y) {
            (30, ..20) => Matter { opacity: 1.0, ..Matter::EMPTY },
            (40, _) => Matter { opacity, ..Matter::EMPTY },
            _ => Matter::EMPTY,
        })
    };
    let lamp = Lamp { size: 8.0, ..exact([10.5, 20.5]) };
    let sun = Sun { angle: 0.5, direct: Direct::Exact, ..Sun::default() };
    let lit = |lamps: &[Lamp], suns: &[Sun]| {
        [0.0, 0.9].map(|opacity| {
            let mut cells = scene(opacity);
            cells.lamps_mut().extend_from_slice(lamps);
            cells.suns_mut().extend_from_slice(suns);
            direct(&cells)
        })
    };
    for [clear, glass] in [lit(&[lamp], &[]), lit(&[], &[Sun { direction: 0.0, ..sun }])] {
        // Away from the border, beyond which the sun shines past the pane.
        let behind = (8..32).flat_map(|y| (41..60).map(move |x| (x, y)));
        for (x, y) in behind {
            let (clear, glass) = (clear.at(x, y)[0], glass.at(x, y)[0]);
            // No line through the pane is shorter than a px.
            assert!(glass <= 0.1 * clear * (1.0 + ROUNDING), "{x}, {y}: {glass} of {clear}");
        }
    }
}
