//! Lights a world that is larger than a grid, tile by tile: hills, caves, huts with lamps, made as they are read.
//!
//! `cargo run --release -p lamplight --example world -- 8192 tiles/` lights 8192×8192 cells, and writes a picture of each
//! tile into the folder `tiles/`, named by its column and row. Without a folder it only prints times, without a size it
//! lights 2048×2048 cells.

use lamplight::world::{World, WorldSettings, WorldSource};
use lamplight::{
    Bounces, Cells, Display, Error, GridWindow, Lamp, Light, Matter, Result, Settings, Sky,
};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// With its margin a multiple of 512.
const TILE: u32 = 1408;
const STONE: Matter = Matter { opacity: 1.0, albedo: [0.5, 0.45, 0.4], ..Matter::EMPTY };
/// Huts stand this far apart, px.
const HUTS: u32 = 160;

/// A world of so many columns and rows.
struct Hills([u32; 2]);

impl Hills {
    /// The row of the ground's surface.
    fn ground(&self, x: u32) -> f32 {
        let x = x as f32;
        0.45 * self.0[1] as f32 + 130.0 * (x * 0.0031).sin() + 35.0 * (x * 0.013).sin()
    }

    /// The column and the surface of the hut of a number.
    fn hut(&self, number: u32) -> [u32; 2] {
        let x = number * HUTS + 60;
        [x, self.ground(x) as u32]
    }

    fn matter(&self, x: u32, y: u32) -> Matter {
        let [left, floor] = self.hut(x / HUTS);
        let [dx, dy] = [x as i32 - left as i32, floor as i32 - y as i32];
        let beside = (0..44).contains(&dx) && (0..30).contains(&dy);
        if beside && (!(3..41).contains(&dx) && !(4..16).contains(&dy) || dy >= 27) {
            return STONE;
        }
        if (y as f32) < self.ground(x) {
            return Matter::EMPTY;
        }
        let [u, v] = [x as f32, y as f32];
        let tunnel = (0.021 * u).sin() + (0.027 * v).sin() + (0.011 * u - 0.013 * v).sin();
        if tunnel > 0.9 { Matter::EMPTY } else { STONE }
    }
}

impl WorldSource for Hills {
    fn size(&self) -> [u32; 2] {
        self.0
    }

    fn sky(&self) -> Sky {
        Sky::Uniform([0.02, 0.03, 0.06])
    }

    fn cells(&self, window: GridWindow) -> Result<Cells> {
        let GridWindow { first: [left, top], size: [width, height] } = window;
        let mut cells = Cells::new(width, height)?;
        for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
            cells.set(x, y, self.matter(left + x, top + y));
        }
        for number in left / HUTS..=(left + width) / HUTS {
            let [x, y] = self.hut(number);
            let position = [(x + 22) as f32 - left as f32, y as f32 - 20.0 - top as f32];
            let color = [1.0, 0.6, 0.25];
            cells.lamps_mut().push(Lamp {
                position,
                color,
                size: 3.0,
                intensity: 3.0,
                ..Lamp::default()
            });
        }
        Ok(cells)
    }
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let side = arguments.next().map_or(Ok(2048), |text| {
        text.parse().map_err(|_| Error::value("size", text, "a whole number of cells"))
    })?;
    let folder = arguments.next().map(PathBuf::from);
    if let Some(folder) = &folder {
        // Before any light, so that it is not found for nothing.
        std::fs::create_dir_all(folder)
            .map_err(|error| format!("cannot make the folder {}: {error}", folder.display()))?;
    }
    let source = Hills([side; 2]);

    let start = Instant::now();
    let settings = Settings { bounces: Bounces::Count(2), ..Settings::default() };
    let world = World::new(&source, WorldSettings::new(settings), |part, parts| {
        eprint!("\rread {part} of {parts} parts ");
    })?;
    eprintln!();
    println!("far field of {side}×{side} cells: {:.1} s", start.elapsed().as_secs_f64());

    let mut longest = Duration::ZERO;
    let mut tiles = world.light_tiles(TILE)?;
    let windows = tiles.windows();
    let lighting = Instant::now();
    for (number, &window) in windows.iter().enumerate() {
        let start = Instant::now();
        let light = tiles.light(window)?;
        longest = longest.max(start.elapsed());
        eprint!("\rlit {} of {} tiles ", number + 1, windows.len());
        if let Some(folder) = &folder {
            write(&light, &source.cells(window)?, window, folder)?;
        }
    }
    eprintln!();
    let seconds = lighting.elapsed().as_secs_f64();
    let longest = longest.as_secs_f64();
    println!("{} tiles: {seconds:.1} s, the longest {longest:.2} s", windows.len());
    Ok(())
}

/// Writes the picture of a tile.
fn write(
    light: &Light,
    cells: &Cells,
    window: GridWindow,
    folder: &Path,
) -> Result<(), Box<dyn std::error::Error>> {
    let picture = light.compose(cells, &Display::default())?;
    let [column, row] = window.first.map(|v| v / TILE);
    let path = folder.join(format!("{column}-{row}.png"));
    picture.save(&path).map_err(|error| format!("cannot write {}: {error}", path.display()))?;
    Ok(())
}
