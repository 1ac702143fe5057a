//! Tilesets, in the map's file or in one of their own (`.tsx`).

use super::xml::{
    at_line, attribute, child, children, class, color, pixels, properties, required, with_root,
};
use crate::maps::map_file::beside;
use crate::maps::properties::Properties;
use crate::maps::tile_map::{MapTile, Sheet, TileMap};
use crate::{Error, Result};
use roxmltree::Node;
use std::path::Path;

/// The most tiles of a map's tilesets.
const MAX_TILES: u32 = 1 << 20;

/// The class and the properties that tiles have in their tileset.
#[derive(Clone, Default, PartialEq)]
pub(super) struct TileKind {
    pub class: Option<String>,
    pub properties: Properties,
}

/// The tilesets of a map, beside their tiles.
#[derive(Default)]
pub(super) struct Tilesets {
    /// The kinds of their tiles; the first one has nothing.
    pub kinds: Vec<TileKind>,
    /// The first tile of each, and the point by which its tiles stand on their place as objects, as fractions of their size.
    anchors: Vec<(u32, [f32; 2])>,
}

impl Tilesets {
    /// Returns the point by which a tile stands on its place as an object.
    pub fn anchor(&self, number: u32) -> [f32; 2] {
        let own = self.anchors.iter().filter(|(first, _)| *first <= number);
        own.max_by_key(|(first, _)| *first).map_or(BOTTOM_LEFT, |(_, anchor)| *anchor)
    }
}

/// The anchor of tiles of which nothing else is said.
pub(super) const BOTTOM_LEFT: [f32; 2] = [0.0, 1.0];

/// Reads the `objectalignment` of a tileset.
fn anchor(node: Node) -> Result<[f32; 2]> {
    let name = node.attribute("objectalignment").unwrap_or("unspecified");
    Ok(match name {
        "unspecified" | "bottomleft" => BOTTOM_LEFT,
        "topleft" => [0.0, 0.0],
        "top" => [0.5, 0.0],
        "topright" => [1.0, 0.0],
        "left" => [0.0, 0.5],
        "center" => [0.5, 0.5],
        "right" => [1.0, 0.5],
        "bottom" => [0.5, 1.0],
        "bottomright" => [1.0, 1.0],
        _ => {
            let expected = "an alignment of Tiled, such as center or bottomleft";
            return Err(at_line(node, Error::value("objectalignment", name, expected)));
        }
    })
}

/// Reads the tilesets of a map into it.
pub(super) fn read(map_node: Node, file: &Path, map: &mut TileMap) -> Result<Tilesets> {
    let mut read = Tilesets { kinds: vec![TileKind::default()], ..Tilesets::default() };
    let Tilesets { kinds, anchors } = &mut read;
    for node in children(map_node, "tileset") {
        let first: u32 = required(node, "firstgid")?;
        let mut read = |node: Node, file: &Path| {
            anchors.push((first, anchor(node)?));
            Tileset { node, file, first, map: &mut *map, kinds: &mut *kinds }.read()
        };
        match node.attribute("source") {
            None => read(node, file)?,
            Some(source) if !source.ends_with(".tsx") && !source.ends_with(".xml") => {
                let expected = "a tileset as .tsx: save it as that in Tiled";
                return Err(at_line(node, Error::value("tileset.source", source, expected)));
            }
            Some(source) => {
                let path = beside(file, source);
                with_root(&path, "tileset", |node| read(node, &path)).map_err(|e| {
                    let source = format!("tileset {source}");
                    at_line(node, Error::Under { key: source, source: Box::new(e) })
                })?;
                map.files.push(path);
            }
        }
    }
    Ok(read)
}

/// A tileset that is being read.
struct Tileset<'a, 'n, 'i> {
    node: Node<'n, 'i>,
    file: &'a Path,
    /// The number of its first tile in the map.
    first: u32,
    map: &'a mut TileMap,
    kinds: &'a mut Vec<TileKind>,
}

