//! The command `lamplight`: light scene files, compare methods, look at every stage.
//!
//! [`run`] is all of it, for programs that contain it, such as the package for Python.
//!
//! Results go to stdout, everything else to stderr. Exit codes: 0 done, 1 failed, 2 bad input or
//! usage; 130, 143 and 129 after Ctrl-C, SIGTERM and SIGHUP.
//!
//! A command resolves its arguments first (`job`), then runs, then writes (`output`).

// What reports have to say of GPUs is not reached without one.
#![cfg_attr(not(feature = "gpu"), allow(dead_code))]

mod args;
mod available_memory;
mod bench_scene;
mod commands;
mod comparison;
mod contact_sheet;
mod device_info;
mod error;
mod frame_cost;
mod frames;
#[cfg(feature = "gpu")]
mod gpu;
mod input;
mod job;
mod json;
mod lit;
mod memory;
#[cfg(not(feature = "gpu"))]
mod no_gpu;
mod output;
#[doc(hidden)]
pub mod plot;
mod progress;
mod report;
mod signals;
mod solve;
mod stage;
#[cfg(feature = "gpu")]
mod stderr;
mod table;
mod text;
mod usage;
mod warnings;

#[cfg(not(feature = "gpu"))]
use no_gpu as gpu;
use std::ffi::OsString;

/// Runs the command: the program's name, then its arguments. Returns the exit code.
///
/// It is for a process that does nothing else: Ctrl-C, SIGTERM and SIGHUP end that from here on.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    signals::handle_termination();
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    match usage::parse(&arguments).and_then(|cli| commands::run(cli.command)) {
        Ok(()) => 0,
        Err(error) => error.report(),
    }
}
