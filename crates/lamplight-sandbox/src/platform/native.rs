//! A window on a desktop: the command line says how it begins, files go into the folder at hand.

use super::File;
use crate::window::{App, CELLS, Script, Start, check, device};
use anyhow::{Context as _, Result, anyhow};
use clap::Parser;
use eframe::egui::{Context, ViewportBuilder, ViewportCommand};
use eframe::egui_wgpu::WgpuConfiguration;
use lamplight_wgpu::Tier;
use std::path::{Path, PathBuf};

/// Cells to begin with where light is found on the CPU.
pub const CELLS_ON_CPU: [u32; 2] = CELLS;

/// Paint with light, and play in worlds that are lit as they move
#[derive(Parser, Debug)]
#[command(version)]
struct Args {
    #[command(flatten)]
    start: Start,
    /// Play what a file says instead of waiting for a person (`docs/sandbox.md`), then close
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
}

/// Opens the window; comes back when it is closed.
pub fn run() -> Result<()> {
    let Args { start, script } = Args::parse();
    check(&start)?;
    let script = script.as_deref().map(read_script).transpose()?;
    let options = eframe::NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title("lamplight sandbox")
            .with_inner_size([1480.0, 810.0])
            .with_min_inner_size([480.0, 320.0]),
        wgpu_options: WgpuConfiguration {
            wgpu_setup: device(Tier::Native),
            ..WgpuConfiguration::default()
        },
        ..eframe::NativeOptions::default()
    };
    let begin =
        move |context: &eframe::CreationContext| -> eframe::Result<Box<dyn eframe::App>, _> {
            Ok(Box::new(App::new(context, &start, script)?) as Box<dyn eframe::App>)
        };
    eframe::run_native("lamplight-sandbox", options, Box::new(begin))
        .map_err(|e| anyhow!("{e}"))
        .context("the window cannot be opened")
}

fn read_script(path: &Path) -> Result<Script> {
    let text =
        std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    Script::read(&text).with_context(|| path.display().to_string())
}

/// Writes files, and says where they are.
pub fn save(files: &[File]) -> Result<String> {
    for (name, bytes) in files {
        std::fs::write(name, bytes).with_context(|| format!("cannot write {name}"))?;
    }
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let folder = std::env::current_dir()
        .map_or_else(|_| "this folder".to_owned(), |at| at.display().to_string());
    Ok(format!("saved {} in {folder}", names.join(", ")))
}

/// Says a word to who watches a script.
pub fn say(word: &str) {
    println!("{word}");
}

/// The script that comes after the first one: there is none.
pub fn next_script() -> Option<String> {
    None
}

/// What follows when a script is over.
pub fn script_is_over(context: &Context) {
    context.send_viewport_cmd(ViewportCommand::Close);
}
