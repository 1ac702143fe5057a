//! `cargo xtask test`: everything CI checks, on a machine that has only Rust and git.

use crate::generated::{Mode, root};
use crate::{browser, display, gpu, noise, scenes, schema, web};
use anyhow::{Context, Result, bail, ensure};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

/// The README's first command, and the scene in it.
const FIRST_COMMAND: &str = "cargo run --release -- render scenes/cave.toml";
const SCENE: &str = "scenes/cave.toml";

/// Other plugins for Bevy, side by side with ours: with theirs, all of Bevy would be built again.
const BENCH: &str = "bevy_lamplight_bench";

/// What the names of tests that need a GPU begin with, outside of the crates that are the GPU's alone.
const ON_THE_GPU: &str = "on_the_gpu";

pub fn run(with_gpu: bool) -> Result<()> {
    let begin = Instant::now();
    if has_component("fmt", "rustfmt") {
        step("format", || cargo(&["fmt", "--all", "--check"]))?;
    }
    if has_component("clippy", "clippy") {
        let lints = ["clippy", "--workspace", "--exclude", BENCH, "--all-targets", "--quiet"];
        step("lints", || cargo(&[&lints[..], &["--", "-D", "warnings"]].concat()))?;
    }
    let mut tests = vec!["test", "--workspace", "--exclude", BENCH, "--quiet"];
    if with_gpu {
        step("a GPU", gpu::ensure)?;
        step("a display", display::ensure)?;
    } else {
        let of_the_gpu = ["lamplight-wgpu", "bevy_lamplight"];
        tests.extend(of_the_gpu.iter().flat_map(|package| ["--exclude", package]));
        tests.extend(["--", "--skip", ON_THE_GPU]);
    }
    step("tests", || cargo(&tests))?;
    step("generated files are up to date", || {
        noise::run(Mode::Check)?;
        scenes::run(Mode::Check)?;
        schema::run(Mode::Check)
    })?;
    step("the README's first command", first_command)?;
    println!("all passed in {:.1} s", begin.elapsed().as_secs_f64());
    Ok(())
}

/// The web page, in a browser.
pub fn web() -> Result<()> {
    let begin = Instant::now();
    step("lints of the pages", || {
        web::ensure_target()?;
        if has_component("clippy", "clippy") {
            for page in [&web::SANDBOX, &web::BEVY] {
                cargo(
                    &[&["clippy", "--quiet"], &page.program()[..], &["--", "-D", "warnings"]]
                        .concat(),
                )?;
            }
        }
        Ok(())
    })?;
    step("the page", || web::SANDBOX.build().map(|_| ()))?;
    step("the page in a browser", || browser::test(web::SANDBOX.folder()?))?;
    println!("all passed in {:.1} s", begin.elapsed().as_secs_f64());
    Ok(())
}

fn step(name: &str, work: impl FnOnce() -> Result<()>) -> Result<()> {
    println!("== {name}");
    let begin = Instant::now();
    work()
        .with_context(|| format!("{name}: failed after {:.1} s", begin.elapsed().as_secs_f64()))?;
    println!("== {name}: passed in {:.1} s", begin.elapsed().as_secs_f64());
    Ok(())
}

/// Cargo, to be run in a folder.
pub fn command(folder: &Path) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(folder);
    command
}

pub fn cargo(args: &[&str]) -> Result<()> {
    finish(command(root()).args(args))
}

fn finish(command: &mut Command) -> Result<()> {
    let status = command.status().context("cannot run cargo")?;
    ensure!(status.success(), "{command:?} ended with {status}");
    Ok(())
}

/// Whether the toolchain has a component; says how to get it where not.
fn has_component(subcommand: &str, component: &str) -> bool {
    let found = command(root())
        .args([subcommand, "--version"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success());
    if !found {
        println!(
            "== {component} is missing, its step is left out; to get it: rustup component add {component}"
        );
    }
    found
}

/// Lights the scene as a new user does, in an empty folder, and looks at what came out.
fn first_command() -> Result<()> {
    let readme = std::fs::read_to_string(root().join("README.md"))?;
    ensure!(readme.contains(FIRST_COMMAND), "README.md does not say `{FIRST_COMMAND}`");
    let folder = tempfile::tempdir()?;
    let mut render = command(folder.path());
    render.args(["run", "--release", "--quiet", "--manifest-path"]).arg(root().join("Cargo.toml"));
    finish(render.args(["--", "render"]).arg(root().join(SCENE)))?;
    let name = Path::new(SCENE).with_extension("png");
    let path = folder.path().join(name.file_name().context("the scene has a name")?);
    let picture =
        image::open(&path).with_context(|| format!("no picture at {}", path.display()))?;
    let bright = picture.to_luma8().pixels().filter(|p| p.0[0] > 32).count();
    let total = picture.width() as usize * picture.height() as usize;
    if bright * 10 < total {
        bail!("{} is black: {bright} of {total} pixels are lit", path.display());
    }
    Ok(())
}
