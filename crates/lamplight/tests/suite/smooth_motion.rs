//! Light changes smoothly while what is drawn by coverage moves by parts of a px.

use lamplight::settings::{Cascades, Holographic, MethodSettings};
use lamplight::{Lamp, Light, Scene, Settings, Shape, Solver};

const SIDE: u32 = 96;
/// The floor, which reflects.
const FLOOR: u32 = 88;
/// Cells nearer to the moving shape than this, px, are left out: those that it covers change themselves.
const NEAR: f32 = 4.0;

/// The largest unevenness of the light of glow, which is proportional to coverage,
const FIRE: f32 = 0.015;
/// and of that which passes fog: it falls off exponentially, so it is not quite even.
const FOG: f32 = 0.03;

fn methods() -> [(&'static str, MethodSettings); 2] {
    [("holographic", Holographic::default().into()), ("cascades", Cascades::default().into())]
}

/// The light of a shape and a lamp over a floor.
fn light(method: &MethodSettings, shape: Shape) -> Light {
    let lamp = Lamp { position: [20.0, 14.0], ..Lamp::default() };
    let floor = Shape::rect([0.0, FLOOR as f32], [96.0, 96.0]).albedo([0.6; 3]);
    // What emits is looked at by its own light.
    let lamp = Lamp {
        intensity: if shape.emission != [0.0; 3] || shape.glow != [0.0; 3] {
            0.0
        } else {
            lamp.intensity
        },
        ..lamp
    };
    let scene = Scene::new(SIDE, SIDE).shape(floor).shape(shape).lamp(lamp);
    let mut solver = Solver::new(Settings::new(method.clone())).unwrap();
    solver.solve(&scene.cells().unwrap()).unwrap().clone()
}

/// The largest relative difference from light that changes evenly while a shape, whose corner is at `shape`'s
/// argument, moves by a px in steps of a tenth. The shape reaches `size` px from there.
fn unevenness(method: &MethodSettings, size: f32, shape: impl Fn([f32; 2]) -> Shape) -> f32 {
    const CORNER: [f32; 2] = [44.0, 40.0];
    let at = |t: f32| light(method, shape([CORNER[0] + t, CORNER[1] + 0.5 * t]));
    let [from, to] = [0.0, 1.0].map(at);
    let is_far = |&(x, y): &(u32, u32)| {
        let beyond = |at: u32, corner: f32| {
            let at = at as f32 + 0.5;
            at < corner - NEAR || at > corner + 1.0 + size + NEAR
        };
        beyond(x, CORNER[0]) || beyond(y, CORNER[1])
    };
    let cells = || (0..FLOOR).flat_map(|y| (0..SIDE).map(move |x| (x, y))).filter(is_far);
    let worst = |t: f32| {
        let light = at(t);
        let off = |(x, y): (u32, u32)| {
            let [a, b, seen] = [&from, &to, &light].map(|light| light.at(x, y)[1]);
            (seen / (a + (b - a) * t) - 1.0).abs()
        };
        cells().map(off).fold(0.0, f32::max)
    };
    (1..10).map(|step| worst(step as f32 / 10.0)).fold(0.0, f32::max)
}

#[test]
fn the_light_of_glow_and_fog_moves_by_parts_of_a_px() {
    for (name, method) in methods() {
        let fire = |[x, y]: [f32; 2]| Shape::circle([x + 4.0, y + 4.0], 4.0).glow([0.5; 3]);
        let fog = |[x, y]: [f32; 2]| {
            Shape::rect([x, y], [x + 12.0, y + 9.0]).opacity(0.3).albedo([0.8; 3])
        };
        let fire_by_centres = |at| fire(at).antialias(false);
        let fog_by_centres = |at| fog(at).antialias(false);
        let fire = [unevenness(&method, 8.0, fire), unevenness(&method, 8.0, fire_by_centres)];
        let fog = [unevenness(&method, 12.0, fog), unevenness(&method, 12.0, fog_by_centres)];
        for (what, [smooth, jumps], bound) in [("fire", fire, FIRE), ("fog", fog, FOG)] {
            println!("{name}, {what}: {smooth:.4}, by centres {jumps:.4}");
            assert!(smooth < bound, "{name}, {what}: {smooth}");
            assert!(jumps > bound, "{name}, {what}: the measure sees no jump: {jumps}");
        }
    }
}
