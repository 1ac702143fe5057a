//! Packages of Debian and its kin, where a test needs a program that Rust does not bring.

use anyhow::{Context, Result, ensure};
use std::process::Command;

/// Installs packages; an error ends with the advice.
pub fn install(packages: &[&str], advice: &str) -> Result<()> {
    let install = [&["install", "-y", "-qq"], packages].concat();
    for arguments in [&["update", "-qq"][..], &install] {
        let done = Command::new("apt-get")
            .args(arguments)
            .env("DEBIAN_FRONTEND", "noninteractive")
            .status()
            .with_context(|| advice.to_owned())?;
        ensure!(done.success(), "apt-get {}: {done}; {advice}", arguments.join(" "));
    }
    Ok(())
}
