//! A lamp keeps its light wherever between the cells it stands, whether it glows or is solid.

use crate::common::LAMP;
use lamplight::{Cells, Cone, Lamp, Profile, Scene};
use std::f64::consts::PI;

/// The specified tolerance of solid lamps over all positions, and relative to the ideal disc.
const TOLERANCE: f64 = 0.02;
/// Rounding of the coverage of some hundred cells.
const ROUNDING: f64 = 1e-4;
/// The largest distance of the centre of a drawn lamp from its position, px.
const CENTRE: f64 = 0.03;

/// Total light that leaves the solid lamp drawn into a grid ÷ that of the ideal disc of its size:
/// `∫∫ L db dω ÷ (2π · 2·size)`, each parallel ray cut with every lit cell's box.
fn light_against_ideal(lamp: Lamp, directions: usize, offsets: usize) -> f64 {
    let side = (2.0 * lamp.position[0]) as u32;
    let mut cells = Cells::new(side, side).unwrap();
    cells.lamps_mut().push(lamp.clone());
    let drawn = cells.drawn();
    let lit: Vec<_> = (0..side * side)
        .map(|i| (i % side, i / side))
        .filter_map(|(x, y)| {
            let matter = drawn.get(x, y).unwrap();
            (matter.opacity > 0.0).then_some((f64::from(x), f64::from(y), matter))
        })
        .collect();
    let radiance = f64::from(lit[0].2.emission[0]);
    assert!(lit.iter().all(|(.., m)| (f64::from(m.emission[0]) / radiance - 1.0).abs() < 1e-5));
    let [cx, cy] = lamp.position.map(f64::from);
    let reach = f64::from(lamp.size) + 1.5;
    let mut total = 0.0;
    for d in 0..directions {
        // A full turn, an odd number of directions: none lies along an axis.
        let (sin, cos) = (2.0 * PI * (d as f64 + 0.37) / directions as f64).sin_cos();
        for o in 0..offsets {
            let b = reach * (2.0 * (o as f64 + 0.5) / offsets as f64 - 1.0);
            let (px, py) = (cx - b * sin, cy + b * cos);
            let mut passed = 1.0f64;
            for &(x, y, matter) in &lit {
                let (x0, x1) = ((x - px) / cos, (x + 1.0 - px) / cos);
                let (y0, y1) = ((y - py) / sin, (y + 1.0 - py) / sin);
                let length = x0.max(x1).min(y0.max(y1)) - x0.min(x1).max(y0.min(y1));
                if length > 0.0 {
                    passed *= (1.0 - f64::from(matter.opacity)).powf(length);
                }
            }
            total += radiance * (1.0 - passed);
        }
    }
    let mean_width = total / (directions * offsets) as f64 * 2.0 * reach;
    mean_width / (2.0 * f64::from(lamp.size) * f64::from(lamp.color[0] * lamp.intensity))
}

fn lamp(size: f32, dx: f32, dy: f32) -> Lamp {
    let middle = (size + 2.0).ceil();
    Lamp {
        position: [middle + dx, middle + dy],
        color: [0.75; 3],
        intensity: 4.0,
        size,
        solid: true,
        ..LAMP
    }
}

#[test]
fn a_lamp_glows_as_much_as_its_ideal_disc_at_every_tenth_of_a_px() {
    for size in [0.05, 0.3, 0.5, 1.0, 2.0, 7.9, 48.0] {
        for (i, j) in (0..10).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            let lamp = Lamp { solid: false, ..lamp(size, i as f32 / 10.0, j as f32 / 10.0) };
            let side = (2.0 * lamp.position[0]) as u32 + 2;
            let mut cells = Cells::new(side, side).unwrap();
            cells.lamps_mut().push(lamp.clone());
            let drawn = cells.drawn();
            let glow = |i: usize| f64::from(drawn.glow().unwrap()[i][0]);
            let total: f64 = (0..drawn.len()).map(glow).sum();
            let ideal = 2.0 * 3.0 * f64::from(size);
            assert!((total / ideal - 1.0).abs() < ROUNDING, "size {size}: {total}, not {ideal}");
            // Its centre is that of the disc.
            let middle: f64 =
                (0..drawn.len()).map(|i| glow(i) * ((i as u32 % side) as f64 + 0.5)).sum();
            let off = middle / total - f64::from(lamp.position[0]);
            assert!(off.abs() < CENTRE, "size {size}: {off} px off");
            assert!(drawn.opacity().iter().all(|&opacity| opacity == 0.0));
        }
    }
}

