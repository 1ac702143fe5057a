//! Frame times of `bevy_lamplight` and of the other 2D light plugins published for the same release of
//! Bevy, side by side: against the number of lamps, and against the number of occluders.
//!
//! Every plugin and scene has a process of its own (`worker.rs`), which draws a frame when it is asked
//! to (`headless.rs`); `race.rs` asks them in turns.

mod contender;
mod headless;
mod race;
mod report;
mod scene;
mod stage;
mod worker;

use anyhow::{Context, Result};
use clap::{Parser, Subcommand, ValueEnum};
use contender::Contender;
use race::{Counts, Race};
use report::{Column, Report, Table};
use std::path::PathBuf;

/// Lamps while occluders are counted, and the other way round.
const FEW_LAMPS: u32 = 4;
const FEW_OCCLUDERS: u32 = 10;

/// Compares the frame times of 2D light plugins for Bevy
#[derive(Parser)]
struct Args {
    /// Write the document here instead of printing it
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// JSON with every frame, instead of Markdown
    #[arg(long)]
    json: bool,
    /// Frames measured of each plugin in each scene, where there is time
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u8).range(1..))]
    frames: u8,
    /// Numbers of lamps and of occluders
    // With many more occluders no ground is left for lamps to stand on.
    #[arg(long, value_delimiter = ',', default_values_t = [10, 100, 1000, 10_000],
          value_parser = clap::value_parser!(u32).range(..=20_000))]
    counts: Vec<u32>,
    /// Compare only these
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = Contender::value_variants().to_vec())]
    only: Vec<Contender>,
    /// Write what each plugin draws of each scene into this folder
    #[arg(long, value_name = "FOLDER")]
    pictures: Option<PathBuf>,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Subcommand)]
enum Command {
    /// One contender and one scene: what the others are made of
    #[command(hide = true)]
    Work(worker::Job),
}

/// Measures, or works for one that does.
fn main() -> Result<()> {
    let args = Args::parse();
    if let Some(Command::Work(job)) = &args.command {
        return worker::work(job);
    }
    if let Some(folder) = &args.pictures {
        std::fs::create_dir_all(folder).with_context(|| format!("making {}", folder.display()))?;
    }
    let frames = usize::from(args.frames);
    let race = Race { contenders: args.only, frames, pictures: args.pictures };
    let mut adapter = None;
    let mut table = |counts: &dyn Fn(u32) -> Counts| -> Result<Table> {
        let mut columns = Vec::new();
        for &count in &args.counts {
            let counts = counts(count);
            eprintln!("{} lamps, {} occluders", counts.lamps, counts.occluders);
            columns.push(Column { counts, entries: race.run(counts, &mut adapter)? });
        }
        Ok(Table(columns))
    };
    let lamps = table(&|lamps| Counts { lamps, occluders: FEW_OCCLUDERS })?;
    let occluders = table(&|occluders| Counts { lamps: FEW_LAMPS, occluders })?;
    let report = Report {
        bevy: Report::bevy(),
        adapter: adapter.context("no plugin could draw anything")?,
        threads: std::thread::available_parallelism()?.get(),
        target: scene::VIEW,
        frames,
        lamps,
        occluders,
    };
    let text =
        if args.json { serde_json::to_string_pretty(&report)? + "\n" } else { report.markdown() };
    match &args.output {
        Some(file) => {
            std::fs::write(file, text).with_context(|| format!("writing {}", file.display()))
        }
        None => {
            print!("{text}");
            Ok(())
        }
    }
}
