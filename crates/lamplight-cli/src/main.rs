//! The command `lamplight`: light scene files, compare methods, look at every stage.
//!
//! Results go to stdout, everything else to stderr. Exit codes: 0 done, 1 failed, 2 bad input or
//! usage, 130 stopped by Ctrl-C.

mod args;
mod commands;
mod contest;
mod failure;
mod frames;
mod gpu;
mod lighting;
mod output;
mod place;
mod progress;
mod report;
mod room;
mod sheet;
mod stage;
mod table;
mod text;

use clap::Parser;
use std::process::ExitCode;

fn main() -> ExitCode {
    output::clean_up_when_stopped();
    let cli = commands::Cli::parse();
    match commands::run(cli.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
