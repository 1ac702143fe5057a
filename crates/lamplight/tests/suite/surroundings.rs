//! A view in its surroundings: a lamp that drifts in does not pop.

use crate::common::*;
use lamplight::settings::Holographic;
use lamplight::surroundings::{
    LEAST_RADIUS_BEYOND, LampPart, RingSurroundings, RingWindow, Surroundings, part_lamp,
};
use lamplight::world::{World, WorldSettings};
use lamplight::{
    Cells, Direct, Gradient, GridWindow, Inflow, Lamp, Matter, Panorama, Rgb, Settings, Sky,
    Solver, Sun,
};

const WORLD: [u32; 2] = [2304, 192];
const VIEW: GridWindow = GridWindow { first: [40, 64], size: [96, 64] };
/// The right edge of the view, px.
const EDGE: f32 = 136.0;
/// The place from which the lamp drifts, px from there.
const FAR: f32 = 2000.0;
/// px a frame.
const SPEED: f32 = 0.25;
/// The largest jump, relative to the mean light of the view, while the lamp is beyond the border. Measured at 0.0046.
const BEYOND: f32 = 0.01;
/// Likewise while it crosses the border, where its light goes over from the inflow to the cells. Measured at 0.0068.
const CROSSING: f32 = 0.01;
/// Likewise with rings, whose light is known in half as many directions. Measured at 0.0095 and 0.0106.
const IN_RINGS: f32 = 0.015;

fn settings() -> Settings {
    Settings::direct(Holographic::default())
}

/// A dim world with a floor.
fn world() -> Cells {
    let stone = Matter { opacity: 1.0, albedo: [0.5; 3], ..Matter::EMPTY };
    let mut cells = grid(WORLD[0], WORLD[1], |_, y| if y > 170 { stone } else { Matter::EMPTY });
    cells.set_sky(Sky::Uniform([0.02; 3]));
    cells
}

/// The light of the view, with the lamp in its window and, if `around`, beyond it too.
struct LitView<'a> {
    surroundings: Surroundings<'a>,
    solver: Solver,
    cells: Cells,
    window: GridWindow,
    around: bool,
}

impl<'a> LitView<'a> {
    fn new(world: &'a World<'a>, source: &Cells, margin: u32, around: bool) -> Self {
        let surroundings = Surroundings::new(world, margin);
        let window = surroundings.window(VIEW).unwrap();
        let GridWindow { first, size } = window;
        let cells = grid(size[0], size[1], |x, y| source.get(first[0] + x, first[1] + y).unwrap());
        Self { surroundings, solver: Solver::new(settings()).unwrap(), cells, window, around }
    }

    fn light(&mut self, lamp: &Lamp) -> Vec<Rgb> {
        let GridWindow { first, size } = self.window;
        let lamp = moved(lamp, first.map(|v| -(v as f32)));
        let lamps = if self.around { parted(&lamp, size) } else { [vec![lamp], vec![]] };
        let [inside, beyond] = lamps;
        let beyond: Vec<Lamp> =
            beyond.iter().map(|lamp| moved(lamp, first.map(|v| v as f32))).collect();
        let inflow = self.surroundings.inflow(self.window, &beyond).unwrap();
        self.cells.set_inflow(Some(inflow)).unwrap();
        *self.cells.lamps_mut() = inside;
        seen(&mut self.solver, &self.cells, self.window)
    }
}

fn moved(lamp: &Lamp, by: [f32; 2]) -> Lamp {
    Lamp { position: [0, 1].map(|a| lamp.position[a] + by[a]), ..lamp.clone() }
}

/// The parts of a lamp inside and beyond the border.
fn parted(lamp: &Lamp, size: [u32; 2]) -> [Vec<Lamp>; 2] {
    let mut parts = [vec![], vec![]];
    for (lamp, part) in part_lamp(lamp, size) {
        parts[usize::from(part == LampPart::Beyond)].push(lamp);
    }
    parts
}

/// The light of the view in a window around it.
fn seen(solver: &mut Solver, cells: &Cells, window: GridWindow) -> Vec<Rgb> {
    let light = solver.solve(cells).unwrap();
    let from = [0, 1].map(|a| VIEW.first[a] - window.first[a]);
    let cells = (0..VIEW.size[1]).flat_map(|y| (0..VIEW.size[0]).map(move |x| (x, y)));
    cells.map(|(x, y)| light.at(from[0] + x, from[1] + y)).collect()
}

