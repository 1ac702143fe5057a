//! Exact direct light below the light of other methods.

use crate::common::{grid, solve};
use lamplight::settings::{Blend, MethodSettings, Polar};
use lamplight::{
    Bounces, Cells, Direct, Falloff, Lamp, Light, Matter, Method, Moment, Settings, Sun,
};

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
        let one = light(&[lamp]);
        let takes = |intensity| Lamp { intensity, ..lamp };
        let none = light(&[takes(-20.0), lamp, takes(-20.0)]);
        assert!(none.pixels().as_flattened().iter().all(|&v| v == 0.0) || !same_rule, "{name}");
        assert!(of(&none) < 0.2 * of(&one), "{name}");
        assert!(none.pixels().as_flattened().iter().all(|&v| v >= 0.0), "{name}");
        if !same_rule {
            continue;
        }
        let half = light(&[takes(-0.5 * lamp.intensity), lamp]);
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
            cells.lamps_mut().push(Lamp { mask, ..lamp });
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
