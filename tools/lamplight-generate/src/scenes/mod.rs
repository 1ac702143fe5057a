//! The example scenes: art drawn by code, and scene files written by hand where a person can.

mod canvas;
mod cave;
mod cellar;
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

/// Every scene, in the order in which documents show them.
pub const NAMES: [&str; 9] = [
    "cave",
    "night_street",
    "stained_glass",
    "landscape",
    "fog",
    "two_rooms",
    "dungeon",
    "grove",
    "odd",
];

/// The scene of normal maps.
pub const RELIEF: &str = "cellar";

/// The scene of the methods that light lamps by rule. It stands apart: its lamps have the intensities and the falloff
/// of those methods' looks.
pub const BY_RULE: &str = "theatre";

const CHORE: &str = "scenes";

pub fn run(mode: Mode) -> Result<()> {
    let (dungeon, dungeon_file) = dungeon::draw();
    let (grove, grove_file) = grove::draw();
    for (path, text) in [("scenes/dungeon.toml", dungeon_file), ("scenes/grove.toml", grove_file)] {
        generated::bytes(mode, path, text.as_bytes(), CHORE)?;
    }
    for art in [
        cave::draw(),
        cellar::draw(),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated::root;
    use lamplight::{Bounces, Scene, Solver};

    /// Every scene is listed, loads without a warning, and is lit with its own settings and direct
    /// light alone: no NaN, most of the open cells not black.
    #[test]
    fn scenes_are_whole_and_lit() {
        let mut found: Vec<String> = std::fs::read_dir(root().join("scenes"))
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .filter(|path| path.extension().is_some_and(|e| e == "toml"))
            .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
            .collect();
        found.sort();
        let mut names = NAMES.to_vec();
        names.extend([BY_RULE, RELIEF]);
        names.sort();
        assert_eq!(found, names);
        for name in NAMES.into_iter().chain([RELIEF]) {
            let scene = Scene::load(root().join(format!("scenes/{name}.toml"))).unwrap();
            let cells = scene.cells().unwrap();
            assert_eq!(scene.warnings(&cells), Vec::<String>::new(), "{name}");
            let mut settings = scene.resolve_settings().unwrap();
            if let Some(raymarch) = settings.method.as_raymarch_mut() {
                raymarch.rays = 16;
            }
            settings.bounces = Bounces::Count(0);
            let mut solver = Solver::new(settings).unwrap();
            let light = solver.solve(&cells).unwrap();
            assert!(light.pixels().as_flattened().iter().all(|v| v.is_finite()), "{name}");
            let open = || light.pixels().iter().zip(light.solid()).filter(|(_, solid)| !**solid);
            let lit = open().filter(|(rgb, _)| rgb.iter().any(|v| *v > 0.0)).count();
            assert!(lit * 2 > open().count(), "{name}: {lit} of {} cells are lit", open().count());
        }
    }
}