impl Tileset<'_, '_, '_> {
    fn read(mut self) -> Result<()> {
        let offset = match child(self.node, "tileoffset") {
            Some(offset) => [pixels(offset, "x")?, pixels(offset, "y")?],
            None => [0, 0],
        };
        if let Some(image) = child(self.node, "image") {
            self.one_image(image, offset)?;
        }
        for tile in children(self.node, "tile") {
            let id: u32 = required(tile, "id")?;
            if let Some(image) = child(tile, "image") {
                self.own_image(tile, image, id, offset)?;
            }
            let mut own = properties(tile);
            // Tiles with a shape for collisions are walls, unless something else is said.
            let collides = child(tile, "objectgroup").is_some_and(|g| child(g, "object").is_some());
            if collides && !own.has_any(&["light"]) {
                let mut walls = Properties::default();
                walls.set("light", "walls".into());
                own = own.over(&walls);
            }
            self.set_kind(id, TileKind { class: class(tile), properties: own });
        }
        Ok(())
    }

    /// Cuts one image into tiles.
    fn one_image(&mut self, image: Node, offset: [i32; 2]) -> Result<()> {
        let node = self.node;
        let size: [u32; 2] = [required(node, "tilewidth")?, required(node, "tileheight")?];
        let margin: u32 = attribute(node, "margin")?.unwrap_or(0);
        let spacing: u32 = attribute(node, "spacing")?.unwrap_or(0);
        let sheet = self.sheet(image)?;
        let fit = |length: u32, size: u32| {
            (u64::from(length) + u64::from(spacing)).saturating_sub(2 * u64::from(margin))
                / (u64::from(size) + u64::from(spacing)).max(1)
        };
        // Old files lack what can be found out.
        let (columns, count) = match (attribute(node, "columns")?, attribute(node, "tilecount")?) {
            (Some(columns), Some(count)) => (columns, count),
            (columns, count) => {
                let [width, height] = self.image_size(image, sheet)?;
                let columns = columns.unwrap_or(fit(width, size[0]));
                (columns, count.unwrap_or(columns.saturating_mul(fit(height, size[1]))))
            }
        };
        if size.contains(&0) || columns == 0 && count > 0 {
            let found = format!("of {}×{} px in {columns} columns", size[0], size[1]);
            return Err(at_line(node, Error::value("tileset", found, "of tiles that have a size")));
        }
        self.check_count(count)?;
        for id in 0..count {
            let at = [id % columns, id / columns];
            let from = [0, 1].map(|a| {
                let begin = at[a] * (u64::from(size[a]) + u64::from(spacing)) + u64::from(margin);
                u32::try_from(begin).unwrap_or(u32::MAX)
            });
            self.add(id as u32, MapTile { sheet, from, size, offset, properties: 0 })?;
        }
        Ok(())
    }

    /// Adds a tile that has an image of its own, or a part of one.
    fn own_image(&mut self, tile: Node, image: Node, id: u32, offset: [i32; 2]) -> Result<()> {
        let sheet = self.sheet(image)?;
        let from = [attribute(tile, "x")?.unwrap_or(0), attribute(tile, "y")?.unwrap_or(0)];
        let size = match (attribute(tile, "width")?, attribute(tile, "height")?) {
            (Some(width), Some(height)) => [width, height],
            _ => self.image_size(image, sheet)?,
        };
        self.add(id, MapTile { sheet, from, size, offset, properties: 0 })
    }

    fn sheet(&mut self, image: Node) -> Result<u32> {
        let Some(source) = image.attribute("source") else {
            let problem = "has no source: an image inside of the file is not read";
            let error = Error::Key { key: "image".into(), problem: problem.into() };
            return Err(at_line(image, error));
        };
        let name = self.node.attribute("name").unwrap_or_default();
        self.map.sheets.push(Sheet {
            name: format!("tileset \"{name}\""),
            path: beside(self.file, source),
            transparent: color(image, "trans")?,
        });
        Ok(self.map.sheets.len() as u32 - 1)
    }

    /// The size of an image, from the map or from its own header.
    fn image_size(&self, image: Node, sheet: u32) -> Result<[u32; 2]> {
        if let (Some(width), Some(height)) =
            (attribute(image, "width")?, attribute(image, "height")?)
        {
            return Ok([width, height]);
        }
        let path = &self.map.sheets[sheet as usize].path;
        let (width, height) = image::image_dimensions(path).map_err(|e| {
            at_line(image, Error::Format { path: path.clone(), problem: e.to_string() })
        })?;
        Ok([width, height])
    }

    fn check_count(&self, count: u64) -> Result<()> {
        if count.saturating_add(self.first.into()) <= MAX_TILES.into() {
            return Ok(());
        }
        let found = format!("{count} tiles from number {} on", self.first);
        let expected = format!("numbers up to {MAX_TILES}");
        Err(at_line(self.node, Error::value("tileset", found, expected)))
    }

    fn add(&mut self, id: u32, tile: MapTile) -> Result<()> {
        self.check_count(u64::from(id) + 1)?;
        let number = (self.first + id) as usize;
        if self.map.tiles.len() <= number {
            self.map.tiles.resize(number + 1, None);
        }
        self.map.tiles[number] = Some(tile);
        Ok(())
    }

    fn set_kind(&mut self, id: u32, own: TileKind) {
        let number = u64::from(self.first) + u64::from(id);
        let tile = self.map.tiles.get_mut(number as usize).and_then(Option::as_mut);
        let (Some(tile), false) = (tile, own == TileKind::default()) else { return };
        let known = self.kinds.iter().position(|kind| *kind == own);
        let index = known.unwrap_or_else(|| {
            self.kinds.push(own);
            self.kinds.len() - 1
        });
        tile.properties = index as u32;
    }
}
