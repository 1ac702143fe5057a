//! The fields of LDtk's JSON that light needs. All others are ignored, so files of other versions are read, too.

use serde::{Deserialize, Deserializer};
use serde_json::Value;

/// Reads `null` as the default.
fn or_default<'de, D: Deserializer<'de>, T: Deserialize<'de> + Default>(
    from: D,
) -> Result<T, D::Error> {
    Ok(Option::deserialize(from)?.unwrap_or_default())
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct ProjectFile {
    pub defs: Definitions,
    #[serde(default)]
    pub levels: Vec<LevelFile>,
    #[serde(default)]
    pub worlds: Vec<WorldJson>,
    #[serde(default, deserialize_with = "or_default")]
    pub world_layout: String,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct WorldJson {
    #[serde(default)]
    pub levels: Vec<LevelFile>,
    #[serde(default, deserialize_with = "or_default")]
    pub world_layout: String,
}

#[derive(Debug, Default, Deserialize)]
pub(super) struct Definitions {
    #[serde(default)]
    pub layers: Vec<LayerDefinition>,
    #[serde(default)]
    pub tilesets: Vec<TilesetDefinition>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct LayerDefinition {
    pub uid: i64,
    /// The documentation that the author writes.
    #[serde(default, deserialize_with = "or_default")]
    pub doc: String,
    #[serde(default)]
    pub int_grid_values: Vec<IntGridValue>,
}

#[derive(Debug, Deserialize)]
pub(super) struct IntGridValue {
    #[serde(default)]
    pub value: u32,
    #[serde(default, deserialize_with = "or_default")]
    pub identifier: String,
    #[serde(default)]
    pub color: String,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TilesetDefinition {
    pub uid: i64,
    #[serde(default)]
    pub identifier: String,
    pub rel_path: Option<String>,
    pub px_wid: u32,
    pub px_hei: u32,
    pub tile_grid_size: u32,
    #[serde(default)]
    pub spacing: u32,
    #[serde(default)]
    pub padding: u32,
    #[serde(default)]
    pub custom_data: Vec<TileData>,
    #[serde(default)]
    pub enum_tags: Vec<EnumTag>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct TileData {
    pub tile_id: u32,
    pub data: String,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct EnumTag {
    pub enum_value_id: String,
    pub tile_ids: Vec<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct LevelFile {
    #[serde(default)]
    pub identifier: String,
    #[serde(default)]
    pub world_x: i32,
    #[serde(default)]
    pub world_y: i32,
    #[serde(default)]
    pub world_depth: i32,
    pub px_wid: u32,
    pub px_hei: u32,
    #[serde(rename = "__bgColor", default, deserialize_with = "or_default")]
    pub background: String,
    pub external_rel_path: Option<String>,
    /// `None` if they are in a file of their own.
    pub layer_instances: Option<Vec<LayerInstance>>,
    #[serde(default)]
    pub field_instances: Vec<Field>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct LayerInstance {
    #[serde(rename = "__identifier", default)]
    pub identifier: String,
    #[serde(rename = "__cWid")]
    pub columns: u32,
    #[serde(rename = "__cHei")]
    pub rows: u32,
    #[serde(rename = "__gridSize")]
    pub grid_size: u32,
    #[serde(rename = "__opacity", default = "one")]
    pub opacity: f32,
    #[serde(rename = "__pxTotalOffsetX", default)]
    pub offset_x: i32,
    #[serde(rename = "__pxTotalOffsetY", default)]
    pub offset_y: i32,
    #[serde(rename = "__tilesetDefUid")]
    pub tileset: Option<i64>,
    pub layer_def_uid: i64,
    #[serde(default = "yes")]
    pub visible: bool,
    #[serde(default)]
    pub int_grid_csv: Vec<u32>,
    #[serde(default)]
    pub grid_tiles: Vec<TileInstance>,
    #[serde(default)]
    pub auto_layer_tiles: Vec<TileInstance>,
    #[serde(default)]
    pub entity_instances: Vec<Entity>,
}

fn one() -> f32 {
    1.0
}

fn yes() -> bool {
    true
}

#[derive(Deserialize)]
pub(super) struct TileInstance {
    /// The upper left corner, px of the layer.
    pub px: [i32; 2],
    /// The number of the tile.
    pub t: u32,
    /// Flips: 1 is horizontal, 2 vertical.
    #[serde(default)]
    pub f: u32,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Entity {
    #[serde(rename = "__identifier", default)]
    pub identifier: String,
    #[serde(rename = "__pivot", default)]
    pub pivot: [f32; 2],
    /// The place of its pivot, px of the layer.
    pub px: [f32; 2],
    #[serde(default)]
    pub width: f32,
    #[serde(default)]
    pub height: f32,
    #[serde(default)]
    pub field_instances: Vec<Field>,
}

#[derive(Deserialize)]
pub(super) struct Field {
    #[serde(rename = "__identifier")]
    pub identifier: String,
    #[serde(rename = "__type", default)]
    pub kind: String,
    #[serde(rename = "__value", default)]
    pub value: Value,
}
