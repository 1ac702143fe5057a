//! The ways to the same light, each chosen by name.

pub mod holographic;
pub mod raymarch;
