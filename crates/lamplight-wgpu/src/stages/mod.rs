//! What methods share: each stage with its pipelines, buffers and runs over a grid.

pub mod clearance;
pub mod fields;
pub mod ground;
pub mod optics;
pub mod output;
pub mod walls;
