//! The stages of a frame that methods share, each with one stem across CPU, GPU, shaders, tests and
//! docs.

pub mod bounce;
pub mod display;
pub mod distance;
pub mod jump_flood;
pub mod seed;
pub mod walls;

/// Paths under which `lamplight-wgpu` imports these.
pub use crate::filters::{denoise, temporal};
pub use crate::grid::empty_space as clearance;
pub use crate::math::{circle, noise, transmittance};
