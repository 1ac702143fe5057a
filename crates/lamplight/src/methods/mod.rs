//! The ways to the same light, each chosen by name.

pub mod flood;
pub mod polar;
pub mod raymarch;
