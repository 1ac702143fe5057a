//! The grid as rays read it, and its traversals.
//!
//! [`medium_grid`] turns [`crate::Cells`] into classes, extinction and emitted radiance per cell.
//! [`traverse`] visits the cells along a ray, and states the corner rule that all rays obey.
//! [`cast`] follows rays to the first solid cell, one alone or sixteen from one point.
//! [`packet`] takes sixteen rays through [`empty_space`] at once. [`center_line`] orders the cells
//! between two cell centers in whole numbers.

pub(crate) mod cast;
pub mod center_line;
pub mod class;
pub mod empty_space;
pub(crate) mod medium_grid;
pub(crate) mod packet;
pub(crate) mod traverse;
