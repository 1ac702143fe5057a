//! What methods share: each stage with its pipelines, buffers and runs over a grid.

pub mod carry;
pub mod changes;
pub mod clearance;
pub mod compare;
pub mod convergence;
pub mod denoise;
pub mod display;
pub mod feedback;
pub mod fields;
pub mod ground;
pub mod optics;
pub mod output;
pub mod packet;
pub mod temporal;
pub mod walls;
