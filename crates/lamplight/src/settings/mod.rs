//! Every setting, with its default, its range, and the cost of higher and lower values.
//!
//! A [`Settings`] holds one method with its own settings ([`MethodSettings`]), and the few settings
//! that all methods share.
//!
//! In files and flags, settings come in layers: the defaults, the scene file's `[light]`, the flags.
//! Each layer is a [`SettingsTable`], which may have tables of several methods.
//! [`SettingsTable::merge`] lays one layer over another. [`SettingsTable::resolve`] expands presets,
//! rejects unknown keys and values out of range, and returns typed [`Settings`].

mod bounces;
mod cascades;
mod declare;
mod file;
mod filters;
mod flood;
mod holographic;
mod method;
mod polar;
mod preset;
mod quality;
mod range;
mod raymarch;
mod solver;
mod table;

pub use bounces::Bounces;
pub use cascades::{Cascades, Merge};
pub use filters::{Denoise, Temporal};
pub use flood::{Fade, Flood, Sweeps};
pub use holographic::{Holographic, Variant};
pub use method::{Method, MethodSettings};
pub use polar::{Blend, Polar, ShadowFilter, Traversal};
pub use quality::Quality;
pub use raymarch::{Hit, Noise, Raymarch, Spacing};
pub use solver::Settings;
pub use table::SettingsTable;
