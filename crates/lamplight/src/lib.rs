//! Lamplight: 2D global illumination on a grid of cells.
//!
//! What goes in: [`Cells`] that emit, absorb, tint and reflect, written by hand or made from a
//! [`Scene`]. What comes out: [`Light`], the mean radiance arriving at every cell, in linear RGB.
//! Between them stands a [`Solver`], which runs one of the [`Method`]s and keeps its buffers
//! between frames.
//!
//! All lengths are in cells ("px"): x to the right, y down, the centre of cell (i, j) at
//! (i + ½, j + ½). All light is linear RGB; sRGB is decoded on the way in and encoded on the way
//! out, once.

pub mod cells;
mod check;
mod clock;
pub mod coarse;
pub mod error;
mod exact;
mod explain;
pub mod frame;
pub mod inside;
pub mod lamp;
mod lamp_gain;
pub mod light;
pub mod methods;
pub mod scene;
pub mod settings;
pub mod sky;
pub mod srgb;
pub mod stages;
pub mod views;

pub use cells::{Cells, Matter, Rgb};
pub use error::{Error, Result};
pub use frame::Solver;
/// The crate of the pictures that [`Light::compose`] returns.
pub use image;
pub use lamp::{Cone, Falloff, Lamp};
pub use light::Light;
pub use scene::{Scene, Shape};
pub use settings::{Bounces, Method, Settings, SettingsTable};
pub use sky::{Gradient, Sky};
pub use stages::display::{Display, ToneMap};

/// The README's example is compiled and run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
