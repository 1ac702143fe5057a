//! Programs that a step needs and that Rust does not bring: a step without its program is left out, and
//! a line tells how to get it.

use crate::process::{command, root, succeeds};
use std::process::Command;

/// Returns true if the toolchain has a component.
pub fn has_component(subcommand: &str, component: &str) -> bool {
    let found = succeeds(command(root()).args([subcommand, "--version"]));
    note(found, component, &format!("rustup component add {component}"))
}

/// Returns true if a subcommand of Cargo is installed.
pub fn has_subcommand(name: &str) -> bool {
    let found = succeeds(command(root()).args([name, "--version"]));
    note(found, &format!("cargo-{name}"), &format!("cargo install --locked cargo-{name}"))
}

/// Returns true if a program is on `PATH`.
pub fn has_program(name: &str, advice: &str) -> bool {
    note(succeeds(Command::new(name).arg("--version")), name, advice)
}

fn note(found: bool, name: &str, advice: &str) -> bool {
    if !found {
        println!("== {name} is missing, its step is left out; to get it: {advice}");
    }
    found
}
