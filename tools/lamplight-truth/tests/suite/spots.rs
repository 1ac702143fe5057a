//! Lamps with a cone, in every method: their own light, and what it does where it falls.

use crate::common::{WALL, grid, inside, seeded, tracer};
use fastrand::Rng;
use lamplight::settings::{Holographic, MethodSettings, Raymarch};
use lamplight::{Bounces, Cells, Cone, Cookie, CookiePixels, Direct, Lamp, Light, Matter, Method};
use lamplight::{Profile, Rgb, Settings, Solver, Sun};
use lamplight_truth::{Estimate, Measures};
use std::f32::consts::TAU;

pub const SIZE: [u32; 2] = [100, 75];

/// The methods that trace matter.
pub fn methods() -> [(&'static str, MethodSettings); 4] {
    [
        ("raymarch", Raymarch { rays: 512, ..Raymarch::default() }.into()),
        ("cascades", Method::Cascades.into()),
        ("holographic", Method::Holographic.into()),
        ("fast", Holographic::preset("fast").unwrap().into()),
    ]
}

pub fn solve(method: &MethodSettings, cells: &Cells, bounces: u32) -> Light {
    let bounces = Bounces::Count(bounces);
    let settings = Settings { bounces, ..Settings::direct(method.clone()) };
    Solver::new(settings).unwrap().solve(cells).unwrap().clone()
}

/// Boxes, a bank of fog and a red pane, within walls where `is_wall` holds.
pub fn furnished(random: &mut Rng, is_wall: impl Fn([u32; 2]) -> bool) -> Cells {
    let mut corner = |within: [u32; 2]| [0, 1].map(|a| random.u32(8..within[a]));
    let boxes: Vec<[u32; 2]> = (0..4).map(|_| corner([80, 55])).collect();
    let (fog, pane) = (corner([60, 40]), corner([85, 40]));
    grid(SIZE[0], SIZE[1], |x, y| {
        if is_wall([x, y]) || boxes.iter().any(|&b| inside([x, y], b, b.map(|v| v + 10))) {
            Matter { albedo: [0.7, 0.6, 0.4], ..WALL }
        } else if inside([x, y], fog, [fog[0] + 30, fog[1] + 20]) {
            Matter { opacity: 0.02, albedo: [0.8; 3], ..Matter::EMPTY }
        } else if inside([x, y], pane, [pane[0] + 2, pane[1] + 20]) {
            Matter { tint: [0.9, 0.3, 0.2], ..Matter::EMPTY }
        } else {
            Matter::EMPTY
        }
    })
}

/// A furnished room with two spots.
fn room(random: &mut Rng) -> Cells {
    let is_wall = |[x, y]: [u32; 2]| x < 4 || y < 4 || x + 4 >= SIZE[0] || y + 4 >= SIZE[1];
    let mut cells = furnished(random, is_wall);
    while cells.lamps().len() < 2 {
        let position = [random.f32() * 80.0 + 9.0, random.f32() * 55.0 + 9.0];
        let is_free = |dx: i32, dy: i32| {
            let [x, y] = [position[0] as i32 + dx, position[1] as i32 + dy];
            let cell = cells.index(x as u32, y as u32);
            // Panes within the lamp itself are seen by few rays: 1 % to 2 % there.
            !cells.is_solid(cell) && cells.tint()[cell] == [1.0; 3]
        };
        if !(-4..=4).all(|dy| (-4..=4).all(|dx| is_free(dx, dy))) {
            continue;
        }
        let cone = Cone { direction: random.f32() * TAU, angle: 0.9, softness: 0.3, profile: None };
        let color = [random.f32() + 0.5, random.f32() + 0.5, random.f32() + 0.5];
        let lamp = Lamp { position, color, cone: Some(cone), ..Lamp::default() };
        cells.lamps_mut().push(lamp);
    }
    cells
}

/// Relative RMSE without the noise of the reference.
fn error(light: &[Rgb], truth: &Estimate, solid: &[bool]) -> f64 {
    let found = Measures::of(light, truth.light.pixels(), solid);
    let open = || (0..light.len()).filter(|&cell| !solid[cell]);
    let square = |cell: usize| truth.standard_error[cell].map(|e| f64::from(e).powi(2));
    let noise = open().flat_map(square).sum::<f64>() / (3 * open().count()) as f64;
    (found.relative_rmse.powi(2) - noise / found.mean.powi(2)).max(0.0).sqrt()
}

/// Largest relative RMSE of direct light.
const DIRECT: f64 = 0.01;
/// Largest relative RMSE with two bounces, by method.
const BOUNCED: [f64; 4] = [0.02, 0.06, 0.02, 0.03];

/// Compares direct light and that of two bounces with the path tracer, by each method.
pub fn assert_right(cells: &Cells, case: &str) {
    assert_direct(cells, case);
    assert_near(cells, case, 2, 1024, BOUNCED);
}

/// Compares direct light with the path tracer, by each method.
pub fn assert_direct(cells: &Cells, case: &str) {
    assert_near(cells, case, 0, 1024, [DIRECT; 4]);
}

fn assert_near(cells: &Cells, case: &str, bounces: u32, samples: u32, bounds: [f64; 4]) {
    let tracer = tracer(samples, Bounces::Count(bounces));
    let truth = tracer.render(cells, &|_| ()).unwrap();
    for ((name, method), bound) in methods().into_iter().zip(bounds) {
        let light = solve(&method, cells, bounces);
        let found = error(light.pixels(), &truth, light.solid());
        println!("{case}, {bounces} bounces, {name}: {:.2} %", 100.0 * found);
        assert!(found < bound, "{case}, {name}, {bounces} bounces: {found}");
        let darker = |rgb: &Rgb| rgb.map(|v| (1.0 - 1.5 * bound as f32) * v);
        let darker: Vec<Rgb> = light.pixels().iter().map(darker).collect();
        let off = error(&darker, &truth, light.solid());
        assert!(off > bound, "{case}, {name} passes with less light");
    }
}

#[test]
fn spots_light_rooms_as_the_path_tracer_does() {
    // Direct light of 30 rooms: 0.56 % off at most.
    let random = &mut seeded(1);
    for number in 0..2 {
        assert_right(&room(random), &format!("room {number}"));
    }
}

#[test]
fn profiles_shape_beams_as_in_the_path_tracer() {
    let mut cells = room(&mut seeded(4));
    let profile = Some(Profile::new(&[0.2, 1.0, 0.3, 1.0, 0.0, 0.6]).unwrap());
    cells.lamps_mut().iter_mut().flat_map(|lamp| &mut lamp.cone).for_each(|cone| {
        (cone.angle, cone.profile) = (1.8, profile);
    });
    assert_right(&cells, "profiles");
}

#[test]
fn pictures_lie_on_the_plane_as_in_the_path_tracer() {
    let random = &mut seeded(5);
    let mut cells = room(random);
    for lamp in cells.lamps_mut() {
        let pixels: Vec<Rgb> = (0..7 * 5).map(|_| [0; 3].map(|_| 2.0 * random.f32())).collect();
        let cookie = Cookie::new(CookiePixels::new([7, 5], &pixels).unwrap(), 90.0);
        lamp.cookie = Some(Cookie { turn: random.f32() * TAU, ..cookie });
    }
    // A lamp with a picture, and a spot with one.
    cells.lamps_mut()[0].cone = None;
    assert_right(&cells, "pictures");
    let mut turned = cells.clone();
    let cookies = turned.lamps_mut().iter_mut().flat_map(|lamp| &mut lamp.cookie);
    cookies.for_each(|cookie| cookie.turn += 0.3);
    let truth = tracer(512, Bounces::Count(0)).render(&cells, &|_| ()).unwrap();
    let light = solve(&Method::Holographic.into(), &turned, 0);
    let off = error(light.pixels(), &truth, light.solid());
    assert!(off > 5.0 * DIRECT, "turned pictures pass: {off}");
}

#[test]
fn lamps_light_their_layers_as_in_the_path_tracer() {
    let random = &mut seeded(3);
    let mut cells = room(random);
    cells.lamps_mut()[0].mask = 1;
    cells.lamps_mut()[1].mask = 2;
    cells.lamps_mut()[1].cone = None;
    cells.suns_mut().push(Sun { mask: 4, intensity: 8.0, ..Sun::default() });
    // Vertical stripes of 9 px: those of a single layer, and those of two.
    for i in 0..cells.len() {
        let stripe = i % SIZE[0] as usize / 9;
        cells.masks_mut()[i] = [1, 7, 2, 6, 3, 4][stripe % 6];
    }
    assert_right(&cells, "layers");
}

#[test]
fn lamps_take_light_as_in_the_path_tracer() {
    let random = &mut seeded(2);
    let mut cells = room(random);
    // Within the beam of each, half of its light is taken again. Where one takes more than all lamps give, as direct
    // light, it is black.
    let lamps = cells.lamps().to_vec();
    cells.lamps_mut().extend(lamps.iter().map(|lamp| {
        let cone = lamp.cone.map(|cone| Cone { angle: 0.4, ..cone });
        Lamp { cone, intensity: -0.5 * lamp.intensity, ..lamp.clone() }
    }));
    assert_right(&cells, "half of each beam");
    cells.lamps_mut().truncate(2);
    // Exact as well: the error of a drawn lamp is not that of the light that is taken.
    (cells.lamps_mut()[0].cone, cells.lamps_mut()[0].direct) = (None, Direct::Exact);
    cells.lamps_mut()[1].intensity = -8.0;
    assert_direct(&cells, "a beam of darkness");
    let light = solve(&Method::Holographic.into(), &cells, 0);
    let black = (0..cells.len()).filter(|&i| light.pixels()[i] == [0.0; 3] && !cells.is_solid(i));
    assert!(black.count() > 50);
}

/// Light at 40 px behind a spot, as a fraction of that in front.
const BEHIND: f32 = 0.01;

#[test]
fn a_spot_is_dark_behind() {
    let cone = Cone { direction: 0.4, angle: 0.8, softness: 0.5, profile: None };
    for direct in [Direct::Glow, Direct::Exact] {
        let lamp = Lamp { position: [60.2, 59.6], cone: Some(cone), direct, ..Lamp::default() };
        let mut cells = grid(120, 120, |_, _| Matter::EMPTY);
        cells.lamps_mut().push(lamp);
        let at = |light: &Light, turn: f32| {
            let [x, y] = [(0.4 + turn).cos(), (0.4 + turn).sin()];
            light.at((60.2 + 40.0 * x) as u32, (59.6 + 40.0 * y) as u32)[0]
        };
        for (name, method) in methods() {
            let light = solve(&method, &cells, 0);
            let (front, behind) = (at(&light, 0.0), at(&light, TAU / 2.0));
            assert!(front > 0.2 && behind <= BEHIND * front, "{name}: {front}, {behind} behind");
        }
    }
}

/// Relative difference of an exact lamp without a cone from one that is drawn, in the open, at half of its range or
/// less, where the window of the falloff takes 12 % off.
const DRAWN: f32 = 0.13;

#[test]
fn a_lamp_is_as_bright_exact_as_drawn() {
    let light = |direct: Direct, name: &str| {
        let mut cells = grid(200, 120, |_, _| Matter::EMPTY);
        let lamp = Lamp { position: [40.3, 60.1], direct, ..Lamp::default() };
        cells.lamps_mut().push(lamp);
        let (_, method) = methods().into_iter().find(|(known, _)| *known == name).unwrap();
        solve(&method, &cells, 0)
    };
    for name in ["cascades", "holographic"] {
        let (drawn, exact) = (light(Direct::Glow, name), light(Direct::Exact, name));
        for x in (50..168).step_by(6) {
            let (drawn, exact) = (drawn.at(x, 70)[1], exact.at(x, 70)[1]);
            assert!((exact / drawn - 1.0).abs() < DRAWN, "{name}, {x}: {exact}, {drawn} drawn");
        }
    }
}

#[test]
fn lamps_beside_walls_and_borders_are_as_in_the_path_tracer() {
    let fog = Matter { opacity: 0.04, ..Matter::EMPTY };
    let lamp = |position, size| Lamp {
        position,
        size,
        intensity: 4.0,
        direct: Direct::Exact,
        ..Lamp::default()
    };
    for (name, position, size) in [
        ("beside a wall", [12.6, 20.5], 3.0),
        ("over the border", [30.0, 2.0], 6.0),
        ("on the border", [48.0, 21.5], 4.0),
        ("at a corner", [48.0, 0.0], 4.0),
        ("larger than its room", [24.0, 20.0], 40.0),
    ] {
        for (air, open) in [("", Matter::EMPTY), (", in fog", fog)] {
            let mut cells = grid(48, 40, |x, _| if x < 12 { WALL } else { open });
            cells.lamps_mut().push(lamp(position, size));
            assert_direct(&cells, &format!("{name}{air}"));
        }
    }
}
