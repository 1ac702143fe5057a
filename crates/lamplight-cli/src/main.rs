//! The command `lamplight`: light scene files, compare methods, look at every stage.
//!
//! Results go to stdout, everything else to stderr. Exit codes: 0 done, 1 failed, 2 bad input or
//! usage; 130, 143 and 129 after Ctrl-C, SIGTERM and SIGHUP.
//!
//! A command resolves its arguments first ([`job`]), then runs, then writes ([`output`]).

mod args;
mod available_memory;
mod bench_scene;
mod commands;
mod comparison;
mod contact_sheet;
mod device_info;
mod error;
mod frames;
mod gpu;
mod job;
mod lit;
mod memory;
mod output;
mod progress;
mod report;
mod signals;
mod solve;
mod stage;
mod stderr;
mod table;
mod text;
mod usage;
mod warnings;

use std::process::ExitCode;

fn main() -> ExitCode {
    signals::handle_termination();
    match usage::parse().and_then(|cli| commands::run(cli.command)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => error.report(),
    }
}
