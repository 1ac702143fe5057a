//! A level, from its lowest layer to its highest.

use super::json::{
    Definitions, LayerDefinition, LayerInstance, LevelFile, TileInstance, TilesetDefinition,
};
use super::notes::{self, LayerNotes};
use crate::maps::map_file::beside;
use crate::maps::objects::{self, MapLight};
use crate::maps::properties::{Properties, of};
use crate::maps::tile_map::{
    Flips, MapTile, PlacedTile, Places, Sheet, Square, TileLayer, TileMap,
};
use crate::maps::tile_matter::TileMatter;
use crate::tiling::check_size;
use crate::{Error, Result, notation};
use std::collections::HashMap;
use std::path::Path;

/// The most tiles of all tilesets.
const MAX_TILES: u64 = 1 << 20;

/// Makes a map of a level in the file at `path`. Images lie beside the file of its project.
pub(super) fn map(
    definitions: &Definitions,
    project: &Path,
    level: &LevelFile,
    path: &Path,
) -> Result<TileMap> {
    let own = notes::of_fields(&level.field_instances);
    let mut map = TileMap {
        file: path.to_owned(),
        size: [level.px_wid, level.px_hei],
        background: notation::hex(&level.background),
        ..TileMap::default()
    };
    objects::read_sky(&own, project, &mut map)?;
    check_size(map.size)?;
    let mut reader =
        LevelReader { definitions, project, map, tilesets: HashMap::new(), sets: Vec::new() };
    reader.sets.push(Properties::default());
    for tileset in &definitions.tilesets {
        reader.tileset(tileset).map_err(|e| of(&named(tileset), e))?;
    }
    // The uppermost comes first in the file.
    for layer in level.layer_instances.iter().flatten().rev() {
        let name = format!("layer \"{}\"", layer.identifier);
        reader.layer(layer, &name).map_err(|e| of(&name, e))?;
    }
    let mut map = reader.map;
    objects::read_cookies(project, &mut map)?;
    Ok(map)
}

/// A level that is being read.
struct LevelReader<'a> {
    definitions: &'a Definitions,
    project: &'a Path,
    map: TileMap,
    /// The first number of the tiles of each tileset that has an image, and how many there are.
    tilesets: HashMap<i64, (u32, u32)>,
    /// Sets of properties of tiles.
    sets: Vec<Properties>,
}

fn named(tileset: &TilesetDefinition) -> String {
    format!("tileset \"{}\"", tileset.identifier)
}

