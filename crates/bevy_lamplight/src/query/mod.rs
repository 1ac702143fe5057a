//! Queries of light and sight for game rules, which need neither a picture nor a GPU.
//!
//! The CPU lights the same quads that cameras draw ([`crate::quads`]) on a coarse grid, at the end of
//! each frame in which light was queried. The README states how far the answers are from the picture.

mod answer;
mod entering;
mod sight;

pub use answer::{LightQuery, LightQueryPlugin, LightQuerySettings};
pub use sight::SightQuery;
