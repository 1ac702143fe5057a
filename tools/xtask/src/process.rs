//! Cargo and other programs, run in the repository.

use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The repository's root.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).expect("xtask lies in tools/")
}

/// Cargo, to be run in a folder.
pub fn command(folder: &Path) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(folder);
    command
}

/// Runs Cargo in the root.
pub fn cargo(arguments: &[&str]) -> Result<()> {
    finish(command(root()).args(arguments))
}

/// The path of a program that was built before by the dev profile. [`program`] would build that of the tests again, as its
/// package by itself selects other features of its dependencies than the workspace does.
pub fn built(program: &str) -> Result<PathBuf> {
    let path = target_folder()?.join("debug").join(program);
    Ok(path.with_extension(std::env::consts::EXE_EXTENSION))
}

/// A program of the workspace, built by the dev profile when it runs.
pub fn program(package: &str) -> Command {
    let mut program = command(root());
    program.args(["run", "--quiet", "--package", package, "--"]);
    program
}

/// Runs a program of the workspace.
pub fn tool(package: &str, arguments: &[&str]) -> Result<()> {
    finish(program(package).args(arguments))
}

/// Runs a command to its end; an error unless it succeeds.
pub fn finish(command: &mut Command) -> Result<()> {
    let status = command
        .status()
        .with_context(|| format!("cannot run {}", command.get_program().display()))?;
    ensure!(status.success(), "{command:?} ended with {status}");
    Ok(())
}

/// Returns true if a command runs and succeeds; what it prints is dropped.
pub fn succeeds(command: &mut Command) -> bool {
    let quiet = command.stdout(Stdio::null()).stderr(Stdio::null());
    quiet.status().is_ok_and(|status| status.success())
}

/// The folder that Cargo builds into.
pub fn target_folder() -> Result<PathBuf> {
    let metadata =
        command(root()).args(["metadata", "--no-deps", "--format-version", "1"]).output()?;
    ensure!(metadata.status.success(), "{}", String::from_utf8_lossy(&metadata.stderr));
    let metadata: Value = serde_json::from_slice(&metadata.stdout)?;
    Ok(metadata["target_directory"].as_str().context("Cargo has no target folder")?.into())
}

/// The path of a program on `PATH`.
pub fn on_path(program: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders).map(|folder| folder.join(program)).find(|path| path.is_file())
}
