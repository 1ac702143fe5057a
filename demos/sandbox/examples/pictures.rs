//! Lights every world after 0, 120 and 300 steps, and the initial picture of the canvas. Writes PNGs into the
//! folder of the first argument, or the current one. Further arguments select worlds by name.

use anyhow::Result;
use lamplight::{Cells, Solver};
use lamplight_sandbox::{
    canvas::Canvas,
    look::Look,
    worlds::{Input, WorldKind},
};
use std::path::{Path, PathBuf};

const SIZE: [u32; 2] = [320, 180];

fn main() -> Result<()> {
    let mut words = std::env::args().skip(1);
    let folder = PathBuf::from(words.next().unwrap_or_else(|| ".".into()));
    let names: Vec<String> = words.collect();
    let wanted = |name: &str| names.is_empty() || names.iter().any(|n| n == name);
    std::fs::create_dir_all(&folder)?;
    for &kind in WorldKind::ALL.iter().filter(|kind| wanted(kind.name())) {
        let mut world = kind.make(SIZE, 1)?;
        let mut cells = Cells::new(SIZE[0], SIZE[1])?;
        for step in 0..=300 {
            if [0, 120, 300].contains(&step) {
                world.draw(&mut cells);
                let path = folder.join(format!("{}-{step}.png", kind.name()));
                light(&cells, &world.look(), &path)?;
            }
            // The walker goes to the right, through a door, and down.
            let direction = if step < 75 { [1.0, 0.0] } else { [0.3, 1.0] };
            world.step(&Input { direction, ..Input::default() });
        }
    }
    if wanted("welcome") {
        let canvas = Canvas::welcome(SIZE)?;
        light(canvas.cells(), &canvas.look(), &folder.join("welcome.png"))?;
    }
    Ok(())
}

fn light(cells: &Cells, look: &Look, path: &Path) -> Result<()> {
    let mut solver = Solver::new(look.settings())?;
    solver.solve(cells)?.compose(cells, &look.display)?.save(path)?;
    println!("{}", path.display());
    Ok(())
}
