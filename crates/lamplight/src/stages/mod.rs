//! The steps that methods share, each with one stem across CPU, GPU, shaders, tests and docs.

pub mod bounce;
pub mod circle;
pub mod clearance;
pub mod denoise;
pub mod display;
pub mod distance;
pub mod ground;
pub mod jump_flood;
pub mod noise;
pub(crate) mod optics;
pub(crate) mod packet;
pub mod seed;
pub mod temporal;
pub mod traced;
pub mod transmittance;
pub mod walls;
