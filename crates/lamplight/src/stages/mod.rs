//! The stages of a frame that methods share, each with one stem across CPU, GPU, shaders, tests and
//! docs.

pub mod bounce;
pub mod direct;
pub mod display;
pub mod distance;
pub mod faces;
pub mod glow;
pub mod gradient_moment;
pub mod jump_flood;
pub mod pyramid;
pub mod seed;
pub mod sight;
pub mod walls;
