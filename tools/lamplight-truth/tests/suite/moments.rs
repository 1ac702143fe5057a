//! The first moment of light, by every method, and what tilted surfaces receive by it.

use crate::common::{grid, seeded, tracer};
use crate::spots::{SIZE, furnished, methods};
use fastrand::Rng;
use lamplight::settings::{MethodSettings, Raymarch};
use lamplight::{
    Bounces, Cells, Cone, Lamp, Light, Matter, Method, Moment, Relief, Rgb, Settings, Sky, Solver,
    Sun,
};
use std::f32::consts::TAU;

fn solve(method: &MethodSettings, cells: &Cells, bounces: u32) -> Light {
    let bounces = Bounces::Count(bounces);
    let settings = Settings { bounces, moment: true, ..Settings::direct(method.clone()) };
    Solver::new(settings).unwrap().solve(cells).unwrap().clone()
}

/// The root mean square over open cells and both components ÷ the mean of the light.
fn error(light: &Light, truth: &Light) -> f64 {
    error_of(light.moment().unwrap(), truth)
}

fn error_of(moments: &[Moment], truth: &Light) -> f64 {
    let open = || (0..moments.len()).filter(|&i| !truth.solid()[i]);
    let count = 3.0 * open().count() as f64;
    let square = |i: usize| {
        let (found, truth) = (moments[i].as_flattened(), truth.moment().unwrap()[i]);
        let pairs = found.iter().zip(truth.as_flattened());
        pairs.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>()
    };
    let mean = open().flat_map(|i| truth.pixels()[i]).map(f64::from).sum::<f64>() / count;
    (open().map(square).sum::<f64>() / count).sqrt() / mean
}

/// A furnished room, open above, with a drawn lamp, a spot and a sun.
fn room(random: &mut Rng) -> Cells {
    let mut cells = furnished(random, |[x, y]| x < 4 || x + 4 >= SIZE[0] || y + 4 >= SIZE[1]);
    let free = |random: &mut Rng, cells: &Cells| loop {
        let at = [random.f32() * 80.0 + 9.0, random.f32() * 55.0 + 9.0];
        let around = [-4.0, 0.0, 4.0];
        let is_open = |x: f32, y: f32| {
            cells.get(x as u32, y as u32).is_some_and(|matter| matter == Matter::EMPTY)
        };
        if around.iter().all(|dx| around.iter().all(|dy| is_open(at[0] + dx, at[1] + dy))) {
            return at;
        }
    };
    let position = free(random, &cells);
    cells.lamps_mut().push(Lamp { position, ..Lamp::default() });
    let position = free(random, &cells);
    let cone = Cone { direction: random.f32() * TAU, angle: 0.9, softness: 0.3, profile: None };
    let color = [1.0, 0.6, 0.3];
    cells.lamps_mut().push(Lamp { position, color, cone: Some(cone), ..Lamp::default() });
    cells.suns_mut().push(Sun { direction: 0.4 * TAU / 2.0, angle: 0.1, ..Sun::default() });
    cells.set_sky(Sky::Uniform([0.1, 0.2, 0.3]));
    cells
}

/// [`room`] with a spot above the plane and a low sun.
fn hung(random: &mut Rng) -> Cells {
    let mut cells = room(random);
    cells.lamps_mut()[1].height = Some(25.0);
    cells.suns_mut()[0].elevation = Some(0.5);
    cells
}

#[test]
fn moments_are_those_of_the_path_tracer() {
    // Largest errors ÷ mean light, about those of the light itself in these rooms.
    let bounds = [0.02, 0.04, 0.02, 0.09];
    let random = &mut seeded(2);
    for (number, make) in [room, hung].into_iter().enumerate() {
        let cells = make(random);
        for bounces in [0, 2] {
            let tracer = tracer(4096, Bounces::Count(bounces));
            let truth = tracer.render(&cells, &|_| ()).unwrap().light;
            for ((name, method), bound) in methods().into_iter().zip(bounds) {
                let light = solve(&method, &cells, bounces);
                let found = error(&light, &truth);
                println!("room {number}, {bounces} bounces, {name}: {:.2} %", 100.0 * found);
                assert!(found < bound, "room {number}, {name}, {bounces} bounces: {found}");
                let flatter: Vec<Moment> =
                    light.moment().unwrap().iter().map(|[x, y]| [*x, y.map(|v| 0.5 * v)]).collect();
                assert!(error_of(&flatter, &truth) > bound, "{name} passes with less of y");
            }
        }
    }
}

