//! Worlds: determinism, conservation, and walls that hold.

#[allow(dead_code)]
mod common;

use common::{hash, range, seeded};
use fastrand::Rng;
use lamplight::{Cells, Lamp, Method, Rgb, Settings, Solver};
use lamplight_sandbox::clock::Clock;
use lamplight_sandbox::worlds::bodies::Bodies;
use lamplight_sandbox::worlds::room::Room;
use lamplight_sandbox::worlds::sand::{Element, Sand};
use lamplight_sandbox::worlds::{Input, World, WorldKind};

const SIZE: [u32; 2] = [160, 90];

fn cells(size: [u32; 2]) -> Cells {
    Cells::new(size[0], size[1]).unwrap()
}

/// The input of a step, which depends only on its number.
fn played(step: u32, seed: u64) -> Input {
    let mut rng = Rng::with_seed(seed ^ u64::from(step / 10));
    Input {
        pointer: Some([range(&mut rng, 0.0, 160.0), range(&mut rng, 0.0, 90.0)]),
        pressed: step % 40 < 25,
        just_pressed: step.is_multiple_of(40),
        just_released: step % 40 == 25,
        brush: rng.usize(..13),
        radius: range(&mut rng, 0.5, 6.0),
        direction: [range(&mut rng, -1.0, 1.0), range(&mut rng, -1.0, 1.0)],
        action: step.is_multiple_of(37),
        switch: step.is_multiple_of(53),
    }
}

fn after(kind: WorldKind, steps: u32, seed: u64) -> u64 {
    let mut world = kind.make(SIZE, seed).unwrap();
    (0..steps).for_each(|step| world.step(&played(step, 5)));
    let mut cells = cells(SIZE);
    world.draw(&mut cells);
    cells.check().unwrap();
    hash(&cells)
}

#[test]
fn the_same_seed_and_input_give_the_same_cells() {
    for &kind in WorldKind::ALL {
        let first = after(kind, 300, 7);
        assert_eq!(first, after(kind, 300, 7), "{kind:?}");
        assert_ne!(first, after(kind, 300, 8), "{kind:?}: the seed changes nothing");
        assert_ne!(first, after(kind, 299, 7), "{kind:?}: a step changes nothing");
    }
}

/// A world that hands its steps on with input by number, so that frames do not matter.
struct Numbered {
    world: Box<dyn World>,
    step: u32,
}

impl World for Numbered {
    fn size(&self) -> [u32; 2] {
        self.world.size()
    }
    fn step(&mut self, _: &Input) {
        if self.step < 300 {
            self.world.step(&played(self.step, 5));
            self.step += 1;
        }
    }
    fn draw(&self, cells: &mut Cells) {
        self.world.draw(cells);
    }
    fn help(&self) -> &'static str {
        self.world.help()
    }
    fn look(&self) -> lamplight_sandbox::look::Look {
        self.world.look()
    }
}

#[test]
fn the_frame_rate_makes_no_difference() {
    for &kind in WorldKind::ALL {
        let expected = after(kind, 300, 7);
        for rate in [24.0, 60.0, 144.0, 1000.0] {
            let mut world = Numbered { world: kind.make(SIZE, 7).unwrap(), step: 0 };
            let mut clock = Clock::default();
            for _ in 0..(5.2 * rate) as u32 {
                clock.play(&mut world, 1.0 / rate, &Input::default());
            }
            assert_eq!(world.step, 300, "{rate}");
            let mut cells = cells(SIZE);
            world.draw(&mut cells);
            assert_eq!(hash(&cells), expected, "{kind:?} at {rate} frames a second");
        }
    }
}

/// Counts its calls.
#[derive(Default)]
struct Counter {
    steps: u32,
    presses: u32,
    actions: u32,
}

impl World for Counter {
    fn size(&self) -> [u32; 2] {
        [1, 1]
    }
    fn step(&mut self, input: &Input) {
        self.steps += 1;
        self.presses += u32::from(input.just_pressed);
        self.actions += u32::from(input.action);
    }
    fn draw(&self, _: &mut Cells) {}
    fn help(&self) -> &'static str {
        ""
    }
    fn look(&self) -> lamplight_sandbox::look::Look {
        Default::default()
    }
}

