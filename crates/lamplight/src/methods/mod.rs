//! The methods, each selected by its name.

pub mod cascades;
pub mod flood;
pub mod holographic;
pub mod polar;
pub mod raymarch;

#[cfg(all(test, target_arch = "x86_64"))]
mod vector_units;
