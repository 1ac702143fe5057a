//! The panels around the picture.

pub mod settings;
pub mod timings;
pub mod tools;
pub mod view;