#[test]
fn what_is_told_once_reaches_one_step() {
    for rate in [15.0, 60.0, 500.0] {
        let (mut counter, mut clock) = (Counter::default(), Clock::default());
        let frames = rate as u32 * 2;
        for frame in 0..frames {
            let once = frame == frames / 2;
            let input = Input { just_pressed: once, action: once, ..Input::default() };
            clock.play(&mut counter, 1.0 / rate, &input);
        }
        assert_eq!((counter.steps, counter.presses, counter.actions), (120, 1, 1), "{rate}");
    }
}

#[test]
fn a_long_pause_is_forgotten() {
    let mut clock = Clock::default();
    assert_eq!(clock.advance(3600.0), Clock::MAX_STEPS);
    assert_eq!(clock.advance(0.0), 0);
    for bad in [f64::NAN, f64::INFINITY, -5.0] {
        assert_eq!(clock.advance(bad), 0, "{bad}");
    }
    assert_eq!(clock.advance(2.5 / 60.0), 2);
    assert_eq!(clock.advance(0.6 / 60.0), 1);
}

#[test]
fn sizes_that_nobody_can_play_are_refused() {
    for &kind in WorldKind::ALL {
        for size in [[0, 0], [95, 90], [160, 53], [4000, 90], [u32::MAX, u32::MAX]] {
            let Err(error) = kind.make(size, 1) else { panic!("{kind:?} {size:?}") };
            assert!(error.to_string().contains("from 96×54 to 1920×1080 cells"), "{error}");
        }
        for size in [[96, 54], [97, 300], [400, 61]] {
            let mut world = kind.make(size, 1).unwrap();
            let mut cells = cells(size);
            (0..30).for_each(|step| world.step(&played(step, 1)));
            world.draw(&mut cells);
            cells.check().unwrap();
            let before = hash(&cells);
            // Cells of another size are left alone.
            let mut other = Cells::new(size[0] + 1, size[1]).unwrap();
            world.draw(&mut other);
            assert!(other.color().is_none());
            world.draw(&mut cells);
            assert_eq!(hash(&cells), before);
        }
    }
}

#[test]
fn worlds_accept_any_input() {
    let mut rng = seeded("worlds_accept_any_input");
    let odd = [f32::NAN, f32::INFINITY, -1e30, 1e30, 0.0, 45.0];
    for &kind in WorldKind::ALL {
        let mut world = kind.make([96, 54], rng.u64(..)).unwrap();
        for _ in 0..120 {
            let mut some = || odd[rng.usize(..odd.len())];
            let mut input = Input {
                pointer: Some([some(), some()]),
                radius: some(),
                direction: [some(), some()],
                brush: usize::MAX,
                ..Input::default()
            };
            input.pressed = rng.bool();
            input.just_pressed = rng.usize(..3) == 0;
            input.action = rng.usize(..3) == 0;
            world.step(&input);
        }
        let mut cells = cells([96, 54]);
        world.draw(&mut cells);
        cells.check().unwrap();
    }
}

/// Sand over air, water and rock, poured by rng.
fn heaps(rng: &mut Rng) -> Sand {
    let mut sand = Sand::empty([96, 64], rng.u64(..));
    for element in [Element::Stone, Element::Water, Element::Sand, Element::Sand] {
        for _ in 0..4 {
            let at = [range(rng, 0.0, 96.0), range(rng, 0.0, 50.0)];
            sand.pour(at, range(rng, 2.0, 12.0), element);
        }
    }
    sand
}

#[test]
fn sand_and_water_that_only_fall_do_not_vanish() {
    let mut rng = seeded("sand_and_water_that_only_fall_do_not_vanish");
    for _ in 0..6 {
        let mut sand = heaps(&mut rng);
        let all = Element::ALL.map(|element| sand.count(element));
        assert!(all[Element::Sand as usize] > 100);
        for step in 0..200 {
            sand.step(&Input::default());
            assert_eq!(Element::ALL.map(|element| sand.count(element)), all, "step {step}");
        }
        // The count does notice a single grain that is gone.
        let cells = (0..64).flat_map(|y| (0..96).map(move |x| (x, y)));
        let (x, y) = { cells }.find(|&(x, y)| sand.element(x, y) == Some(Element::Sand)).unwrap();
        sand.pour([x as f32 + 0.5, y as f32 + 0.5], 0.5, Element::Empty);
        assert_eq!(sand.count(Element::Sand), all[Element::Sand as usize] - 1);
    }
}

