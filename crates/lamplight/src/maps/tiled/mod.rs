//! Maps of Tiled: `.tmx`, with their tilesets (`.tsx`) and templates (`.tx`), and worlds of them (`.world`).
//!
//! The format is <https://doc.mapeditor.org/en/stable/reference/tmx-map-format/>. Read are orthogonal maps, finite or
//! infinite, with tile layers in groups, tilesets of one image or of an image per tile, and objects that are lights.
//! Image layers, parallax and animations are left out: what is lit is the map as it lies.

mod layer_data;
mod layers;
mod lights;
mod tilesets;
mod tmx;
mod world_file;
mod xml;

pub(super) use tmx::read_map;
pub(super) use world_file::{WorldEntry, read_world};
