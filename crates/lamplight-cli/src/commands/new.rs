//! `lamplight new`: a commented scene to start from.

use crate::failure::{Failure, Outcome};
use crate::output;
use std::path::PathBuf;

/// What `lamplight new` writes.
const STARTER: &str = include_str!("../starter.toml");

/// Write a commented scene to start from
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The file to write; ends in .toml
    file: PathBuf,
    /// Write over a file that is there already
    #[arg(long)]
    force: bool,
}

pub fn run(args: Args) -> Outcome {
    let shown = args.file.display();
    if args.file.extension().is_none_or(|ending| ending != "toml") {
        return Err(Failure::bad_input(format_args!("a new scene is a .toml file, not {shown}"))
            .hint(format_args!(
                "try `lamplight new {}`",
                args.file.with_extension("toml").display()
            )));
    }
    output::check_file(&args.file)?;
    if args.file.exists() && !args.force {
        return Err(Failure::bad_input(format_args!("{shown} is there already"))
            .hint("--force writes over it"));
    }
    output::write(&args.file, STARTER.as_bytes())?;
    output::print(format_args!("wrote {shown}; light it with `lamplight render {shown}`"))
}