#[test]
fn sand_drifts_to_neither_side() {
    let mut sides = [0usize; 2];
    for seed in 0..12 {
        let mut sand = Sand::empty([121, 64], seed);
        for _ in 0..150 {
            sand.pour([60.5, 4.0], 2.0, Element::Sand);
            sand.step(&Input::default());
        }
        (0..120).for_each(|_| sand.step(&Input::default()));
        for y in 0..64 {
            for x in (0..121).filter(|&x| sand.element(x, y) == Some(Element::Sand)) {
                sides[usize::from(x > 60)] += usize::from(x != 60);
            }
        }
    }
    let share = sides[0] as f64 / (sides[0] + sides[1]) as f64;
    // About 15 000 grains; neighbours hang together, so a tenth of that count as independent:
    // 4 σ of 1500 fair coins is 0.05.
    assert!((share - 0.5).abs() < 0.05, "{sides:?}");
}

/// Pours one element over another in a closed bowl.
fn together(under: Element, over: Element, steps: u32, made: Element) -> usize {
    let mut sand = Sand::empty([48, 32], 3);
    sand.pour([24.0, 22.0], 9.0, under);
    (0..60).for_each(|_| sand.step(&Input::default()));
    sand.pour([24.0, 10.0], 5.0, over);
    let before = sand.count(made);
    let mut most = 0;
    for _ in 0..steps {
        sand.step(&Input::default());
        most = most.max(sand.count(made).saturating_sub(before));
    }
    most
}

#[test]
fn elements_act_on_one_another() {
    use Element::{Fire, Glass, Lava, Oil, Plant, Smoke, Steam, Stone, Water, Wood};
    for (under, over, made) in [
        (Water, Lava, Stone),
        (Water, Lava, Steam),
        (Element::Sand, Lava, Glass),
        (Wood, Lava, Fire),
        (Plant, Water, Plant),
        (Oil, Lava, Fire),
    ] {
        let found = together(under, over, 600, made);
        assert!(found > 0, "{over:?} over {under:?} makes no {made:?}");
    }
    for (under, over, made) in
        [(Element::Sand, Water, Glass), (Stone, Lava, Fire), (Glass, Fire, Smoke)]
    {
        let found = together(under, over, 200, made);
        // Lava throws a spark now and then, and fire leaves smoke, whatever lies below.
        let few = if made == Glass { 0 } else { 40 };
        assert!(found <= few, "{over:?} over {under:?} makes {found} {made:?}");
    }
    for (under, burns) in
        [(Plant, true), (Oil, true), (Wood, true), (Stone, false), (Element::Sand, false)]
    {
        let mut sand = Sand::empty([48, 32], 3);
        sand.pour([24.0, 22.0], 9.0, under);
        let before = sand.count(under);
        for _ in 0..900 {
            sand.pour([24.0, 22.0], 16.0, Fire);
            sand.step(&Input::default());
        }
        assert_eq!(sand.count(under) < before, burns, "fire over {under:?}");
    }
}

#[test]
fn bodies_stay_in_the_room() {
    let mut rng = seeded("bodies_stay_in_the_room");
    for _ in 0..3 {
        let mut bodies = Bodies::new([320, 180], rng.u64(..));
        let [low, high] = bodies.inside();
        let start: Vec<_> = bodies.middles().collect();
        for step in 0..600u32 {
            // Grabbed and thrown at the walls as hard as it goes.
            let input = Input {
                pointer: Some([range(&mut rng, -400.0, 700.0), range(&mut rng, -400.0, 600.0)]),
                pressed: step % 30 < 20,
                just_pressed: step.is_multiple_of(30),
                ..Input::default()
            };
            let grab = bodies.middles().nth(rng.usize(..start.len()));
            bodies.step(&if input.just_pressed { Input { pointer: grab, ..input } } else { input });
            for at in bodies.middles() {
                let inside = (0..2).all(|i| (low[i]..=high[i]).contains(&at[i]));
                assert!(inside, "step {step}: {at:?} is outside {low:?} to {high:?}");
            }
        }
        let moved = bodies.middles().zip(start).filter(|(a, b)| (a[0] - b[0]).abs() > 1.0);
        assert!(moved.count() > 10, "hardly anything moved");
    }
}

