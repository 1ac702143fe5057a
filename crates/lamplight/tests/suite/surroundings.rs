//! A view in its surroundings: a lamp that drifts in does not pop.

use crate::common::*;
use lamplight::settings::Holographic;
use lamplight::surroundings::Surroundings;
use lamplight::world::{World, WorldSettings};
use lamplight::{Cells, GridWindow, Lamp, Matter, Rgb, Settings, Sky, Solver};

const WORLD: [u32; 2] = [2304, 192];
const VIEW: GridWindow = GridWindow { first: [40, 64], size: [96, 64] };
/// The right edge of the view, px.
const EDGE: f32 = 136.0;
/// The place from which the lamp drifts, px from there.
const FAR: f32 = 2000.0;
/// px a frame.
const SPEED: f32 = 0.25;
/// The largest jump, relative to the mean light of the view, while the lamp is beyond the border. Measured at 0.006.
const BEYOND: f32 = 0.01;
/// Likewise while it crosses the border, where what is outside is seen from the middles of border cells only. Measured at
/// 0.059.
const CROSSING: f32 = 0.08;

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
        let GridWindow { first, .. } = self.window;
        let beyond = if self.around { std::slice::from_ref(lamp) } else { &[] };
        let inflow = self.surroundings.inflow(self.window, beyond).unwrap();
        self.cells.set_inflow(Some(inflow)).unwrap();
        let position = [0, 1].map(|a| lamp.position[a] - first[a] as f32);
        *self.cells.lamps_mut() = vec![Lamp { position, ..lamp.clone() }];
        let light = self.solver.solve(&self.cells).unwrap();
        let from = [0, 1].map(|a| VIEW.first[a] - first[a]);
        let cells = (0..VIEW.size[1]).flat_map(|y| (0..VIEW.size[0]).map(move |x| (x, y)));
        cells.map(|(x, y)| light.at(from[0] + x, from[1] + y)).collect()
    }
}

fn mean(light: &[Rgb]) -> f32 {
    light.iter().map(|rgb| rgb[1]).sum::<f32>() / light.len() as f32
}

fn lamp(x: f32) -> Lamp {
    Lamp { position: [x, 80.3], color: [1.0; 3], intensity: 12.0, size: 3.0, ..LAMP }
}

/// The largest jump: the difference of a px's light in a frame from the mean of those before and after, relative to the mean
/// over the view. A lamp that moves evenly changes light evenly.
fn jump(lit: &mut LitView, places: impl Iterator<Item = f32>) -> f32 {
    let mut frames: Vec<Vec<Rgb>> = Vec::new();
    let mut worst = 0.0f32;
    for x in places {
        frames.push(lit.light(&lamp(x)));
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
    let margin = 16;
    // The lamp touches the border 3 px before it, and is inside as much behind it.
    let (touches, inside) = (margin as f32 + 4.0, margin as f32 - 4.0);
    let mut lit = LitView::new(&world, &source, margin, true);
    let starts = (0..).map(|i| FAR - 40.0 * i as f32).take_while(|from| *from > touches);
    let beyond = starts
        .map(|from| jump(&mut lit, drift(from, (from - 10.0 * SPEED).max(touches))))
        .fold(0.0, f32::max);
    let crossing = jump(&mut lit, drift(touches, inside));
    let mut alone = LitView::new(&world, &source, margin, false);
    let popping = jump(&mut alone, drift(touches, inside));
    println!("beyond the border {beyond:.4}, crossing it {crossing:.4}, alone {popping:.4}");
    assert!(beyond < BEYOND, "{beyond}");
    assert!(crossing < CROSSING, "{crossing}");
    assert!(popping > 3.0 * CROSSING, "the measure sees no lamp pop: {popping}");
}

#[test]
fn a_view_has_the_light_of_its_surroundings() {
    let source = world();
    let world = World::new(&source, WorldSettings::new(settings()), |_, _| ()).unwrap();
    let [mut view, mut whole] = [(8, true), (128, false)]
        .map(|(margin, around)| LitView::new(&world, &source, margin, around));
    for away in [14.0, 11.0, 8.0, 4.0] {
        let [found, truth] = [&mut view, &mut whole].map(|lit| lit.light(&lamp(EDGE + away)));
        let off = mean(&found) / mean(&truth) - 1.0;
        println!("{away} px: {off:+.4}");
        assert!(off.abs() < 0.01, "{away} px: {off}");
    }
    // Without the lamp's light beyond the border.
    view.around = false;
    let [found, truth] = [&mut view, &mut whole].map(|lit| lit.light(&lamp(EDGE + 14.0)));
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
