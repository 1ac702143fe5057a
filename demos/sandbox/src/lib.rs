//! Worlds to play with and a canvas to paint on, lit by [`lamplight`]; without a window.
//!
//! A [`worlds::World`] advances in fixed steps and draws itself into [`lamplight::Cells`]. A
//! [`clock::Clock`] converts seconds to steps. Brushes and tools paint on a [`canvas::Canvas`] at given
//! coordinates. The caller lights the cells on the CPU or the GPU with the settings of a
//! [`look::Look`].
//!
//! The library uses neither clocks, files nor threads, so it also runs in a browser. The same seed and
//! input give the same cells in every run and at any frame rate.

pub mod canvas;
pub mod clock;
mod figure;
pub mod look;
pub mod pace;
pub mod paint;
mod random;
mod texture;
pub mod worlds;