#[test]
fn lamps_that_overlap_add_up() {
    let drawn = |lamps: &[Lamp]| {
        let mut cells = Cells::new(16, 16).unwrap();
        cells.lamps_mut().extend_from_slice(lamps);
        cells.drawn().glow().unwrap().to_vec()
    };
    let at = |x| Lamp { position: [x, 8.0], size: 3.0, ..LAMP };
    let both = drawn(&[at(7.0), at(9.5)]);
    for (both, (a, b)) in both.iter().zip(drawn(&[at(7.0)]).iter().zip(drawn(&[at(9.5)]))) {
        assert_eq!(both[0], a[0] + b[0]);
    }
}

#[test]
fn light_is_the_same_at_every_tenth_of_a_px() {
    for size in [0.05, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 7.9] {
        let (mut least, mut most) = (f64::MAX, f64::MIN);
        for (i, j) in (0..10).flat_map(|i| (0..10).map(move |j| (i, j))) {
            // The whole lattice where the position matters most, an octant elsewhere.
            if size > 1.0 && (i > 5 || j > i) || size > 4.0 && (i % 2 == 1 || j % 2 == 1) {
                continue;
            }
            let light = light_against_ideal(lamp(size, i as f32 / 10.0, j as f32 / 10.0), 37, 160);
            (least, most) = (least.min(light), most.max(light));
        }
        println!("size {size}: light ÷ ideal from {least:.4} to {most:.4}");
        assert!(most - least < TOLERANCE, "size {size}: {least} to {most}");
        assert!(least > 1.0 - TOLERANCE && most < 1.0 + TOLERANCE, "size {size}");
    }
}

#[test]
fn large_lamps_follow_the_fitted_width() {
    for size in [8.1, 12.0, 24.0, 48.0] {
        for (dx, dy) in [(0.0, 0.0), (0.5, 0.5), (0.3, 0.1)] {
            let light = light_against_ideal(lamp(size, dx, dy), 13, 400);
            println!("size {size} at ({dx}, {dy}): light ÷ ideal {light:.4}");
            assert!((light - 1.0).abs() < TOLERANCE, "size {size}: {light}");
        }
    }
}

#[test]
fn the_measure_rejects_a_lamp_that_is_drawn_wrong() {
    let right = light_against_ideal(lamp(1.0, 0.3, 0.4), 37, 160);
    let wide = Lamp { size: 1.05, ..lamp(1.0, 0.3, 0.4) };
    let wrong = light_against_ideal(wide, 37, 160) * 1.05;
    assert!((right - 1.0).abs() < TOLERANCE && (wrong - 1.0).abs() > TOLERANCE);
}

#[test]
fn lamps_at_and_beyond_the_border_are_cut_off() {
    let mut cells = Cells::new(8, 8).unwrap();
    let at = |x, y| Lamp { position: [x, y], size: 2.0, solid: true, ..LAMP };
    cells.lamps_mut().extend([at(0.0, 4.0), at(-50.0, 4.0), at(8.0, 8.0), at(4.0, 1e6)]);
    let drawn = cells.drawn();
    assert_eq!(drawn.get(0, 4).unwrap().opacity, 1.0);
    assert_eq!(drawn.get(7, 7).unwrap().opacity, 1.0);
    assert_eq!(drawn.get(4, 2).unwrap().opacity, 0.0);
    assert!(drawn.lamps().is_empty());
    drawn.check().unwrap();
    cells.lamps_mut().iter_mut().for_each(|lamp| lamp.solid = false);
    let glow = cells.drawn().glow().unwrap().to_vec();
    let full = 1.0 / std::f32::consts::PI;
    assert_eq!([32, 63, 20].map(|i| glow[i][0]), [full, full, 0.0]);
}

