//! The stages that methods share.

use crate::common::{cells, device};
use crate::compare::SIZES;
use lamplight::settings::{Hit, Raymarch};
use lamplight::stages::clearance::{Ground, clearance};
use lamplight::stages::distance::distance;
use lamplight::stages::jump_flood::{jump_flood, settle};
use lamplight::stages::seed::{is_occupied, seed};
use lamplight::stages::transmittance::log_transmittance;
use lamplight::{Cells, Method, Settings, Solver};
use lamplight_wgpu::read_back::read_back;
use lamplight_wgpu::{Lighting, Stage};
use wgpu::{Device, Queue};

/// The GPU's stages for some cells.
fn stage<T: bytemuck::Pod>(
    (device, queue): &(Device, Queue),
    cells: &Cells,
    stage: Stage,
) -> Vec<T> {
    let mut lighting =
        Lighting::new(device, queue, Settings { method: Method::Raymarch, ..Settings::default() })
            .unwrap();
    lighting.prepare(device, queue, cells).unwrap();
    let mut encoder = device.create_command_encoder(&Default::default());
    lighting.record_fields(device, &mut encoder).unwrap();
    lighting.record(&mut encoder);
    queue.submit([encoder.finish()]);
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

/// Such a frame has fields too, in buffers of its own.
#[test]
fn fields_are_made_without_a_frame_that_goes_by_them() {
    let (device, queue) = device();
    let cells = cells(40, 30, 13);
    let raymarch = Raymarch { hit: Hit::Distance, ..Raymarch::default() };
    let settings = Settings { method: Method::Raymarch, raymarch, ..Settings::default() };
    let mut lighting = Lighting::new(&device, &queue, settings.clone()).unwrap();
    lighting.prepare(&device, &queue, &cells).unwrap();
    let mut encoder = device.create_command_encoder(&Default::default());
    lighting.record_fields(&device, &mut encoder).unwrap();
    queue.submit([encoder.finish()]);
    let mut solver = Solver::new(settings).unwrap();
    solver.solve(&cells).unwrap();
    let read = |stage| read_back::<u32>(&device, &queue, lighting.stage(stage).unwrap()).unwrap();
    assert_eq!(read(Stage::Seeds), solver.stages().seeds);
    assert_eq!(read(Stage::Nearest), solver.stages().nearest);
}

#[test]
fn clear_squares_agree() {
    let gpu = device();
    for [w, h] in SIZES {
        let cells = cells(w, h, 11);
        let ground: Vec<Ground> = (0..cells.len())
            .map(|i| match () {
                () if cells.is_solid(i) => Ground::Closed,
                () if is_occupied(&cells, i, 0.0) => Ground::Matter,
                () => Ground::Clear,
            })
            .collect();
        let light = |i: usize| {
            (cells.emission()[i], log_transmittance(cells.opacity()[i], cells.tint()[i]))
        };
        let mut squares = Vec::new();
        clearance(w, &ground, |i, j| light(i) == light(j), &mut squares);
        let seen: Vec<u32> = stage(&gpu, &cells, Stage::Clearance);
        for (i, word) in seen.iter().enumerate() {
            let right = std::array::from_fn(|quadrant| squares[quadrant * cells.len() + i]);
            let (x, y) = (i as u32 % w, i as u32 / w);
            assert_eq!(word.to_le_bytes(), right, "at ({x}, {y}) of {w}×{h}");
        }
    }
}
