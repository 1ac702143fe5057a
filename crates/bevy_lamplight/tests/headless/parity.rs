//! A Bevy scene is lit as the same cells are by the CPU.

use crate::common::{Picture, app, begin, camera, picture, plain, target};
use bevy::prelude::*;
use bevy_lamplight::prelude::*;
use lamplight::{Bounces, Cells, Light, Matter, Method, Settings, Solver};
use lamplight_wgpu::{Camera2dView, GridPlacement};

const SIZE: [u32; 2] = [160, 120];
/// The tolerance of the GPU against the CPU, relative to light of 1. Half floats have eleven bits, and GPUs in software cut
/// the others off: that alone is up to 2⁻¹⁰.
const TOLERANCE: f32 = 1.0 / 1024.0 + 2e-4;

/// The grid of a camera with [`plain`] settings at a place of the world.
fn placed(position: [f64; 2]) -> GridPlacement {
    let view =
        Camera2dView { position, border: 16, lattice: 16, step: 32, ..Camera2dView::default() };
    view.cover(SIZE.map(f64::from)).unwrap()
}

/// Fills a box of the world with matter.
fn fill(cells: &mut Cells, placed: &GridPlacement, min: [i32; 2], size: [i32; 2], matter: Matter) {
    // The world's y points up.
    let left = min[0] - placed.origin[0];
    let top = -(min[1] + size[1]) - placed.origin[1];
    for (x, y) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))) {
        cells.set((left + x) as u32, (top + y) as u32, matter);
    }
}

/// Counts the open pixels that differ from the light of cells.
fn mismatches(seen: &Picture, placed: &GridPlacement, cells: &Cells, light: &Light) -> usize {
    let corner = placed.visible.corner.map(|v| v as u32);
    let mut mismatches = 0;
    for (x, y) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))) {
        let (cx, cy) = (corner[0] + x, corner[1] + y);
        if cells.is_solid((cy * cells.width() + cx) as usize) {
            continue;
        }
        let (seen, right) = (seen.at(x, y), light.at(cx, cy));
        let near = |c: usize| (seen[c] - right[c]).abs() <= TOLERANCE * right[c].max(1.0);
        mismatches += usize::from(!(0..3).all(near));
    }
    mismatches
}

/// Places of a glowing sprite, a wall and fog: size and corner.
const BOXES: [([i32; 2], [i32; 2]); 3] =
    [([12, 9], [-50, -20]), ([40, 3], [-20, 30]), ([6, 30], [20, -40])];

fn spawn_sprites(app: &mut App) {
    let sprite = |color, (size, min): ([i32; 2], [i32; 2])| {
        let [width, height] = size.map(|v| v as f32);
        let sprite = Sprite::from_color(color, Vec2::new(width, height));
        let middle = [min[0] as f32 + 0.5 * width, min[1] as f32 + 0.5 * height];
        (sprite, Transform::from_xyz(middle[0], middle[1], 0.0))
    };
    let red = Color::linear_rgb(1.0, 0.25, 0.125);
    let fog = Matter2d { tint: LinearRgba::rgb(0.9, 1.0, 0.8), ..Matter2d::fog(0.03) };
    app.world_mut().spawn_batch([
        (sprite(red, BOXES[0]), Matter2d::glow(8.0)),
        (sprite(Color::WHITE, BOXES[1]), Matter2d::wall()),
        (sprite(Color::WHITE, BOXES[2]), fog),
    ]);
}

/// The cells of the same scene.
fn cells_of_sprites(placed: &GridPlacement) -> Cells {
    let mut cells = Cells::new(placed.size[0], placed.size[1]).unwrap();
    let glow = Matter { emission: [8.0, 2.0, 1.0], opacity: 1.0, ..Matter::EMPTY };
    let wall = Matter { opacity: 1.0, albedo: [0.8; 3], ..Matter::EMPTY };
    let fog = Matter { opacity: 0.03, albedo: [1.0; 3], tint: [0.9, 1.0, 0.8], ..Matter::EMPTY };
    for ((size, min), matter) in BOXES.into_iter().zip([glow, wall, fog]) {
        fill(&mut cells, placed, min, size, matter);
    }
    cells
}

fn light_with(bounces: u32, cells: &Cells) -> Light {
    let settings = Settings { bounces: Bounces::Count(bounces), ..Settings::new(Method::Cascades) };
    Solver::new(settings).unwrap().solve(cells).unwrap().clone()
}

#[test]
fn a_glowing_sprite_gives_the_same_light_as_the_same_cells() {
    for backend in [LightBackend::Gpu, LightBackend::Cpu] {
        let mut app = app();
        app.insert_resource(backend);
        let image = target(&mut app, SIZE);
        camera(&mut app, &image, Lighting2d { bounces: LightBounces::Count(2), ..plain() });
        spawn_sprites(&mut app);
        begin(&mut app);
        let seen = picture(&mut app, &image, 3);

        let placed = placed([0.0, 0.0]);
        let mut cells = cells_of_sprites(&placed);
        assert_eq!(mismatches(&seen, &placed, &cells, &light_with(2, &cells)), 0, "{backend:?}");

        // A scene that lacks part of the wall is rejected.
        fill(&mut cells, &placed, BOXES[1].1, [1, 3], Matter::EMPTY);
        assert!(mismatches(&seen, &placed, &cells, &light_with(2, &cells)) > 20, "{backend:?}");
    }
}

#[test]
fn bounces_come_over_frames_unless_the_camera_says_otherwise() {
    assert_eq!(Lighting2d::default().bounces, LightBounces::Feedback);
    let mut app = app();
    app.insert_resource(LightBackend::Gpu);
    let image = target(&mut app, SIZE);
    camera(&mut app, &image, Lighting2d { bounces: LightBounces::Feedback, ..plain() });
    spawn_sprites(&mut app);
    begin(&mut app);
    let seen = picture(&mut app, &image, 8);

    let placed = placed([0.0, 0.0]);
    let cells = cells_of_sprites(&placed);
    assert_eq!(mismatches(&seen, &placed, &cells, &light_with(8, &cells)), 0);
    assert!(mismatches(&seen, &placed, &cells, &light_with(1, &cells)) > 20);
}
