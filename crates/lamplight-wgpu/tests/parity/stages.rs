//! The stages that methods share.

use crate::common::{cells, device, lighting, recorded};
use crate::compare::SIZES;
use lamplight::internals::CellClass;
use lamplight::internals::distance::distance;
use lamplight::internals::empty_space::empty_space;
use lamplight::internals::extinction;
use lamplight::internals::jump_flood::{jump_flood, settle};
use lamplight::internals::seed::seed;
use lamplight::settings::{Hit, Raymarch};
use lamplight::{Cells, Settings, Solver};
use lamplight_wgpu::read_back::read_back;
use lamplight_wgpu::{FrameInput, Stage};
use wgpu::{Device, Queue};

/// The GPU's stages for some cells.
fn stage<T: bytemuck::Pod>(
    (device, queue): &(Device, Queue),
    cells: &Cells,
    stage: Stage,
) -> Vec<T> {
    let settings = Settings::direct(Raymarch::default());
    let mut lighting = lighting(device, queue);
    let input = FrameInput::of_cells(&settings, cells);
    lighting.prepare(&FrameInput { distance_field: true, ..input }).unwrap();
    recorded(device, queue, &lighting);
    read_back(device, queue, lighting.stage(stage).unwrap()).unwrap()
}

#[test]
fn seeds_jump_flood_and_distance_agree() {
    let gpu = device();
    for [w, h] in SIZES {
        let cells = cells(w, h, 7);
        let (mut seeds, mut scratch, mut away) = Default::default();
        seed(&cells, 0.0, &mut seeds);
        let mut nearest = seeds.clone();
        jump_flood(w, h, 0, &mut nearest, &mut scratch);
        settle(w, h, &mut nearest, &mut scratch);
        distance(w, &nearest, &mut away);
        let read = |what| stage::<u32>(&gpu, &cells, what);
        assert_eq!(read(Stage::Seeds), seeds, "seeds at {w}×{h}");
        assert_eq!(read(Stage::Nearest), nearest, "jump flood at {w}×{h}");
        let seen: Vec<f32> = stage(&gpu, &cells, Stage::Distance);
        for (seen, right) in seen.iter().zip(&away) {
            let right = right.min(f32::MAX);
            assert!((seen - right).abs() <= 1e-6 * right, "distance {seen}, not {right}");
        }
    }
}

/// A frame that needs the fields makes its own too.
#[test]
fn fields_are_made_beside_those_of_the_method() {
    let (device, queue) = device();
    let cells = cells(40, 30, 13);
    let raymarch = Raymarch { hit: Hit::Distance, ..Raymarch::default() };
    let settings = Settings::direct(raymarch);
    let mut lighting = lighting(&device, &queue);
    let input = FrameInput::of_cells(&settings, &cells);
    lighting.prepare(&FrameInput { distance_field: true, ..input }).unwrap();
    recorded(&device, &queue, &lighting);
    let mut solver = Solver::new(settings).unwrap();
    solver.solve(&cells).unwrap();
    let read = |stage| read_back::<u32>(&device, &queue, lighting.stage(stage).unwrap()).unwrap();
    assert_eq!(read(Stage::Seeds), solver.stages().seeds);
    assert_eq!(read(Stage::Nearest), solver.stages().nearest);
}

#[test]
fn empty_space_agrees() {
    let gpu = device();
    for [w, h] in SIZES {
        let cells = cells(w, h, 11);
        let classes: Vec<CellClass> =
            (0..cells.len()).map(|i| CellClass::of(&cells, i, 0.0)).collect();
        let light =
            |i: usize| (cells.emission()[i], extinction(cells.opacity()[i], cells.tint()[i]));
        let mut squares = Vec::new();
        empty_space(w, &classes, |i, j| light(i) == light(j), &mut squares);
        let seen: Vec<u32> = stage(&gpu, &cells, Stage::EmptySpace);
        for (i, word) in seen.iter().enumerate() {
            let right = std::array::from_fn(|quadrant| squares[quadrant * cells.len() + i]);
            let (x, y) = (i as u32 % w, i as u32 / w);
            assert_eq!(word.to_le_bytes(), right, "at ({x}, {y}) of {w}×{h}");
        }
    }
}
