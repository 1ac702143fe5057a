//! Lamplight: 2D global illumination on a grid of cells.
//!
//! The input is a grid of [`Cells`] that emit, absorb, tint and reflect, filled by hand or drawn from
//! a [`Scene`]. The output is [`Light`]: the mean radiance at every cell, in linear RGB. A [`Solver`]
//! computes it with one [`Method`], chosen by [`Settings`], and keeps its buffers between frames.
//!
//! All lengths are in cells ("px"): x to the right, y down, the centre of cell (i, j) at
//! (i + ½, j + ½). All light is linear RGB; sRGB is decoded on the way in and encoded on the way
//! out, once.

mod cells;
mod check;
mod clock;
mod cookie;
pub mod debug_views;
mod elevation;
mod error;
mod exact;
mod explain;
mod far_field;
mod filters;
mod grid;
mod inflow;
#[doc(hidden)]
pub mod internals;
mod json;
mod keyed;
mod lamp;
mod lamp_discs;
mod lamp_inflow;
mod light;
mod limits;
pub mod maps;
mod mask;
mod math;
mod methods;
mod moment;
mod notation;
mod panorama;
mod profile;
mod recent;
mod relief;
pub mod resample;
mod rgb;
pub mod scene;
pub mod settings;
mod sight;
mod simd;
mod sky;
mod solver;
mod source_normalization;
pub mod srgb;
mod stages;
mod sun;
mod sun_glow;
pub mod surroundings;
mod tiling;
pub mod world;

pub use cells::{Cells, Matter};
pub use cookie::{Cookie, CookiePicture, CookiePixels};
pub use error::{Error, Result};
pub use inflow::{BorderPlace, GridWindow, Inflow};
pub use lamp::{Cone, Direct, Falloff, Lamp};
pub use light::Light;
pub use mask::ALL_LAYERS;
pub use moment::Moment;
pub use panorama::Panorama;
pub use profile::Profile;
pub use relief::{Normal, Relief, UP, normal_of_slope};
pub use rgb::Rgb;
pub use scene::{Scene, Shape};
pub use settings::{Bounces, Method, Quality, Settings, SettingsTable};
pub use sight::Sight;
pub use sky::{Gradient, Sky};
pub use solver::{Solver, Stages};
pub use stages::display::{Display, ToneMap};
pub use stages::sight::SightSolver;
pub use sun::Sun;

/// The crate of the pictures that [`Light::compose`] returns.
pub use image;

/// Compiles and runs the README's example with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