#[test]
fn what_is_grabbed_follows_the_pointer() {
    let mut bodies = Bodies::new([320, 180], 1);
    let at = bodies.middles().next().unwrap();
    let press = Input { pointer: Some(at), pressed: true, just_pressed: true, ..Input::default() };
    bodies.step(&press);
    let hold = Input { pointer: Some([200.0, 60.0]), just_pressed: false, ..press };
    (0..90).for_each(|_| bodies.step(&hold));
    let near = |bodies: &Bodies| {
        let at = bodies.middles().next().unwrap();
        (at[0] - 200.0).hypot(at[1] - 60.0)
    };
    let held = near(&bodies);
    assert!(held < 25.0, "{held} px away");
    (0..120).for_each(|_| bodies.step(&Input::default()));
    assert!(near(&bodies) > 30.0, "it hangs in the air when it is let go");
}

#[test]
fn nobody_walks_through_walls() {
    let mut rng = seeded("nobody_walks_through_walls");
    for size in [[320, 180], [96, 54], [640, 200]] {
        let mut room = Room::new(size, 1);
        let start = room.walker();
        let mut farthest = 0.0f32;
        let mut direction = [0.0; 2];
        for step in 0..3000u32 {
            if step.is_multiple_of(25) {
                direction = [0, 1].map(|_| [-1.0, 0.0, 1.0, 0.7][rng.usize(..4)]);
            }
            let input = Input { direction, action: step % 60 == 5, ..Input::default() };
            let before = room.walker();
            room.step(&input);
            let [x, y] = room.walker();
            assert!(!room.blocked(x as i32, y as i32), "step {step}: in a wall at {x}, {y}");
            assert!((x - before[0]).hypot(y - before[1]) < 4.0, "a leap");
            farthest = farthest.max((x - start[0]).hypot(y - start[1]));
        }
        assert!(farthest > 10.0, "it never walked");
        assert!((0..size[0] as i32).any(|x| room.blocked(x, size[1] as i32 / 2)));
    }
}

#[test]
fn a_shut_door_stops_and_an_open_one_does_not() {
    let through = |open: bool| {
        let mut room = Room::new([320, 180], 1);
        // The door beside the start is open; shut it where asked.
        let walk = Input { direction: [1.0, 0.0], ..Input::default() };
        (0..16).for_each(|_| room.step(&walk));
        let doors = room.open_doors();
        if !open {
            room.step(&Input { action: true, ..Input::default() });
            assert_eq!(room.open_doors(), doors - 1);
        }
        (0..60).for_each(|_| room.step(&Input::default()));
        (0..60).for_each(|_| room.step(&walk));
        room.walker()[0]
    };
    assert!(through(true) > 120.0, "{}", through(true));
    assert!(through(false) < 112.0, "{}", through(false));
}

