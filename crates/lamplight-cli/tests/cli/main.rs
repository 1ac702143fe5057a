//! The command `lamplight`, from the outside.

mod bad_input;
mod commands;
mod files;
mod render;
mod sandbox;
