//! The tests of the crate's public interface, in one program, which is linked once.
//!
//! Tests that count allocations have programs of their own.

#[path = "../common/mod.rs"]
mod common;

mod cascades;
mod cookie;
mod debug_views;
mod denoise;
mod direct;
mod draw;
mod feedback;
mod flood;
mod inflow;
mod invariants;
mod jump_flood;
mod lamp;
mod light;
mod maps_ldtk;
mod maps_tiled;
mod methods;
mod polar;
mod resample;
mod scene_coverage;
mod scene_file;
mod scene_fuzz;
mod scene_images;
mod scene_tiles;
mod settings;
mod sight;
mod sky;
mod smooth_motion;
mod surroundings;
mod temporal;
mod tightness;
mod tiling;
mod walls;
mod world;
