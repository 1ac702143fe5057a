//! Worlds from level editors: maps of [Tiled](https://www.mapeditor.org) and of [LDtk](https://ldtk.io).
//!
//! One px of a map is one cell. Tiles are painted as the picture under the light. Custom properties of layers and tiles
//! give how they act on light (`tile_matter.rs`), and objects are lamps and suns (`objects.rs`). A [`MapWorld`] is a file as
//! a [`WorldSource`](crate::world::WorldSource): maps and images are read when a window needs them, and a bounded number
//! of them is kept.
//!
//! A reader per format (`tiled/`, `ldtk/`) makes a `TileMap`, and `draw.rs` draws any of these.

mod draw;
mod ldtk;
mod map_file;
mod map_world;
mod objects;
mod properties;
mod tile_map;
mod tile_matter;
mod tiled;

pub use map_world::MapWorld;
