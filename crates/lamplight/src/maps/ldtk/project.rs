//! A project: its definitions, and the place of every level.

use super::json::{Definitions, LevelFile, ProjectFile};
use super::level;
use crate::maps::map_file::{beside, read_text};
use crate::maps::tile_map::TileMap;
use crate::{Error, Result, json};
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};

/// The definitions of a project, by which levels in files of their own are read.
#[derive(Debug)]
pub(in crate::maps) struct Project {
    file: PathBuf,
    definitions: Definitions,
}

/// A level in its place, px of the world.
pub(in crate::maps) struct PlacedLevel {
    pub first: [i32; 2],
    pub size: [u32; 2],
    pub map: LevelMap,
}

/// A level, or the file that it is in.
pub(in crate::maps) enum LevelMap {
    Inside(Box<TileMap>),
    File(PathBuf),
}

/// Reads a project, and the levels that are inside.
pub(in crate::maps) fn read_project(path: &Path) -> Result<(Project, Vec<PlacedLevel>)> {
    let file: ProjectFile = parse(path, "project")?;
    let ProjectFile { defs, levels, worlds, world_layout } = file;
    let (levels, layout) = match worlds.into_iter().next() {
        Some(world) if levels.is_empty() => (world.levels, world.world_layout),
        _ => (levels, world_layout),
    };
    let project = Project { file: path.to_owned(), definitions: defs };
    // In a row, levels have no place of their own.
    let mut next = 0i32;
    let mut placed = Vec::new();
    for found in levels.into_iter().filter(|level| level.world_depth == 0) {
        let size = [found.px_wid, found.px_hei];
        let first = match layout.as_str() {
            "LinearHorizontal" => [next, 0],
            "LinearVertical" => [0, next],
            _ => [found.world_x, found.world_y],
        };
        let along = usize::from(layout == "LinearVertical");
        next = next.saturating_add_unsigned(size[along]);
        let map = match (&found.external_rel_path, &found.layer_instances) {
            (Some(file), None) => LevelMap::File(beside(path, file)),
            _ => LevelMap::Inside(project.level(&found, path)?.into()),
        };
        placed.push(PlacedLevel { first, size, map });
    }
    if placed.is_empty() {
        return Err(
            Error::Key { key: "levels".into(), problem: "has no level".into() }.in_file(path)
        );
    }
    Ok((project, placed))
}

impl Project {
    /// Reads a level that is in a file of its own.
    pub fn read_level(&self, path: &Path) -> Result<TileMap> {
        self.level(&parse(path, "level")?, path)
    }

    fn level(&self, found: &LevelFile, path: &Path) -> Result<TileMap> {
        level::map(&self.definitions, &self.file, found, path).map_err(|e| {
            let key = format!("level \"{}\"", found.identifier);
            Error::Under { key, source: Box::new(e) }.in_file(path)
        })
    }
}

/// Reads a file of LDtk that has to be `what`.
fn parse<T: DeserializeOwned>(path: &Path, what: &str) -> Result<T> {
    json::read(&read_text(path)?, what).map_err(|e| Error::Format {
        path: path.to_owned(),
        problem: format!("it is not a {what} of LDtk: {e}"),
    })
}
