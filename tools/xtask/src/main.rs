//! The project's chores: `cargo xtask CHORE`.

mod apt;
mod args;
mod browser;
mod display;
mod docs;
#[cfg(test)]
mod glossary;
mod gpu;
mod lint;
mod optional;
mod process;
mod publish;
mod python;
mod readme;
mod steps;
mod test;
mod web;

use anyhow::Result;
use args::{Chore, Only};
use std::process::ExitCode;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<()> {
    match args::parse(std::env::args_os().skip(1))? {
        Chore::Help => {
            print!("{}", args::HELP);
            Ok(())
        }
        Chore::Test { only: Only::Lints, .. } => test::lints(),
        Chore::Test { only: Only::Python, .. } => test::python(),
        Chore::Test { only: Only::Web, .. } => test::web(),
        Chore::Test { all, gpu, .. } => test::run(all, gpu),
        Chore::Lint { baseline, list } => lint::run(baseline, list),
        Chore::Web { bevy, serve } => {
            let page = if bevy { &web::BEVY } else { &web::SANDBOX };
            web::run(page, serve)
        }
        Chore::Docs(part) => docs::run(part),
        Chore::Generate { what, check } => {
            let arguments = if check { vec![what, "--check"] } else { vec![what] };
            process::tool("lamplight-generate", &arguments)
        }
    }
}
