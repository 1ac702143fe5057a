//! The steps that methods share, each with one stem across CPU, GPU, shaders, tests and docs.

pub mod display;
pub mod noise;
pub mod walls;
