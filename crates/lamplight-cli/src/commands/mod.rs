//! The commands, one file each.

mod bake;
mod bench;
mod compare;
mod documents;
mod info;
mod new;
mod probe;
mod render;
mod sight;
mod stages;

use crate::error::Result;
use clap::{CommandFactory, Parser, Subcommand};

/// The first steps and the exit codes, as `lamplight --help` ends.
const AFTER_HELP: &str = "\
Start here:
  lamplight new cave.toml       write a commented scene
  lamplight render cave.toml    light it: cave.png

Exit codes: 0 done, 1 failed, 2 bad input or usage.";

/// Light 2D scenes: walls that emit, absorb, tint and reflect go in, lit pixels come out.
#[derive(Parser, Debug)]
#[command(name = "lamplight", version, max_term_width = 100, arg_required_else_help = true)]
#[command(after_help = AFTER_HELP)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Subcommand, Debug)]
pub enum Command {
    Render(render::RenderArgs),
    Compare(compare::CompareArgs),
    Bake(bake::BakeArgs),
    Stages(stages::StagesArgs),
    Probe(probe::ProbeArgs),
    Sight(sight::SightArgs),
    Bench(bench::BenchArgs),
    Info(info::InfoArgs),
    New(new::NewArgs),
    Completions(documents::CompletionsArgs),
    Man(documents::ManArgs),
    Schema(documents::SchemaArgs),
}

/// Runs a command.
pub fn run(command: Command) -> Result {
    match command {
        Command::Render(args) => render::run(args),
        Command::Compare(args) => compare::run(args),
        Command::Bake(args) => bake::run(args),
        Command::Stages(args) => stages::run(args),
        Command::Bench(args) => bench::run(args),
        Command::Probe(args) => probe::run(args),
        Command::Sight(args) => sight::run(args),
        Command::Info(args) => info::run(args),
        Command::New(args) => new::run(args),
        Command::Completions(args) => documents::completions(args, Cli::command()),
        Command::Man(args) => documents::man(args, Cli::command()),
        Command::Schema(args) => documents::schema(args),
    }
}
