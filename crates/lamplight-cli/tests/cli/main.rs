//! The command `lamplight`, from the outside.

mod bad_input;
mod bake;
mod commands;
mod files;
mod hints;
mod maps;
mod memory;
mod on_the_gpu;
mod render;
mod sandbox;
mod warnings;
