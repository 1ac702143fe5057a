//! The command `lamplight`, as the package's script calls it.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the command `lamplight`, and returns its exit code. From then on Ctrl-C ends the process.
#[pyfunction]
pub fn run_command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| lamplight_cli::run(arguments))
}
