//! The application window: contents and input.

pub mod app;
mod benchmark;
mod files;
mod folded;
mod fonts;
mod former;
mod gpu_loss;
mod halves;
mod inspect;
pub mod light;
mod panels;
mod probe;
mod relief;
mod resolution;
mod saving;
pub mod script;
pub mod start;
mod subject;
mod view;
