//! Filters over the noisy light of one frame: the mean over frames, and an edge-aware blur.

pub mod denoise;
pub mod estimate;
pub mod temporal;