impl LevelReader<'_> {
    fn tileset(&mut self, tileset: &TilesetDefinition) -> Result<()> {
        // LDtk's own icons are in no file.
        let Some(image) = &tileset.rel_path else { return Ok(()) };
        let TilesetDefinition { tile_grid_size: side, spacing, padding, .. } = *tileset;
        let size = [tileset.px_wid, tileset.px_hei];
        let pitch = u64::from(side) + u64::from(spacing);
        let fit = |length: u32| {
            let inner = u64::from(length) + u64::from(spacing);
            inner.saturating_sub(2 * u64::from(padding)) / pitch.max(1)
        };
        let [columns, rows] = size.map(fit);
        let first = self.map.tiles.len();
        let count = columns.saturating_mul(rows);
        if side == 0 || count.saturating_add(first as u64) > MAX_TILES {
            let found = format!("{}×{} px in tiles of {side} px", size[0], size[1]);
            return Err(Error::value(
                "tileGridSize",
                found,
                format!("at most {MAX_TILES} tiles in all"),
            ));
        }
        let sheet = self.map.sheets.len() as u32;
        self.map.sheets.push(Sheet {
            name: named(tileset),
            path: beside(self.project, image),
            transparent: None,
        });
        self.tilesets.insert(tileset.uid, (first as u32, count as u32));
        let mut own: HashMap<u32, Properties> = HashMap::new();
        for tag in &tileset.enum_tags {
            let Some(properties) = notes::of_tag(tag) else { continue };
            own.extend(tag.tile_ids.iter().map(|&id| (id, properties.clone())));
        }
        for data in &tileset.custom_data {
            let over = notes::of_tile_data(data);
            let entry = own.entry(data.tile_id).or_default();
            *entry = over.over(entry);
        }
        for id in 0..count {
            let at = [id % columns.max(1), id / columns.max(1)];
            let from = at.map(|v| (v * pitch) as u32 + padding);
            let properties = match own.remove(&(id as u32)) {
                None => 0,
                Some(set) => self.set(set),
            };
            let tile = MapTile { sheet, from, size: [side; 2], offset: [0; 2], properties };
            self.map.tiles.push(Some(tile));
        }
        Ok(())
    }

    /// The index of a set of properties.
    fn set(&mut self, own: Properties) -> u32 {
        let known = self.sets.iter().position(|set| *set == own);
        let index = known.unwrap_or_else(|| {
            self.sets.push(own);
            self.sets.len() - 1
        });
        index as u32
    }

    fn layer(&mut self, layer: &LayerInstance, name: &str) -> Result<()> {
        let definitions = &self.definitions.layers;
        let definition = definitions.iter().find(|found| found.uid == layer.layer_def_uid);
        let notes = match definition {
            Some(definition) => LayerNotes::of(&definition.doc)?,
            None => LayerNotes::default(),
        };
        let tiles: Vec<&TileInstance> =
            layer.auto_layer_tiles.iter().chain(&layer.grid_tiles).collect();
        let tileset = layer.tileset.and_then(|uid| self.tilesets.get(&uid).copied());
        if let Some(tileset) = tileset {
            let places = places(&tiles, tileset)?;
            let matter = |set: &Properties| TileMatter::of(set, &notes.tiles, layer.visible);
            let matter = self.sets.iter().map(matter).collect::<Result<_>>()?;
            self.push(layer, name, matter, Places::List(places));
        }
        if let (Some(definition), false) = (definition, layer.int_grid_csv.is_empty()) {
            let paints = layer.visible && layer.tileset.is_none();
            let places = squares(layer, definition, &notes, paints)?;
            self.push(layer, name, Vec::new(), places);
        }
        if layer.visible {
            self.entities(layer)?;
        }
        Ok(())
    }

    fn push(&mut self, layer: &LayerInstance, name: &str, matter: Vec<TileMatter>, places: Places) {
        self.map.layers.push(TileLayer {
            name: name.to_owned(),
            offset: [layer.offset_x, layer.offset_y],
            opacity: layer.opacity.clamp(0.0, 1.0),
            tint: [1.0; 3],
            matter,
            places,
        });
    }

    fn entities(&mut self, layer: &LayerInstance) -> Result<()> {
        for entity in &layer.entity_instances {
            let size = [entity.width, entity.height];
            let offset = [layer.offset_x, layer.offset_y].map(|v| v as f32);
            let position =
                [0, 1].map(|a| entity.px[a] + (0.5 - entity.pivot[a]) * size[a] + offset[a]);
            let own = notes::of_fields(&entity.field_instances);
            let light = objects::light(&entity.identifier, position, 0.0, &own);
            match light.map_err(|e| of(&format!("entity \"{}\"", entity.identifier), e))? {
                Some(MapLight::Lamp(lamp)) => self.map.lamps.push(lamp),
                Some(MapLight::Sun(sun)) => self.map.suns.push(sun),
                None => {}
            }
        }
        Ok(())
    }
}

/// The places of tiles of a tileset with this first number and so many tiles.
fn places(tiles: &[&TileInstance], (first, count): (u32, u32)) -> Result<Vec<PlacedTile>> {
    let placed = |tile: &&TileInstance| {
        if tile.t >= count {
            let expected = format!("below {count}, the number of tiles of its tileset");
            return Err(Error::value("tile", tile.t, expected));
        }
        let flips =
            Flips { diagonal: false, horizontal: tile.f & 1 != 0, vertical: tile.f & 2 != 0 };
        Ok(PlacedTile { at: tile.px, number: first + tile.t, flips })
    };
    tiles.iter().map(placed).collect()
}

/// The matter of an IntGrid. Without tiles its values are painted in their colours.
fn squares(
    layer: &LayerInstance,
    definition: &LayerDefinition,
    notes: &LayerNotes,
    paints: bool,
) -> Result<Places> {
    let (columns, rows) = (layer.columns, layer.rows);
    let count = u64::from(columns) * u64::from(rows);
    if layer.int_grid_csv.len() as u64 != count || layer.grid_size == 0 {
        let found = format!("{} values", layer.int_grid_csv.len());
        return Err(Error::value(
            "intGridCsv",
            found,
            format!("{count}, for {columns}×{rows} cells"),
        ));
    }
    let mut squares = Vec::new();
    let mut kinds = HashMap::new();
    for value in &definition.int_grid_values {
        let matter = match notes.of_value(&value.identifier) {
            None => None,
            Some(own) => {
                let light = TileMatter::of(&own, &Properties::default(), true);
                let light = light.map_err(|e| of(&format!("value \"{}\"", value.identifier), e))?;
                let by_picture = !own.has_any(&["material"]);
                light.matter.map(|matter| (matter, by_picture))
            }
        };
        let color = notation::hex(&value.color).filter(|_| paints);
        squares.push(Square { matter, color });
        kinds.insert(value.value, squares.len() as u32);
    }
    let kind = |value: &u32| kinds.get(value).copied().unwrap_or(0);
    let cells = layer.int_grid_csv.iter().map(kind).collect();
    Ok(Places::Squares { side: layer.grid_size, columns, cells, squares })
}
