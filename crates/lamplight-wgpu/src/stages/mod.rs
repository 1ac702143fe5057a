//! The stages that methods share: each with its pipelines, buffers and dispatches over a grid.

pub mod bounce;
pub mod class;
pub mod compare;
pub mod convergence;
pub mod denoise;
pub mod direct;
pub mod display;
pub mod distance;
pub mod empty_space;
pub mod feedback;
pub mod glow;
pub mod gradient_moment;
pub mod invalidate;
pub mod jump_flood;
pub mod matter_values;
pub mod medium_grid;
pub mod output;
pub mod packet;
pub mod reproject;
pub mod seed;
pub mod sight;
pub mod temporal;
pub mod walls;