fn mean(light: &[Rgb]) -> f32 {
    light.iter().map(|rgb| rgb[1]).sum::<f32>() / light.len() as f32
}

fn lamp(x: f32) -> Lamp {
    Lamp { position: [x, 80.3], color: [1.0; 3], intensity: 12.0, size: 3.0, ..LAMP }
}

/// The largest jump: the difference of a px's light in a frame from the mean of those before and after, relative to the mean
/// over the view. A lamp that moves evenly changes light evenly.
fn jump(mut light: impl FnMut(&Lamp) -> Vec<Rgb>, places: impl Iterator<Item = f32>) -> f32 {
    let mut frames: Vec<Vec<Rgb>> = Vec::new();
    let mut worst = 0.0f32;
    for x in places {
        frames.push(light(&lamp(x)));
        if let [before, own, after] = &frames[..] {
            let off = |i: usize| (own[i][1] - 0.5 * (before[i][1] + after[i][1])).abs();
            worst = (0..own.len()).map(off).fold(0.0, f32::max).max(worst * mean(own)) / mean(own);
            frames.remove(0);
        }
    }
    worst
}

/// Frames in which the lamp moves from one place to another, px right of the view.
fn drift(from: f32, to: f32) -> impl Iterator<Item = f32> {
    (0..).map(move |i| EDGE + from - SPEED * i as f32).take_while(move |x| *x >= EDGE + to)
}

#[test]
fn a_lamp_that_drifts_in_does_not_pop() {
    let source = world();
    let world = World::new(&source, WorldSettings::new(settings()), |_, _| ()).unwrap();
    let margin = Surroundings::MARGIN;
    let mut lit = LitView::new(&world, &source, margin, true);
    let [beyond, crossing] = jumps(|lamp| lit.light(lamp), margin);
    let mut alone = LitView::new(&world, &source, margin, false);
    let [_, popping] = jumps(|lamp| alone.light(lamp), margin);
    println!("beyond the border {beyond:.4}, crossing it {crossing:.4}, alone {popping:.4}");
    assert!(beyond < BEYOND, "{beyond}");
    assert!(crossing < CROSSING, "{crossing}");
    assert!(popping > 10.0 * CROSSING, "the measure sees no lamp pop: {popping}");
}

/// The largest jumps of a lamp that drifts in: beyond the border, which is a margin away from the view, and while it
/// crosses that.
fn jumps(mut light: impl FnMut(&Lamp) -> Vec<Rgb>, margin: u32) -> [f32; 2] {
    // The lamp is parted from here on, until as far behind the border.
    let zone = 2.0 * (LEAST_RADIUS_BEYOND + 1.0) + 1.0;
    let (parted, inside) = (margin as f32 + zone, margin as f32 - zone);
    let starts = (0..).map(|i| FAR - 79.0 * i as f32).take_while(|from| *from > parted);
    let starts = starts.chain([parted + 20.0, parted + 10.0, parted + 4.0]);
    let beyond = starts
        .map(|from| jump(&mut light, drift(from, (from - 10.0 * SPEED).max(parted))))
        .fold(0.0, f32::max);
    [beyond, jump(&mut light, drift(parted, inside))]
}

/// A view in rings that are drawn from the world.
struct RingView {
    rings: RingSurroundings,
    still: Inflow,
    solver: Solver,
    cells: Cells,
    window: GridWindow,
}