#[test]
fn the_light_of_a_far_lamp_has_one_direction() {
    let mut cells = grid(128, 96, |_, _| Matter::EMPTY);
    let center = [30.3, 40.9];
    cells.lamps_mut().push(Lamp { position: center, ..Lamp::default() });
    let all: [(&str, MethodSettings); 1] = [("polar", Method::Polar.into())];
    for (name, method) in methods().into_iter().chain(all) {
        let light = solve(&method, &cells, 0);
        let moments = light.moment().unwrap();
        let (mut sum, mut count) = (0.0, 0);
        for y in (2..96).step_by(9) {
            for x in (60..126).step_by(7) {
                let off = [center[0] - x as f32 - 0.5, center[1] - y as f32 - 0.5];
                let distance = off[0].hypot(off[1]);
                let (light, moment) = (light.at(x, y)[1], moments[cells.index(x, y)]);
                let miss = [0, 1].map(|a| moment[a][1] / light - off[a] / distance);
                sum += miss[0].powi(2) + miss[1].powi(2);
                count += 1;
            }
        }
        let found = (sum / count as f32).sqrt();
        println!("{name}: {:.2} %", 100.0 * found);
        assert!(found < FAR, "{name}: {found}");
    }
}

/// Root mean square of the difference of m/J from the direction of a lamp, 30 px or more away.
const FAR: f32 = 0.03;

#[test]
fn light_is_at_least_as_much_as_its_moment() {
    let cells = room(&mut seeded(3));
    let all: [(&str, MethodSettings); 4] = [
        ("polar", Method::Polar.into()),
        ("flood", Method::Flood.into()),
        ("paper", lamplight::settings::Holographic::preset("paper").unwrap().into()),
        ("noisy", Raymarch { rays: 8, ..Raymarch::default() }.into()),
    ];
    for (name, method) in methods().into_iter().chain(all) {
        let light = solve(&method, &cells, 1);
        for (i, [x, y]) in light.moment().unwrap().iter().enumerate() {
            let light: Rgb = light.pixels()[i];
            for c in 0..3 {
                let length = x[c].hypot(y[c]);
                assert!(
                    length <= light[c] * 1.001 + 1e-6,
                    "{name}, cell {i}: {length} of {}",
                    light[c]
                );
            }
        }
    }
}

/// Root mean square of the error of light on tilted surfaces ÷ its mean, in a room with three lights.
const TILTED: f64 = 0.03;

#[test]
fn tilted_surfaces_receive_what_the_path_tracer_finds() {
    let random = &mut seeded(4);
    for (name, make) in [("room", room as fn(&mut Rng) -> Cells), ("hung", hung)] {
        check_tilted(name, &make(random), random);
    }
}

fn check_tilted(name: &str, cells: &Cells, random: &mut Rng) {
    let light = solve(&Method::Holographic.into(), cells, 2);
    let relief = Relief::default();
    let at: Vec<[u32; 2]> = (0..400)
        .map(|_| [random.u32(0..SIZE[0]), random.u32(0..SIZE[1])])
        .filter(|[x, y]| !cells.is_solid(cells.index(*x, *y)))
        .collect();
    for tilt in [15f32, 30.0, 45.0] {
        let turn = random.f32() * TAU;
        let (sin, cos) = tilt.to_radians().sin_cos();
        let normal = [sin * turn.cos(), sin * turn.sin(), cos];
        let tracer = tracer(4096, Bounces::Count(2));
        let truth = tracer.tilted(cells, &at, normal).unwrap();
        let error = |normal: [f32; 3]| {
            let (mut squares, mut sum) = (0.0, 0.0);
            for ([x, y], (truth, _)) in at.iter().zip(&truth) {
                let moment = &light.moment().unwrap()[cells.index(*x, *y)];
                let (found, _) = relief.shade(normal, light.at(*x, *y), moment, light.elevation());
                for c in 0..3 {
                    squares += f64::from(found[c] - truth[c]).powi(2);
                    sum += f64::from(truth[c]);
                }
            }
            let count = 3.0 * at.len() as f64;
            (squares / count).sqrt() / (sum / count)
        };
        let found = error(normal);
        println!("{name}, tilted by {tilt}°: {:.2} %", 100.0 * found);
        assert!(found < TILTED, "{name}, tilted by {tilt}°: {found}");
        let mirrored = error([-normal[0], normal[1], normal[2]]);
        assert!(mirrored > TILTED, "{name}, {tilt}°: mirrored passes");
    }
}
