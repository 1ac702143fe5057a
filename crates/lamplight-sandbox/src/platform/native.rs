//! A window on a desktop: the command line says how it begins, files go into the folder at hand.

use super::File;
use crate::window::anew::Anew;
use crate::window::{App, CELLS, Script, Start, check, device, words};
use anyhow::{Context as _, Result, anyhow, bail};
use clap::Parser;
use eframe::egui::ViewportBuilder;
use eframe::egui_wgpu::WgpuConfiguration;
use lamplight_wgpu::Tier;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

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
    /// Do what a file says, as --script does, and stay open
    #[arg(long, value_name = "FILE", conflicts_with = "script")]
    begin: Option<PathBuf>,
    /// This window goes on where another one was
    #[arg(long, hide = true)]
    anew: bool,
}

/// The flag of a window that goes on for another.
const ANEW: &str = "--anew";
/// A GPU that is lost sooner than this after a window went on for another is not coming back.
const SOON: Duration = Duration::from_secs(10);

/// When this window was opened, where it goes on for another.
static BEGUN: OnceLock<Option<Instant>> = OnceLock::new();

/// Opens the window; comes back when it is closed.
pub fn run() -> Result<()> {
    let Args { start, script, begin, anew } = Args::parse();
    check(&start)?;
    let closes = script.is_some();
    let script = script.or(begin).map(|path| read_script(&path, closes)).transpose()?;
    // The first to say so is this.
    let _ = BEGUN.set(anew.then(Instant::now));
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

/// Opens another window, in another process, and ends this one: it cannot be drawn any more. Where no other
/// one can be opened, a canvas is saved here, and what went wrong is said.
pub fn go_on_anew(anew: &Anew, closes: bool) -> Result<()> {
    let Err(why) = open_another(anew, closes) else { std::process::exit(0) };
    eprintln!("error: the GPU was lost, and no other window can be opened: {}", words(&why));
    if !anew.files.is_empty() {
        match save(&anew.files) {
            Ok(said) => eprintln!("what was painted: {said}"),
            Err(why) => eprintln!("what was painted is lost: {}", words(&why)),
        }
    }
    std::process::exit(1)
}

/// An error too where this window was opened so itself a moment ago: the GPU is not coming back.
fn open_another(anew: &Anew, closes: bool) -> Result<()> {
    if BEGUN.get().copied().flatten().is_some_and(|begun| begun.elapsed() < SOON) {
        bail!("it was lost again and again");
    }
    let folder = std::env::temp_dir().join(format!("lamplight-sandbox-{}", std::process::id()));
    std::fs::create_dir_all(&folder)
        .with_context(|| format!("cannot make {}", folder.display()))?;
    let put = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).with_context(|| format!("cannot write {}", path.display()))?;
        Ok::<_, anyhow::Error>(path)
    };
    let paths: Vec<PathBuf> =
        anew.files.iter().map(|(name, bytes)| put(name, bytes)).collect::<Result<_>>()?;
    let opened = paths.first().map(|scene| format!("drop {}\n", scene.display()));
    let script = opened.unwrap_or_default() + &anew.lines.join("\n");
    let script = put("script.txt", script.as_bytes())?;
    let mut window = Command::new(std::env::current_exe()?);
    window.args(&anew.arguments).arg(ANEW);
    window.arg(if closes { "--script" } else { "--begin" }).arg(script);
    window.spawn()?;
    Ok(())
}

/// Says a word to who watches a script.
pub fn say(word: &str) {
    println!("{word}");
}

/// The script that comes after the first one: there is none.
pub fn next_script() -> Option<String> {
    None
}
