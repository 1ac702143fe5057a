//! The ways to the same light, each chosen by name.

pub mod cascades;
pub mod holographic;
pub mod raymarch;
