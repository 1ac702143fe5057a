//! A world of maps (`.world`): JSON with the place of each map.

use crate::maps::map_file::{beside, read_text};
use crate::{Error, Result, json};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// The place of a map in a world, px.
pub(in crate::maps) struct WorldEntry {
    pub map: PathBuf,
    pub first: [i32; 2],
    /// The size; none if the world leaves it to the map.
    pub size: Option<[u32; 2]>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct WorldFile {
    #[serde(default)]
    maps: Vec<MapEntry>,
    #[serde(default)]
    patterns: Vec<serde_json::Value>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct MapEntry {
    file_name: String,
    #[serde(default)]
    x: i32,
    #[serde(default)]
    y: i32,
    width: Option<u32>,
    height: Option<u32>,
}

/// Reads a world. Its maps are not opened.
pub(in crate::maps) fn read_world(path: &Path) -> Result<Vec<WorldEntry>> {
    let text = read_text(path)?;
    let wrong = |problem: String| Error::Format { path: path.to_owned(), problem };
    let world: WorldFile = json::read(&text, "world")
        .map_err(|e| wrong(format!("it is not a world of Tiled: {e}")))?;
    if !world.patterns.is_empty() {
        let problem = "places maps by patterns, which are not read: list them under `maps`";
        let error = Error::Key { key: "patterns".into(), problem: problem.into() };
        return Err(error.in_file(path));
    }
    if world.maps.is_empty() {
        return Err(Error::Key { key: "maps".into(), problem: "has no map".into() }.in_file(path));
    }
    let entry = |entry: MapEntry| WorldEntry {
        map: beside(path, &entry.file_name),
        first: [entry.x, entry.y],
        size: entry.width.zip(entry.height).map(|(width, height)| [width, height]),
    };
    Ok(world.maps.into_iter().map(entry).collect())
}
