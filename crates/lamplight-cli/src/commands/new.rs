//! `lamplight new`: a commented scene to start from.

use crate::error::{CliError, Result};
use crate::output::{self, OutputFiles};
use std::path::PathBuf;

/// The scene that `lamplight new` writes.
const STARTER: &str = include_str!("../starter.toml");

/// Write a commented scene to start from
#[derive(clap::Args, Debug)]
pub struct NewArgs {
    /// The file to write, a .toml
    file: PathBuf,
    /// Replace a file that exists
    #[arg(long)]
    force: bool,
}

pub fn run(args: NewArgs) -> Result {
    let shown = args.file.display();
    if args.file.as_os_str() == "-" {
        return Err(CliError::bad_input("a new scene is a .toml file, not -")
            .hint("try `lamplight new scene.toml`"));
    }
    if args.file.extension().is_none_or(|ending| ending != "toml") {
        return Err(CliError::bad_input(format_args!("a new scene is a .toml file, not {shown}"))
            .hint(format_args!(
                "try `lamplight new {}`",
                args.file.with_extension("toml").display()
            )));
    }
    let outputs = OutputFiles::default();
    outputs.check(&args.file)?;
    if args.file.exists() && !args.force {
        return Err(
            CliError::bad_input(format_args!("{shown} exists already")).hint("--force replaces it")
        );
    }
    outputs.write(&args.file, STARTER.as_bytes())?;
    output::print(format_args!("wrote {shown}; light it with `lamplight render {shown}`"))
}
