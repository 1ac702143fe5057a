//! The files that code makes and the repository keeps: `cargo xtask scenes | noise | schema | docs`.

mod docs;
mod frontier;
mod generated;
mod lone_lamps;
mod noise;
mod random;
mod relief;
mod scenes;
mod schema;
mod tradeoff;

use anyhow::{Context, Result};
use clap::{Parser, Subcommand, ValueEnum};
use generated::Mode;
use std::fmt::Display;
use std::io::{self, ErrorKind, Write};
use std::process::ExitCode;

#[derive(Parser)]
#[command(name = "lamplight-generate", about = "The files that code makes.")]
struct Args {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Draw the example scenes.
    Scenes(Generate),
    /// Make the blue-noise texture.
    Noise(Generate),
    /// Write the JSON Schema of scene files, and the table of materials.
    Schema(Generate),
    /// Make the pictures and measure the figures in the documents; needs the command line, built with
    /// `--release`.
    Docs {
        /// Only this part.
        #[arg(long)]
        only: Option<docs::Part>,
    },
    /// Print every shader as JSON, by its name.
    Shaders,
}

#[derive(clap::Args)]
struct Generate {
    /// Write nothing; fail if what is in the repository differs from what would be written.
    #[arg(long)]
    check: bool,
}

impl Generate {
    fn mode(&self) -> Mode {
        if self.check { Mode::Check } else { Mode::Write }
    }
}

fn main() -> ExitCode {
    match run(Args::parse().chore) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(chore: Chore) -> Result<()> {
    match chore {
        Chore::Scenes(args) => scenes::run(args.mode()),
        Chore::Noise(args) => noise::run(args.mode()),
        Chore::Schema(args) => schema::run(args.mode()),
        Chore::Docs { only: Some(part) } => docs::run(part),
        Chore::Docs { only: None } => {
            docs::Part::value_variants().iter().copied().try_for_each(docs::run)
        }
        Chore::Shaders => {
            let shaders = lamplight_wgpu::shaders().map(|(name, text)| (name, text.into()));
            let shaders: serde_json::Map<_, _> =
                shaders.map(|(name, text)| (name.to_owned(), text)).collect();
            print(serde_json::Value::from(shaders))
        }
    }
}

/// Prints a line of results. A reader that has left, as `head` does, wants no more of them: that is no error.
fn print(text: impl Display) -> Result<()> {
    let mut out = io::stdout().lock();
    match writeln!(out, "{text}").and_then(|()| out.flush()) {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        printed => printed.context("cannot write to stdout"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_blue_noise_is_up_to_date() {
        noise::run(Mode::Check).unwrap();
    }

    #[test]
    fn the_scenes_are_up_to_date() {
        scenes::run(Mode::Check).unwrap();
    }

    #[test]
    fn the_schema_is_up_to_date() {
        schema::run(Mode::Check).unwrap();
    }
}
