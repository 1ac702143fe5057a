//! The start of the window on a desktop, with options from the command line.

use crate::platform;
use crate::window::app::App;
use crate::window::script::Script;
use crate::window::start::{Start, check, device};
use anyhow::{Context as _, Result, anyhow};
use clap::Parser;
use eframe::egui::ViewportBuilder;
use eframe::egui_wgpu::WgpuConfiguration;
use lamplight_wgpu::Tier;
use std::path::{Path, PathBuf};

/// Paint with light, and play in worlds that are lit as they move
#[derive(Parser, Debug)]
#[command(version)]
struct Args {
    #[command(flatten)]
    start: Start,
    /// Play a script (`docs/sandbox.md`), then close
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
    /// Play a script, as --script does, and stay open
    #[arg(long, value_name = "FILE", conflicts_with = "script")]
    begin: Option<PathBuf>,
    /// Continue where another window was
    #[arg(long, hide = true)]
    continued: bool,
}

/// Opens the window and returns when it is closed.
pub fn run() -> Result<()> {
    let Args { start, script, begin, continued } = Args::parse();
    check(&start)?;
    let closes = script.is_some();
    let script = script.or(begin).map(|path| read_script(&path, closes)).transpose()?;
    platform::set_is_continued(continued);
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

fn read_script(path: &Path, closes: bool) -> Result<Script> {
    let text =
        std::fs::read_to_string(path).with_context(|| format!("cannot read {}", path.display()))?;
    Script::read(&text, closes).with_context(|| path.display().to_string())
}
