//! The pictures of relief: bricks of the cellar under a lamp at two heights, and under one that moves past them.

use crate::generated::{self, Mode, root};
use crate::scenes;
use anyhow::Result;
use image::imageops::{self, FilterType};
use lamplight::{Scene, Solver};

/// Heights of the lantern above the wall, px.
const HEIGHTS: [u32; 2] = [12, 80];
/// The way of the lamp that moves: positions from left to right, and its height above the wall, px.
const PATH: [[f32; 2]; 3] = [[24.5, 58.5], [52.5, 58.5], [80.5, 58.5]];
const HEIGHT_ON_PATH: f32 = 14.0;
/// The part of the picture around the lantern, px: left, top, width, height.
const AROUND: [u32; 4] = [8, 22, 128, 72];
/// The bricks between the wall's left end and the first pillar.
const BRICKS: [u32; 4] = [8, 22, 88, 72];
/// Picture pixels per cell.
const SCALE: u32 = 3;

/// Draws the pictures.
pub fn pictures() -> Result<()> {
    let mut scene = Scene::load(root().join(format!("scenes/{}.toml", scenes::RELIEF)))?;
    scene.lamps.truncate(1);
    for height in HEIGHTS {
        scene.lamps[0].height = Some(height as f32);
        picture(&scene, AROUND, &format!("height-{height}"))?;
    }
    scene.lamps[0].height = Some(HEIGHT_ON_PATH);
    for (place, position) in (1..).zip(PATH) {
        scene.lamps[0].position = position;
        picture(&scene, BRICKS, &format!("moving-lamp-{place}"))?;
    }
    Ok(())
}

/// Lights the scene and writes a part of its picture.
fn picture(scene: &Scene, part: [u32; 4], name: &str) -> Result<()> {
    let cells = scene.cells()?;
    let mut solver = Solver::new(scene.resolve_settings()?)?;
    let picture = solver.solve(&cells)?.compose(&cells, &scene.display)?;
    let [left, top, columns, rows] = part;
    let part = imageops::crop_imm(&picture, left, top, columns, rows).to_image();
    let large = imageops::resize(&part, SCALE * columns, SCALE * rows, FilterType::Nearest);
    generated::picture(Mode::Write, format!("docs/pictures/{name}.png"), &large.into(), "docs")
}
