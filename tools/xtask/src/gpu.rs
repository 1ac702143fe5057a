//! A GPU for the tests: the machine's, or a software one.

use crate::apt;
use crate::process::target_folder;
use anyhow::{Context, Result, bail, ensure};
use std::env::consts::EXE_SUFFIX;
use std::process::Command;

/// Debian's packages of a Vulkan loader and a software GPU (lavapipe).
const PACKAGES: [&str; 3] = ["libegl1", "libvulkan1", "mesa-vulkan-drivers"];

/// Checks that there is a GPU, and installs a software one if there is none and that can be done.
pub fn ensure() -> Result<()> {
    let advice = format!(
        "without a GPU its tests cannot run. On Debian and its kin: apt-get install {}; elsewhere \
         any Vulkan driver will do. To leave these tests out: cargo xtask test --without-gpu",
        PACKAGES.join(" ")
    );
    if is_found()? {
        return Ok(());
    }
    println!("== no GPU is found: installing a software one");
    apt::install(&PACKAGES, &advice)?;
    if !is_found()? {
        bail!("a software GPU is installed and not found; {advice}");
    }
    Ok(())
}

/// Returns true if the command line, which the tests have built, finds any adapter.
fn is_found() -> Result<bool> {
    let program = target_folder()?.join("debug").join(format!("lamplight{EXE_SUFFIX}"));
    let output = Command::new(&program)
        .args(["info", "--json"])
        .output()
        .with_context(|| format!("cannot run {}", program.display()))?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let info: serde_json::Value = serde_json::from_slice(&output.stdout)?;
    let adapters = info["adapters"].as_array().context("`info --json` lists adapters")?;
    Ok(!adapters.is_empty())
}