impl RingView {
    /// That of a world whose matter is `at` each of its px.
    fn new(margin: u32, at: impl Fn([i32; 2]) -> Matter, sky: Sky) -> Self {
        let first = VIEW.first.map(|v| v - margin);
        let window = GridWindow { first, size: VIEW.size.map(|v| v + 2 * margin) };
        let origin = first.map(|v| v as i32);
        let mut rings = RingSurroundings::new(window.size, origin, 4).unwrap();
        for ring in 0..rings.rings() {
            let RingWindow { first, cell, size } = rings.window(ring);
            let mut cells = Cells::new(size[0], size[1]).unwrap();
            for (x, y) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))) {
                let [x_px, y_px] = [x, y].map(|v| (v * cell + cell / 2) as i32);
                let matter = at([origin[0] + first[0] + x_px, origin[1] + first[1] + y_px]);
                cells.set(x, y, matter);
            }
            rings.set(ring, &cells).unwrap();
        }
        let still = rings.inflow(&sky, &[], RingSurroundings::COLUMNS).unwrap();
        let mut cells = Cells::new(window.size[0], window.size[1]).unwrap();
        for (x, y) in (0..window.size[1]).flat_map(|y| (0..window.size[0]).map(move |x| (x, y))) {
            cells.set(x, y, at([origin[0] + x as i32, origin[1] + y as i32]));
        }
        cells.set_sky(sky);
        Self { rings, still, solver: Solver::new(settings()).unwrap(), cells, window }
    }

    /// The light of the view with a lamp, px of the world.
    fn light(&mut self, lamp: &Lamp) -> Vec<Rgb> {
        let GridWindow { first, size } = self.window;
        let [inside, beyond] = parted(&moved(lamp, first.map(|v| -(v as f32))), size);
        let inflow = self.rings.with_lamps(&self.still, &beyond).unwrap();
        self.cells.set_inflow(Some(inflow)).unwrap();
        *self.cells.lamps_mut() = inside;
        seen(&mut self.solver, &self.cells, self.window)
    }

    /// The light of the view without what is around it.
    fn alone(&mut self) -> Vec<Rgb> {
        self.cells.set_inflow(None).unwrap();
        self.cells.lamps_mut().clear();
        seen(&mut self.solver, &self.cells, self.window)
    }
}

const STONE: Matter = Matter { opacity: 1.0, ..Matter::EMPTY };

#[test]
fn a_lamp_that_drifts_in_through_rings_does_not_pop() {
    let ground = |[_, y]: [i32; 2]| if y > 170 { STONE } else { Matter::EMPTY };
    let margin = Surroundings::MARGIN;
    let mut lit = RingView::new(margin, ground, Sky::Uniform([0.02; 3]));
    let [beyond, crossing] = jumps(|lamp| lit.light(lamp), margin);
    println!("beyond the border {beyond:.4}, crossing it {crossing:.4}");
    assert!(beyond < IN_RINGS && crossing < IN_RINGS, "{beyond}, {crossing}");
}

#[test]
fn rings_without_matter_are_the_sky() {
    let gradient = Gradient { zenith: [0.2, 0.4, 1.0], horizon: [1.0; 3], ground: [0.0; 3] };
    for (sky, tolerance) in [(Sky::Uniform([0.3; 3]), 1e-4), (Sky::Gradient(gradient), 5e-3)] {
        let mut lit = RingView::new(16, |_| Matter::EMPTY, sky.clone());
        let dark = Lamp { intensity: 0.0, ..lamp(400.0) };
        let [found, sky] = [lit.light(&dark), lit.alone()];
        let off = found.iter().zip(&sky).map(|(a, b)| (a[1] - b[1]).abs() / b[1]);
        let worst = off.fold(0.0, f32::max);
        println!("{worst:.5}");
        assert!(worst < tolerance, "{worst}");
    }
}

#[test]
fn what_rings_hold_shines_and_throws_shadows() {
    // A lit window and a lamp to the right, and behind the ground a sky.
    let right = |x: i32, from: i32, to: i32| (from..to).contains(&(x - EDGE as i32));
    let glow = Matter { emission: [8.0; 3], ..STONE };
    let scene = |walled: bool| {
        move |[x, y]: [i32; 2]| match () {
            () if y > 170 => STONE,
            () if right(x, 200, 224) && (60..100).contains(&y) => glow,
            () if walled && right(x, 60, 76) && y > 0 => STONE,
            () => Matter::EMPTY,
        }
    };
    let far = lamp(EDGE + 120.0);
    let whole = |walled: bool, lamp: &Lamp| {
        let at = scene(walled);
        let first = [0, 1].map(|a| VIEW.first[a] as i32 - [20, 400][a]);
        let mut cells = grid(512, 900, |x, y| at([first[0] + x as i32, first[1] + y as i32]));
        cells.set_sky(Sky::Uniform([0.02; 3]));
        cells.lamps_mut().push(moved(lamp, first.map(|v| -v as f32)));
        let light = Solver::new(settings()).unwrap().solve(&cells).unwrap().clone();
        let from = [20, 400];
        let view = (0..VIEW.size[1]).flat_map(|y| (0..VIEW.size[0]).map(move |x| (x, y)));
        view.map(|(x, y)| light.at(from[0] + x, from[1] + y)).collect::<Vec<_>>()
    };
    for (walled, tolerance) in [(false, 0.02), (true, 0.3)] {
        let mut lit = RingView::new(16, scene(walled), Sky::Uniform([0.02; 3]));
        let [found, truth] = [lit.light(&far), whole(walled, &far)].map(|light| mean(&light));
        let alone = mean(&lit.alone());
        println!("walled {walled}: {found:.4}, the truth {truth:.4}, alone {alone:.4}");
        assert!((found / truth - 1.0).abs() < tolerance, "{found}, not {truth}");
    }
}

