//! Asking the light: how lit a place is, for games' rules, without a picture and without a GPU.
//!
//! The CPU lights the same pieces of matter that cameras draw ([`crate::pieces`]), on a small grid,
//! in the frames after somebody asked. It sees what the picture shows but for its coarser cells:
//! the figures are in the README.

mod answer;
mod raster;

pub use answer::{LightQuery, LightQueryPlugin, LightQuerySettings};
