//! The GPU held to the CPU, stage by stage and frame by frame, and to what it may cost.

#[path = "../common/mod.rs"]
mod common;

mod bounces;
mod cascades;
mod compare;
mod cost;
mod denoise;
mod direct;
mod flood;
mod frames;
mod glow;
mod holographic;
mod inflow;
mod lamps;
mod moments;
mod polar;
mod raymarch;
mod sight;
mod sky;
mod stages;
mod temporal;
mod walls;
