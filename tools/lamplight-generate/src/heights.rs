//! The pictures of a lamp at two heights: bricks of the cellar under its lantern.

use crate::generated::{self, Mode, root};
use crate::scenes;
use anyhow::Result;
use image::imageops::{self, FilterType};
use lamplight::{Scene, Solver};

/// Heights above the wall, px.
const HEIGHTS: [u32; 2] = [12, 80];
/// The part of the picture around the lantern, px: left, top, width, height.
const AROUND: [u32; 4] = [8, 22, 128, 72];
/// Picture pixels per cell.
const SCALE: u32 = 3;

/// Draws the pictures.
pub fn pictures() -> Result<()> {
    let path = root().join(format!("scenes/{}.toml", scenes::RELIEF));
    for height in HEIGHTS {
        let mut scene = Scene::load(&path)?;
        scene.lamps.truncate(1);
        scene.lamps[0].height = Some(height as f32);
        let cells = scene.cells()?;
        let mut solver = Solver::new(scene.resolve_settings()?)?;
        let picture = solver.solve(&cells)?.compose(&cells, &scene.display)?;
        let [left, top, columns, rows] = AROUND;
        let part = imageops::crop_imm(&picture, left, top, columns, rows).to_image();
        let large = imageops::resize(&part, SCALE * columns, SCALE * rows, FilterType::Nearest);
        let name = format!("docs/pictures/height-{height}.png");
        generated::picture(Mode::Write, &name, &large.into(), "docs")?;
    }
    Ok(())
}
