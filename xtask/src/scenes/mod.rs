//! The example scenes: art drawn by code, and scene files written by hand where a person can.

pub mod canvas;
mod cave;
mod dungeon;
mod fog;
mod grove;
mod landscape;
mod night_street;
mod odd;
mod stained_glass;
mod two_rooms;

use crate::generated::{self, Mode};
use anyhow::Result;
use canvas::{Canvas, Layer};

/// A scene's layers, drawn.
struct Art {
    name: &'static str,
    canvas: Canvas,
    layers: &'static [Layer],
}

const CHORE: &str = "scenes";

pub fn run(mode: Mode) -> Result<()> {
    let (dungeon, dungeon_file) = dungeon::draw();
    let (grove, grove_file) = grove::draw();
    for (path, text) in [("scenes/dungeon.toml", dungeon_file), ("scenes/grove.toml", grove_file)] {
        generated::bytes(mode, path, text.as_bytes(), CHORE)?;
    }
    for art in [
        cave::draw(),
        dungeon,
        fog::draw(),
        grove,
        landscape::draw(),
        night_street::draw(),
        odd::draw(),
        stained_glass::draw(),
        two_rooms::draw(),
    ] {
        for &layer in art.layers {
            let path = format!("scenes/{}/{}.png", art.name, layer.name());
            generated::picture(mode, path, &art.canvas.layer(layer), CHORE)?;
        }
    }
    Ok(())
}
