//! A file of a level editor as a world: its maps side by side, read when a window needs them.

use super::draw::draw;
use super::tile_map::TileMap;
use super::{ldtk, tiled};
use crate::recent::RecentlyUsed;
use crate::scene::pictures::Pictures;
use crate::tiling::check_size;
use crate::world::{WorldSource, lamps_within};
use crate::{Cells, Error, GridWindow, Lamp, Result, Sky, Sun};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The most bytes of maps that are kept. A larger one is kept alone.
const MAP_BYTES: u64 = 128 << 20;

/// The farthest that a lamp reaches beyond its map, px: the largest disc. One of a greater range, in the methods that light
/// lamps by it, ends there in windows, so that these read only the maps around them.
const LAMP_REACH: u32 = 514;

/// A map of Tiled (`.tmx`), a world of them (`.world`), or a project of LDtk (`.ldtk`).
///
/// ```no_run
/// use lamplight::maps::MapWorld;
/// use lamplight::world::{World, WorldSettings};
/// let island = MapWorld::open("island.world")?;
/// let world = World::new(&island, WorldSettings::new(Default::default()), |_, _| ())?;
/// let mut tiles = world.light_tiles(1024)?;
/// for window in tiles.windows() {
///     let light = tiles.light(window)?;
/// }
/// # Ok::<(), lamplight::Error>(())
/// ```
#[derive(Debug)]
pub struct MapWorld {
    file: PathBuf,
    rooms: Vec<Room>,
    /// The project whose levels the rooms are.
    project: Option<ldtk::Project>,
    origin: [i32; 2],
    size: [u32; 2],
    sky: Sky,
    suns: Vec<Sun>,
    maps: RecentlyUsed<TileMap>,
    pictures: Pictures,
}

/// A map in its place.
#[derive(Debug)]
struct Room {
    /// Its first cell, in the editor's coordinates until all rooms are known, then in the world.
    first: [i64; 2],
    size: [u32; 2],
    /// The place of the origin of the map's own coordinates.
    anchor: [i64; 2],
    map: RoomMap,
}

#[derive(Debug)]
enum RoomMap {
    Held(Arc<TileMap>),
    File(PathBuf),
}

impl Room {
    /// A map that has been read, whose own origin is at this place.
    fn of(map: TileMap, anchor: [i32; 2]) -> Self {
        let anchor = anchor.map(i64::from);
        let first = [0, 1].map(|a| anchor[a] + i64::from(map.first[a]));
        Self { first, size: map.size, anchor, map: RoomMap::Held(Arc::new(map)) }
    }

    fn of_level(level: ldtk::PlacedLevel) -> Self {
        let first = level.first.map(i64::from);
        let map = match level.map {
            ldtk::LevelMap::Inside(map) => RoomMap::Held(Arc::from(map)),
            ldtk::LevelMap::File(path) => RoomMap::File(path),
        };
        Self { first, size: level.size, anchor: first, map }
    }

    /// Returns the place of the upper left corner of its map.
    fn corner(&self, map: &TileMap) -> [i64; 2] {
        [0, 1].map(|a| self.anchor[a] + i64::from(map.first[a]))
    }

    /// Returns the lamps of its map in their place.
    fn lamps(&self, map: &TileMap) -> impl Iterator<Item = Lamp> {
        let corner = self.corner(map).map(|v| v as f32);
        map.lamps.iter().map(move |lamp| {
            let position = [0, 1].map(|a| lamp.position[a] + corner[a]);
            Lamp { position, ..lamp.clone() }
        })
    }

    /// Returns whether a window with a margin has a part of it.
    fn meets(&self, window: GridWindow, margin: u32) -> bool {
        (0..2).all(|a| {
            let begin = i64::from(window.first[a]) - i64::from(margin);
            let end = i64::from(window.first[a]) + i64::from(window.size[a] + margin);
            self.first[a] < end && begin < self.first[a] + i64::from(self.size[a])
        })
    }
}

impl MapWorld {
    /// Returns whether a file is one of a level editor, by its ending.
    pub fn reads(path: impl AsRef<Path>) -> bool {
        ["tmx", "world", "ldtk"].contains(&&*ending(path.as_ref()))
    }

    /// Opens a file. Of a world, only the first map is read, for its sky and its suns.
    ///
    /// # Errors
    /// Fails if a file is missing or invalid, or the world is larger than [`MAX_SIDE`](crate::world::MAX_SIDE).
    pub fn open(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        let (rooms, project) = match &*ending(path) {
            "tmx" => (vec![Room::of(tiled::read_map(path)?, [0, 0])], None),
            "world" => (rooms_of_world(path)?, None),
            "ldtk" => {
                let (project, levels) = ldtk::read_project(path)?;
                (levels.into_iter().map(Room::of_level).collect(), Some(project))
            }
            _ => {
                let problem =
                    "its ending is none of those that are read: .tmx, .world and .ldtk".into();
                return Err(Error::Format { path: path.to_owned(), problem });
            }
        };
        Self::of(path, rooms, project)
    }

