//! The GPU held to the CPU, stage by stage and frame by frame.

#[path = "../common/mod.rs"]
mod common;

mod compare;
mod holographic;
mod raymarch;
mod stages;
