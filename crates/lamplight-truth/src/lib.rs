//! What is right: the judge of lamplight's methods.
//!
//! - [`PathTracer`] computes the light of a grid straight from the definitions, with its own
//!   standard error for every cell; [`Refining`] does so pass by pass, for who looks on.
//! - [`closed_forms`] are scenes whose light can be written down.
//! - [`Measures`] and [`flip`] say how far a light, or a picture, is from the right one.
//! - [`scenes`] are drawn by chance, of the kinds on which methods are judged.
//!
//! Nothing here shares tracing code with the methods: a mistake in theirs cannot hide in ours.

pub mod closed_forms;
pub mod flip;
pub mod heat;
mod measures;
mod path_tracer;
pub mod random;
mod refining;
pub mod scenes;
mod traverse;

pub use measures::Measures;
pub use path_tracer::{Estimate, PathTracer};
pub use refining::Refining;