    fn of(path: &Path, mut rooms: Vec<Room>, project: Option<ldtk::Project>) -> Result<Self> {
        let ends = |room: &Room| [0, 1].map(|a| room.first[a] + i64::from(room.size[a]));
        let first = [0, 1].map(|a| rooms.iter().map(|room| room.first[a]).min().unwrap_or(0));
        let last = [0, 1].map(|a| rooms.iter().map(|room| ends(room)[a]).max().unwrap_or(0));
        let size = [0, 1].map(|a| u32::try_from(last[a] - first[a]).unwrap_or(u32::MAX));
        check_size(size).map_err(|e| e.in_file(path))?;
        for room in &mut rooms {
            room.first = [0, 1].map(|a| room.first[a] - first[a]);
            room.anchor = [0, 1].map(|a| room.anchor[a] - first[a]);
        }
        let origin = first.map(|v| v.clamp(i32::MIN.into(), i32::MAX.into()) as i32);
        let mut world = Self {
            file: path.to_owned(),
            rooms,
            project,
            origin,
            size,
            sky: Sky::BLACK,
            suns: Vec::new(),
            maps: RecentlyUsed::new(MAP_BYTES),
            pictures: Pictures::default(),
        };
        if let Some(room) = world.rooms.first() {
            let map = world.map(room)?;
            world.sky = map.sky.clone().unwrap_or(Sky::BLACK);
            world.suns = map.suns.clone();
        }
        Ok(world)
    }

    /// The place of the first cell in the coordinates of the editor, px.
    pub fn origin(&self) -> [i32; 2] {
        self.origin
    }

    /// Returns the files that it reads: maps, tilesets, templates and images. All maps are read for it.
    ///
    /// # Errors
    /// Fails if a map is missing or invalid.
    pub fn files(&self) -> Result<Vec<PathBuf>> {
        let mut files = vec![self.file.clone()];
        for room in &self.rooms {
            if let RoomMap::File(path) = &room.map {
                files.push(path.clone());
            }
            let map = self.map(room)?;
            files.extend(map.files.iter().cloned());
            files.extend(map.sheets.iter().map(|sheet| sheet.path.clone()));
        }
        // Maps share them.
        let mut known = HashSet::new();
        files.retain(|file| known.insert(file.clone()));
        Ok(files)
    }

    /// Draws all of it, with its sky and its suns.
    ///
    /// # Errors
    /// Fails if it is larger than a grid, or as [`WorldSource::cells`].
    pub fn all_cells(&self) -> Result<Cells> {
        let (mut cells, lamps) = self.drawn(GridWindow { first: [0; 2], size: self.size })?;
        *cells.lamps_mut() = lamps;
        cells.set_sky(self.sky());
        *cells.suns_mut() = self.suns();
        Ok(cells)
    }

    /// Draws a window, without lamps. Returns it with those of the maps around it, px of the world.
    fn drawn(&self, window: GridWindow) -> Result<(Cells, Vec<Lamp>)> {
        window.check(self.size)?;
        let mut cells = Cells::new(window.size[0], window.size[1])?;
        // Nothing is painted between maps.
        cells.color_mut().fill([0.0; 3]);
        let mut lamps = Vec::new();
        for room in self.rooms.iter().filter(|room| room.meets(window, LAMP_REACH)) {
            let map = self.map(room)?;
            lamps.extend(room.lamps(&map));
            if room.meets(window, 0) {
                let within = |v: i64, a: usize| v - i64::from(window.first[a]);
                let clip = [0, 1].map(|a| {
                    let end = room.first[a] + i64::from(room.size[a]);
                    within(room.first[a], a)..within(end, a)
                });
                let corner = room.corner(&map);
                let corner = [0, 1].map(|a| within(corner[a], a));
                draw(&map, corner, clip, &self.pictures, &mut cells)?;
            }
        }
        Ok((cells, lamps))
    }

    fn map(&self, room: &Room) -> Result<Arc<TileMap>> {
        match &room.map {
            RoomMap::Held(map) => Ok(map.clone()),
            RoomMap::File(path) => self.maps.find_or(path, || {
                let read = match &self.project {
                    Some(project) => project.read_level(path),
                    None => tiled::read_map(path),
                };
                read.map_err(|e| named_in(&self.file, e))
            }),
        }
    }
}

impl WorldSource for MapWorld {
    fn size(&self) -> [u32; 2] {
        self.size
    }

    fn sky(&self) -> Sky {
        self.sky.clone()
    }

    fn suns(&self) -> Vec<Sun> {
        self.suns.clone()
    }

    fn cells(&self, window: GridWindow) -> Result<Cells> {
        let (mut cells, lamps) = self.drawn(window)?;
        *cells.lamps_mut() = lamps_within(&lamps, window);
        Ok(cells)
    }
}

fn ending(path: &Path) -> String {
    path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// Adds the file that names a map to the error of a map that cannot be opened.
fn named_in(file: &Path, error: Error) -> Error {
    match error {
        Error::Read { .. } => Error::InFile { path: file.to_owned(), source: Box::new(error) },
        error => error,
    }
}

/// The maps of a world of Tiled. Those whose size it does not have are read.
fn rooms_of_world(path: &Path) -> Result<Vec<Room>> {
    let room = |entry: tiled::WorldEntry| match entry.size {
        Some(size) => {
            let first = entry.first.map(i64::from);
            Ok(Room { first, size, anchor: first, map: RoomMap::File(entry.map) })
        }
        None => {
            let map = tiled::read_map(&entry.map).map_err(|e| named_in(path, e))?;
            Ok(Room::of(map, entry.first))
        }
    };
    tiled::read_world(path)?.into_iter().map(room).collect()
}
