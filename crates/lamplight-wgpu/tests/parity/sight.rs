//! Visibility from viewers.

use crate::common::{cells, device, lighting, recorded, seeded};
use crate::compare::SIZES;
use crate::direct::without_media;
use lamplight::{Cells, Cone, Error, Lamp, Matter, Method, Settings, Sight, SightSolver};
use lamplight_wgpu::error::PrepareError;
use lamplight_wgpu::read_back::read_back;
use lamplight_wgpu::{FrameInput, Lighting, Stage};
use std::f32::consts::TAU;
use wgpu::{Device, Queue};

/// Random viewers within a grid and around it; the first has a cone.
fn viewers(width: u32, height: u32, count: usize, seed: u64) -> Vec<Sight> {
    let mut random = seeded(seed);
    let mut viewer = |number: usize| {
        let direction = TAU * (2.0 * random.f32() - 1.0);
        let angle = 1.0 + 2.0 * random.f32();
        let cone = Cone { direction, angle, softness: random.f32(), profile: None };
        Sight {
            position: [width, height].map(|side| side as f32 * (1.2 * random.f32() - 0.1)),
            size: 0.1 + 3.0 * random.f32(),
            range: 20.0 + 80.0 * random.f32(),
            fade: 0.3 * random.f32(),
            cone: (number == 0).then_some(cone),
        }
    };
    (0..count).map(&mut viewer).collect()
}

/// The sight that the GPU finds.
fn seen(
    (device, queue): &(Device, Queue),
    lighting: &mut Lighting,
    cells: &Cells,
    sights: &[Sight],
) -> Vec<f32> {
    let settings = Settings::direct(Method::Polar);
    let input = FrameInput { sights, ..FrameInput::of_cells(&settings, cells) };
    lighting.prepare(&input).unwrap();
    recorded(device, queue, lighting);
    read_back(device, queue, lighting.stage(Stage::Sight).unwrap()).unwrap()
}

/// Random matter, and a dim lamp, without which the method has nothing to light.
fn scene(width: u32, height: u32, seed: u64) -> Cells {
    let mut cells = cells(width, height, seed);
    cells.lamps_mut().push(Lamp { intensity: 0.1, ..Lamp::default() });
    cells
}

/// The visibility of every cell by a query of the CPU: the largest of all viewers.
fn queried(cells: &Cells, sights: &[Sight]) -> Vec<f32> {
    let mut solver = SightSolver::default();
    solver.read(cells).unwrap();
    let width = cells.width() as usize;
    let best = |i: usize| {
        let center = [i % width, i / width].map(|v| v as f32 + 0.5);
        let visibility = |sight| solver.visibility(sight, center).unwrap();
        sights.iter().map(visibility).fold(0.0, f32::max)
    };
    (0..cells.len()).map(best).collect()
}

/// The largest difference of visibility: rounding, and the choice of rays through media.
const TOLERANCE: f32 = 1e-3;
/// The fraction of cells that may be off: rounding decides whether a corner hides the rim of an eye.
const TIES: f64 = 1e-3;

/// The cells that differ by more than the tolerance, or are not numbers.
fn wrong(seen: &[f32], right: &[f32]) -> usize {
    assert_eq!(seen.len(), right.len());
    let differs = |(seen, right): &(&f32, &f32)| {
        let off = (*seen - *right).abs();
        off.is_nan() || off > TOLERANCE
    };
    seen.iter().zip(right).filter(differs).count()
}

#[track_caller]
fn agree(name: &str, seen: &[f32], right: &[f32]) {
    let wrong = wrong(seen, right);
    println!("{name}: {wrong} of {} cells wrong", right.len());
    assert!(wrong as f64 <= TIES * right.len() as f64, "{name}: {wrong} cells");
}

#[test]
fn sight_agrees_at_every_size_through_fog_and_glass() {
    let gpu = device();
    let mut lighting = lighting(&gpu.0, &gpu.1);
    for (seed, [w, h]) in (300..).zip(SIZES) {
        let cells = scene(w, h, seed);
        let sights = viewers(w, h, 3, seed + 10);
        let seen = seen(&gpu, &mut lighting, &cells, &sights);
        agree(&format!("{w}×{h}"), &seen, &queried(&cells, &sights));
    }
}

#[test]
fn sight_agrees_with_the_field_of_the_cpu() {
    let gpu = device();
    let mut lighting = lighting(&gpu.0, &gpu.1);
    let mut solver = SightSolver::default();
    for seed in [320, 330, 340] {
        let cells = without_media(scene(97, 61, seed));
        let sights = viewers(97, 61, 3, seed + 1);
        let seen = seen(&gpu, &mut lighting, &cells, &sights);
        solver.read(&cells).unwrap();
        agree(&format!("seed {seed}"), &seen, solver.field(&sights).unwrap());
    }
}

#[test]
fn one_wrong_cell_or_another_viewer_is_rejected() {
    let gpu = device();
    let mut lighting = lighting(&gpu.0, &gpu.1);
    let mut cells = scene(97, 61, 350);
    for (y, x) in (26..36).flat_map(|y| (44..54).map(move |x| (y, x))) {
        cells.set(x, y, Matter::EMPTY);
    }
    let in_the_open = Sight { position: [48.5, 30.5], range: 60.0, fade: 0.5, ..Sight::default() };
    let mut sights = vec![viewers(97, 61, 1, 351)[0], in_the_open];
    let seen = seen(&gpu, &mut lighting, &cells, &sights);
    let right = queried(&cells, &sights);
    let already = wrong(&seen, &right);
    for change in [0.01, f32::NAN] {
        let mut changed = right.clone();
        let unchanged = (0..seen.len()).find(|&i| wrong(&seen[i..=i], &right[i..=i]) == 0).unwrap();
        changed[unchanged] += change;
        assert_eq!(wrong(&seen, &changed), already + 1, "{change} passes");
    }
    sights[1].position[0] += 1.0;
    assert!(wrong(&seen, &queried(&cells, &sights)) > 50);
}

#[test]
fn viewers_come_and_go_and_the_buffer_stays() {
    let gpu = device();
    let mut lighting = lighting(&gpu.0, &gpu.1);
    let cells = scene(61, 43, 360);
    let all = viewers(61, 43, 9, 361);
    let mut buffer = None;
    for count in [1, 2, 9, 4] {
        let seen = seen(&gpu, &mut lighting, &cells, &all[..count]);
        agree(&format!("{count} viewers"), &seen, &queried(&cells, &all[..count]));
        let now = lighting.stage(Stage::Sight).cloned();
        assert!(now == *buffer.get_or_insert_with(|| now.clone()), "{count}");
    }
    let settings = Settings::direct(Method::Polar);
    lighting.prepare(&FrameInput::of_cells(&settings, &cells)).unwrap();
    assert!(lighting.stage(Stage::Sight).is_none());
    let dispatches = |lighting: &Lighting| lighting.cost().unwrap().dispatches();
    let without = dispatches(&lighting);
    let wrong = Sight { range: f32::NAN, ..all[0] };
    let input = FrameInput { sights: &[all[0], wrong], ..FrameInput::of_cells(&settings, &cells) };
    match lighting.prepare(&input) {
        Err(PrepareError::Input(Error::Value { key, .. })) => assert_eq!(key, "sight[1].range"),
        other => panic!("{other:?}"),
    }
    assert_eq!(dispatches(&lighting), without, "the frame before stays");
    lighting.prepare(&FrameInput { sights: &all[..1], ..input }).unwrap();
    assert_eq!(dispatches(&lighting), without + 2);
}
