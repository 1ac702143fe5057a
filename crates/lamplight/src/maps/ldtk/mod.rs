//! Projects of LDtk: `.ldtk`, with levels inside or in files of their own (`.ldtkl`).
//!
//! The format is <https://ldtk.io/json/>; of its fields, `json.rs` has those that light needs. All levels of depth 0 are a
//! world, those of the first world if there are several. Background images of levels are left out.
//!
//! LDtk has no custom properties of layers and of values of an IntGrid. `notes.rs` has where they are written instead.

mod json;
mod level;
mod notes;
mod project;

pub(super) use project::{LevelMap, PlacedLevel, Project, read_project};