#[test]
fn a_lamp_that_is_off_draws_nothing() {
    let mut cells = Cells::new(8, 8).unwrap();
    cells.lamps_mut().push(Lamp { position: [4.0, 4.0], intensity: 0.0, ..LAMP });
    cells.lamps_mut().push(Lamp { position: [4.0, 4.0], color: [0.0; 3], ..LAMP });
    assert!(cells.drawn().glow().is_none());
    cells.lamps_mut().iter_mut().for_each(|lamp| lamp.solid = true);
    assert!(cells.drawn().opacity().iter().all(|&a| a == 0.0));
}

#[test]
fn invalid_lamps_are_rejected_by_key() {
    let good = Lamp { position: [1.0, 1.0], ..LAMP };
    let cone = |direction, angle, softness| Lamp {
        cone: Some(Cone { direction, angle, softness, profile: None }),
        ..good.clone()
    };
    let bad = [
        (Lamp { position: [f32::NAN, 1.0], ..good.clone() }, "`lamp[0].position` is [NaN, 1]"),
        (Lamp { color: [-1.0, 0.0, 0.0], ..good.clone() }, "`lamp[0].color` is [-1, 0, 0]"),
        (Lamp { intensity: f32::INFINITY, ..good.clone() }, "`lamp[0].intensity` is inf"),
        (
            Lamp { intensity: -2e6, ..good.clone() },
            "`lamp[0].intensity` is -2000000, but must be a number from -1000000 to 1000000",
        ),
        (Lamp { range: 0.0, ..good.clone() }, "`lamp[0].range` is 0"),
        (
            Lamp { mask: 0, ..good.clone() },
            "`lamp[0].mask` is 0, but must be a whole number from 1 to 255",
        ),
        (
            Lamp { size: 0.0, ..good.clone() },
            "`lamp[0].size` is 0, but must be a number from 0.05 to 512",
        ),
        (Lamp { size: 513.0, ..good.clone() }, "`lamp[0].size` is 513"),
        (
            Lamp { height: Some(0.0), ..good.clone() },
            "`lamp[0].height` is 0, but must be a number from 0.05 to 100000",
        ),
        (Lamp { height: Some(f32::NAN), ..good.clone() }, "`lamp[0].height` is NaN"),
        (cone(90.0, 1.0, 0.0), "`lamp[0].cone.direction` is 90, but must be a number from -6.2832"),
        (cone(f32::NAN, 1.0, 0.0), "`lamp[0].cone.direction` is NaN"),
        (
            cone(0.0, 0.0, 0.0),
            "`lamp[0].cone.angle` is 0, but must be a number from 0.001 to 6.2832",
        ),
        (cone(0.0, 7.0, 0.0), "`lamp[0].cone.angle` is 7"),
        (cone(0.0, 1.0, 1.5), "`lamp[0].cone.softness` is 1.5, but must be a number from 0 to 1"),
    ];
    for (lamp, message) in bad {
        let mut cells = Cells::new(4, 4).unwrap();
        cells.lamps_mut().push(lamp);
        let error = cells.check().unwrap_err().to_string();
        assert!(error.starts_with(message), "{error}");
    }
}

#[test]
fn a_cone_fades_from_its_soft_edge_outwards() {
    let cone = Cone { direction: 0.5, angle: 1.2, softness: 0.5, profile: None };
    for turn in [-2.0, -1.0, 0.0, 1.0, 2.0] {
        for side in [-1.0, 1.0] {
            let share = |off: f32| cone.share(0.5 + side * off + turn * std::f32::consts::TAU);
            assert_eq!((share(0.0), share(0.29), share(0.61), share(3.0)), (1.0, 1.0, 0.0, 0.0));
            // Half way over the edge, by the smoothstep.
            assert!((share(0.45) - 0.5).abs() < 1e-4, "{}", share(0.45));
            assert!(share(0.4) > share(0.5) && share(0.5) > share(0.59));
        }
    }
    let hard = Cone { softness: 0.0, ..cone };
    assert_eq!((hard.share(1.09), hard.share(1.11)), (1.0, 0.0));
    let all = Cone { direction: 3.0, angle: std::f32::consts::TAU, softness: 0.0, profile: None };
    assert!((0..100).all(|i| all.share(i as f32 * 0.1) == 1.0));
}

