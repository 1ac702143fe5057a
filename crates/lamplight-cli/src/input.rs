//! Inputs of commands: a scene file, or a map of a level editor.

use crate::error::{CliError, Result};
use crate::memory::SceneSize;
use lamplight::maps::MapWorld;
use lamplight::scene::SceneWorld;
use lamplight::world::WorldSource;
use lamplight::{Cells, Display, Scene, SettingsTable};
use serde_json::{Value, json};
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

/// A scene file or a map, by its ending.
#[derive(Debug)]
pub enum Input {
    Scene(Box<Scene>),
    Map(Box<MapWorld>),
}

impl Input {
    /// Reads a file that has to fit a grid.
    pub fn load(path: &Path) -> Result<Self> {
        if !MapWorld::reads(path) {
            let scene = Scene::load(path).map_err(|e| match Scene::load_world(path) {
                Ok(_) => larger_than_a_grid(e, path),
                Err(_) => e.into(),
            });
            return Ok(Self::Scene(Box::new(scene?)));
        }
        let map = MapWorld::open(path)?;
        let [width, height] = map.size();
        let fits = Cells::check_size(width.into(), height.into());
        fits.map_err(|e| larger_than_a_grid(e.in_file(path), path))?;
        Ok(Self::Map(Box::new(map)))
    }

    /// Reads a file that may be larger than a grid.
    pub fn load_world(path: &Path) -> Result<Self> {
        if MapWorld::reads(path) {
            return Ok(Self::Map(Box::new(MapWorld::open(path)?)));
        }
        Ok(Self::Scene(Box::new(Scene::load_world(path)?)))
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        match self {
            Self::Scene(scene) => scene.size,
            Self::Map(map) => map.size(),
        }
    }

    /// The place of the first cell in a level editor's coordinates.
    pub fn origin(&self) -> Option<[i32; 2]> {
        match self {
            Self::Scene(_) => None,
            Self::Map(map) => Some(map.origin()),
        }
    }

    /// Properties that decide how much memory it takes.
    pub fn scene_size(&self) -> SceneSize {
        match self {
            Self::Scene(scene) => SceneSize::of(scene),
            Self::Map(map) => SceneSize::of_matter(map.size().map(u64::from).iter().product()),
        }
    }

    /// Its own settings. Maps have none.
    pub fn settings(&self) -> SettingsTable {
        match self {
            Self::Scene(scene) => scene.settings.clone(),
            Self::Map(_) => SettingsTable::default(),
        }
    }

    /// Its own display.
    pub fn display(&self) -> Display {
        match self {
            Self::Scene(scene) => scene.display,
            Self::Map(_) => Display::default(),
        }
    }

    /// All of it as a grid.
    pub fn cells(&self) -> Result<Cells> {
        Ok(match self {
            Self::Scene(scene) => scene.cells()?,
            Self::Map(map) => map.all_cells()?,
        })
    }

    /// Warnings about what is valid and probably a mistake.
    pub fn warnings(&self, cells: &Cells) -> Vec<String> {
        match self {
            Self::Scene(scene) => scene.warnings(cells),
            Self::Map(_) => {
                let own = is_dark(cells).then(|| DARK.to_owned());
                let of_cells = Scene::new(cells.width(), cells.height()).warnings(cells);
                own.into_iter().chain(of_cells).collect()
            }
        }
    }

    /// The files that it reads.
    pub fn files(&self) -> Result<Vec<PathBuf>> {
        Ok(match self {
            Self::Scene(scene) => scene.files(),
            Self::Map(map) => map.files()?,
        })
    }

    /// Its cells, window by window.
    pub fn source(&self) -> Result<Box<dyn WorldSource + '_>> {
        Ok(match self {
            Self::Scene(scene) => Box::new(SceneWorld::new(&**scene)?),
            Self::Map(map) => Box::new(&**map),
        })
    }

    /// A description that differs if it is another one, or a file that it reads was changed.
    pub fn identity(&self) -> Result<Value> {
        let files = self.files()?;
        let folder = files.first().and_then(|own| own.parent()).unwrap_or(Path::new(""));
        let all = || files.iter().map(|file| of_file(file, folder));
        Ok(match self {
            // Of its own file, the values count.
            Self::Scene(scene) => json!({
                "text": scene.to_toml()?, "files": all().skip(1).collect::<Vec<_>>(),
            }),
            Self::Map(_) => all().collect(),
        })
    }
}

/// The error for a file that only `bake` can light.
fn larger_than_a_grid(error: lamplight::Error, path: &Path) -> CliError {
    CliError::from(error)
        .hint(format_args!("`lamplight bake {}` lights worlds of any size", path.display()))
}

/// Most maps have no lights yet when they are first lit.
const DARK: &str = "nothing in the map gives light: add a lamp (in Tiled a point of class `lamp`, in LDtk an entity `Lamp`), a \
                    `sky`, or tiles with `emission`";

fn is_dark(cells: &Cells) -> bool {
    let shines = |light: &[lamplight::Rgb]| light.as_flattened().iter().any(|&v| v > 0.0);
    let of_matter = shines(cells.emission()) || cells.glow().is_some_and(shines);
    cells.lamps().is_empty() && cells.suns().is_empty() && cells.sky().is_black() && !of_matter
}

/// The name of a file, from a folder on if it lies there, its length and a checksum of its bytes.
fn of_file(path: &Path, folder: &Path) -> Value {
    let (bytes, checksum) = checksum(path).unzip();
    let name = path.strip_prefix(folder).unwrap_or(path);
    json!({ "file": name.display().to_string(), "bytes": bytes, "crc32": checksum })
}

/// The length of a file and the CRC-32 of its bytes; none if it cannot be read, which whatever needs it reports.
fn checksum(path: &Path) -> Option<(u64, u32)> {
    let mut file = BufReader::with_capacity(1 << 16, File::open(path).ok()?);
    let (mut length, mut hasher) = (0, crc32fast::Hasher::new());
    loop {
        let bytes = file.fill_buf().ok()?;
        if bytes.is_empty() {
            return Some((length, hasher.finalize()));
        }
        hasher.update(bytes);
        let count = bytes.len();
        length += count as u64;
        file.consume(count);
    }
}
