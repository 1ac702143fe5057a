//! The project's own chores: `cargo xtask <chore>`.

mod apt;
mod browser;
mod display;
mod docs;
mod frontier;
mod generated;
mod gpu;
mod noise;
mod random;
mod scenes;
mod schema;
mod serve;
mod test;
mod web;

use anyhow::Result;
use clap::{Parser, Subcommand};
use generated::Mode;
use std::process::ExitCode;

#[derive(Parser)]
#[command(name = "cargo xtask", about = "The project's own chores.")]
struct Args {
    #[command(subcommand)]
    chore: Chore,
}

#[derive(Subcommand)]
enum Chore {
    /// Everything CI checks: format, lints, tests, generated files, the README's commands.
    Test {
        /// Leave out the tests that need a GPU, a software one at least.
        #[arg(long)]
        without_gpu: bool,
        /// Instead of all that: build the web page, and use it in a browser.
        #[arg(long, conflicts_with = "without_gpu")]
        web: bool,
    },
    /// Build the sandbox as a web page, in `target/web/`.
    Web {
        /// Instead of it an example for Bevy.
        #[arg(long)]
        bevy: bool,
        /// Serve it to this machine, at this port.
        #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "8080")]
        serve: Option<u16>,
    },
    /// Draw the example scenes.
    Scenes(Generate),
    /// Make the pictures and measure the figures in the documents.
    Docs {
        /// Only the page on the GPU.
        #[arg(long)]
        gpu: bool,
        /// Only pictures of the sandbox.
        #[arg(long, conflicts_with = "gpu")]
        sandbox: bool,
        /// Only pictures of the examples for Bevy.
        #[arg(long, conflicts_with_all = ["gpu", "sandbox"])]
        bevy: bool,
    },
    /// Write the JSON Schema of scene files.
    Schema(Generate),
    /// Make the blue-noise texture.
    Noise(Generate),
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
        Chore::Test { web: true, .. } => test::web(),
        Chore::Test { without_gpu, .. } => test::run(!without_gpu),
        Chore::Web { bevy, serve } => {
            web::run(if bevy { &web::BEVY } else { &web::SANDBOX }, serve)
        }
        Chore::Docs { gpu: true, .. } => docs::gpu(),
        Chore::Docs { sandbox: true, .. } => docs::sandbox(),
        Chore::Docs { bevy: true, .. } => docs::bevy(),
        Chore::Docs { .. } => {
            docs::run()?;
            docs::gpu()?;
            docs::bevy()?;
            docs::sandbox()
        }
        Chore::Schema(args) => schema::run(args.mode()),
        Chore::Noise(args) => noise::run(args.mode()),
        Chore::Scenes(args) => scenes::run(args.mode()),
    }
}