#[test]
fn glow_in_rings_shines() {
    // Four cells of the innermost ring.
    let fire = Matter { glow: [0.5, 0.25, 0.0], ..Matter::EMPTY };
    let from = EDGE as i32 + 24;
    let at = |[x, _]: [i32; 2]| if (from..from + 16).contains(&x) { fire } else { Matter::EMPTY };
    let lit = RingView::new(16, at, Sky::BLACK);
    let [width, height] = lit.window.size.map(|side| side as f32);
    let found = lit.still.radiance([width, 0.5 * height], [1.0, 0.0]);
    assert!((0..3).all(|c| (found[c] - 4.0 * fire.glow[c]).abs() < 1e-2), "{found:?}");
}

#[test]
fn exact_suns_are_not_in_the_light_around() {
    let rings = RingSurroundings::new([32, 32], [0, 0], 1).unwrap();
    let lit = |suns: &[Sun]| rings.inflow(&Sky::BLACK, suns, 16).unwrap();
    let glowing = Sun { direct: Direct::Glow, ..Sun::default() };
    assert_eq!(lit(&[Sun::default()]), lit(&[]));
    assert_ne!(lit(&[glowing]), lit(&[]));
}

#[test]
fn wrong_numbers_of_directions_are_refused() {
    let rings = RingSurroundings::new([32, 32], [0, 0], 1).unwrap();
    for columns in [0, Panorama::MAX_COLUMNS + 1, usize::MAX] {
        let error = rings.inflow(&Sky::BLACK, &[], columns).unwrap_err().to_string();
        let expected = format!("`inflow.columns` is {columns}, but must be 1 to 8192");
        assert_eq!(error, expected);
    }
}

#[test]
fn a_view_has_the_light_of_its_surroundings() {
    let source = world();
    let world = World::new(&source, WorldSettings::new(settings()), |_, _| ()).unwrap();
    let [mut view, mut whole] = [(16, true), (128, false)]
        .map(|(margin, around)| LitView::new(&world, &source, margin, around));
    for away in [40.0, 30.0, 22.0, 16.0, 8.0, 4.0] {
        let [found, truth] = [&mut view, &mut whole].map(|lit| lit.light(&lamp(EDGE + away)));
        let off = mean(&found) / mean(&truth) - 1.0;
        println!("{away} px: {off:+.4}");
        assert!(off.abs() < 0.03, "{away} px: {off}");
    }
    // Without the lamp's light beyond the border.
    view.around = false;
    let [found, truth] = [&mut view, &mut whole].map(|lit| lit.light(&lamp(EDGE + 40.0)));
    assert!(mean(&found) < 0.5 * mean(&truth));
}

#[test]
fn windows_that_are_none_are_refused() {
    let source = world();
    let world = World::new(&source, WorldSettings::new(settings()), |_, _| ()).unwrap();
    let mut surroundings = Surroundings::new(&world, 8);
    let outside = GridWindow { first: [2300, 0], size: [8, 8] };
    assert!(surroundings.window(outside).is_err());
    assert!(surroundings.inflow(outside, &[]).is_err());
    let between = GridWindow { first: [2, 0], size: [8, 8] };
    let error = surroundings.inflow(between, &[]).unwrap_err().to_string();
    assert!(error.contains("multiples of 4"), "{error}");
}