#[test]
fn a_profile_is_read_from_edge_to_edge() {
    let profile = Some(Profile::new(&[0.2, 1.0, 0.0, 0.6]).unwrap());
    let cone = Cone { direction: -3.0, angle: 1.2, softness: 0.0, profile };
    for (off, value) in [
        (-0.599, 0.2),
        (-0.4, 0.6),
        (-0.2, 1.0),
        (0.0, 0.5),
        (0.2, 0.0),
        (0.5, 0.45),
        (0.599, 0.6),
        (0.61, 0.0),
        (-0.61, 0.0),
    ] {
        for turn in [-1.0, 0.0, 1.0] {
            let share = cone.share(-3.0 + off + turn * std::f32::consts::TAU);
            assert!((share - value).abs() < 5e-3, "{off}: {share}, not {value}");
        }
    }
    // Half way over a soft edge, half of it.
    let soft = Cone { softness: 0.5, ..cone };
    assert!((soft.share(-3.0 - 0.45) - 0.5 * cone.share(-3.0 - 0.45)).abs() < 1e-4);
    let around = Cone { angle: std::f32::consts::TAU, ..cone };
    assert!((around.share(0.1) - 0.593).abs() < 1e-2);
    for bad in [&[1.0][..], &[1.0; 17], &[0.5, 1.5], &[0.5, f32::NAN]] {
        assert!(Profile::new(bad).is_err(), "{bad:?}");
    }
}

#[test]
fn scene_files_have_cones_and_lamps_with_one_are_not_drawn() {
    let text = "size = [32, 32]\n[[lamp]]\nposition = [16.0, 16.0]\n\
                cone = { direction = 1.57, angle = 0.8, softness = 0.25 }\n";
    let scene = Scene::from_toml(text).unwrap();
    let lamp = scene.lamps[0].clone();
    assert_eq!(
        lamp.cone,
        Some(Cone { direction: 1.57, angle: 0.8, softness: 0.25, profile: None })
    );
    assert_eq!(Scene::from_toml(&scene.to_toml().unwrap()).unwrap(), scene);
    assert_eq!(Scene::from_json(&scene.to_json().unwrap()).unwrap(), scene);
    let round = Scene::new(32, 32).lamp(Lamp { cone: None, ..lamp });
    assert!(!round.to_toml().unwrap().contains("cone"));
    let drawn = |scene: &Scene| {
        let mut cells = scene.cells().unwrap();
        cells.draw_lamps();
        (cells.lamps().len(), cells.glow().is_some())
    };
    assert_eq!((drawn(&scene), drawn(&round)), ((1, false), (0, true)));

    for (cone, message) in [
        ("{ angle = 0.8 }", "`lamp[0].cone.direction` is missing"),
        ("{ direction = 0.0, angle = 9.0 }", "`lamp[0].cone.angle` is 9, but must be"),
        ("{ direction = 0.0, angle = 1.0, soft = 1.0 }", "`lamp[0].cone.soft` is not a known key"),
        (
            "{ direction = 0.0, angle = 1.0, profile = [1.0] }",
            "`lamp[0].cone.profile` is a list of 1, but must be a list of 2 to 16 numbers",
        ),
        (
            "{ direction = 0.0, angle = 1.0, profile = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0] }",
            "`lamp[0].cone.profile` is a list of 18, but must be a list of 2 to 16 numbers",
        ),
        (
            "{ direction = 0.0, angle = 1.0, profile = [0.5, 1.5] }",
            "`lamp[0].cone.profile[1]` is 1.5, but must be a number from 0 to 1",
        ),
        (
            "{ direction = 0.0, angle = 1.0, profile = 1.0 }",
            "`lamp[0].cone.profile` is 1.0, but must be a list of 2 to 16 numbers",
        ),
    ] {
        let text = format!("size = [8, 8]\n[[lamp]]\nposition = [4.0, 4.0]\ncone = {cone}\n");
        let error = Scene::from_toml(&text).unwrap_err().to_string();
        assert!(error.starts_with("line 4: ") && error.contains(message), "{error}");
    }
}