#[test]
fn the_meter_falls_when_the_lantern_is_put_out() {
    let settings = Settings::direct(Method::default());
    assert_eq!(settings.method(), Method::Holographic);
    let mut solver = Solver::new(settings).unwrap();
    let mut room = Room::new(SIZE, 1);
    let mut cells = cells(SIZE);
    let mut lit = |room: &Room| {
        room.draw(&mut cells);
        room.lit(solver.solve(&cells).unwrap())
    };
    let bright = lit(&room);
    room.step(&Input { switch: true, ..Input::default() });
    let dark = lit(&room);
    room.step(&Input { switch: true, ..Input::default() });
    let again = lit(&room);
    println!("lit {bright}, put out {dark}, again {again}");
    assert!(bright > 0.5 && bright <= 1.0, "{bright}");
    assert!((0.0..0.4).contains(&dark) && dark < 0.6 * bright, "{dark}");
    assert!((again - bright).abs() < 0.05, "{again}");
    // Put down and walked away from, it fades too.
    let walk = |direction| Input { direction, ..Input::default() };
    (0..30).for_each(|_| room.step(&walk([-1.0, 0.0])));
    assert!(room.carries());
    room.step(&Input { action: true, ..Input::default() });
    assert!(!room.carries());
    let beside = lit(&room);
    (0..45).for_each(|_| room.step(&walk([0.0, 1.0])));
    let away = lit(&room);
    assert!(away < beside, "{beside} beside it, {away} away");
}

/// The radiance of the room in the light of one lamp.
fn lit_by_one(cells: &mut Cells, position: [f32; 2]) -> Vec<Rgb> {
    let room = WorldKind::Room.make([cells.width(), cells.height()], 1).unwrap();
    cells.lamps_mut().clear();
    cells.lamps_mut().push(Lamp { position, ..Lamp::default() });
    let mut solver = Solver::new(Settings::direct(Method::default())).unwrap();
    solver.solve(cells).unwrap().radiance(cells, &room.look().display).unwrap()
}

#[test]
fn edges_of_bricks_and_tiles_catch_the_light_of_a_lamp_beside_them() {
    let size = [320, 180];
    let mut tilted = cells(size);
    WorldKind::Room.make(size, 1).unwrap().draw(&mut tilted);
    let mut flat = tilted.clone();
    flat.clear_normals();
    // The left and the right edge of a tile, and of a brick of the wall above.
    for edges in [[[160, 59], [167, 59]], [[185, 16], [189, 16]]] {
        let [left, right] = edges.map(|[x, y]| tilted.index(x, y));
        let beside = |dx: f32| [edges[0][0] as f32 + dx, 50.0];
        for (position, [near, far]) in
            [(beside(-20.0), [left, right]), (beside(20.0), [right, left])]
        {
            let ratio = |radiance: &[Rgb]| radiance[near][1] / radiance[far][1];
            let with = ratio(&lit_by_one(&mut tilted, position));
            let without = ratio(&lit_by_one(&mut flat, position));
            println!("{position:?}, {edges:?}: {with:.2}, {without:.2} without relief");
            assert!(with > 1.25 * without, "{position:?}, {edges:?}: {with} and {without}");
        }
    }
}

#[test]
fn without_its_normals_the_room_is_lit_as_if_it_never_had_any() {
    let size = [160, 90];
    let mut tilted = cells(size);
    WorldKind::Room.make(size, 1).unwrap().draw(&mut tilted);
    let mut flat = tilted.clone();
    flat.clear_normals();
    let mut solver = Solver::new(Settings::default()).unwrap();
    let with = solver.solve(&tilted).unwrap().clone();
    let without = solver.solve(&flat).unwrap();
    // Light does not know normals; only the picture does.
    assert_eq!(with.pixels(), without.pixels());
    assert_eq!((with.moment().is_some(), without.moment().is_some()), (true, false));
    let display = Default::default();
    assert_ne!(
        with.radiance(&tilted, &display).unwrap(),
        without.radiance(&flat, &display).unwrap()
    );
}

#[test]
fn what_moves_over_the_floor_is_flat() {
    let mut room = Room::new([320, 180], 1);
    let mut cells = cells([320, 180]);
    let covered = |cells: &Cells, room: &Room| {
        let [x, y] = room.walker().map(|v| v as u32);
        (0..9).all(|i| {
            cells.normals().unwrap()[cells.index(x + i % 3 - 1, y + i / 3 - 1)] == lamplight::UP
        })
    };
    room.draw(&mut cells);
    assert!(covered(&cells, &room));
    let still = room.clone();
    (0..30).for_each(|_| room.step(&Input { direction: [-1.0, 0.0], ..Input::default() }));
    room.draw(&mut cells);
    assert!(covered(&cells, &room));
    assert!(!covered(&cells, &still), "the planks do not come back");
}
