//! Worlds to play with and a canvas to paint on, lit by [`lamplight`]; without a window.
//!
//! A [`worlds::World`] moves on by fixed steps and draws itself into [`lamplight::Cells`]; a
//! [`clock::Clock`] turns seconds into steps. A [`canvas::Canvas`] is painted by brushes and tools
//! at stated coordinates. Whoever shows them lights the cells, on the CPU or the GPU, by the
//! [`look::Look`] that each asks for.
//!
//! Nothing here knows the time, files or threads: seconds and bytes come in, cells and bytes go
//! out, so that it runs in a browser too. The same seed and input give the same cells, run after run
//! and at any frame rate.

pub mod canvas;
pub mod clock;
pub mod look;
pub mod pace;
pub mod paint;
mod random;
mod texture;
pub mod worlds;
