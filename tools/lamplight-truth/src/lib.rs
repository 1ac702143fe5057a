//! The reference that lamplight's methods are compared with, and measures of their errors.
//!
//! - [`PathTracer`] computes the light of a grid straight from the definitions, with its own
//!   standard error for every cell; [`Tracing`] does so part by part, for several machines, and
//!   [`ProgressiveReference`] pass by pass, for display.
//! - [`closed_forms`] has scenes whose light is known in closed form.
//! - [`Measures`], [`mod@grain`] and [`mod@flip`] measure the error of light and of pictures.
//! - [`scenes`] has random scenes of the kinds on which methods are compared.
//!
//! No tracing code is shared with the methods, so that no mistake of theirs can hide here.

pub mod closed_forms;
pub mod flip;
pub mod grain;
pub mod heat;
mod lamps;
mod measures;
mod parts;
mod path_tracer;
mod progressive;
mod random;
pub mod scenes;
mod sky;
mod traverse;

pub use measures::Measures;
pub use parts::{Received, Tracing};
pub use path_tracer::{Estimate, PathTracer};
pub use progressive::ProgressiveReference;
