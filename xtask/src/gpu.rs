//! A GPU for the tests: the machine's, or a software one.

use crate::apt;
use crate::generated::root;
use crate::test::command;
use anyhow::{Context, Result, bail, ensure};

/// Debian's packages of a Vulkan loader and a software GPU (lavapipe).
const PACKAGES: [&str; 2] = ["libvulkan1", "mesa-vulkan-drivers"];

/// Sees to it that there is one; installs a software one where that can be done.
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

/// Whether the command line finds any.
fn is_found() -> Result<bool> {
    let output = command(root())
        .args(["run", "--quiet", "--package", "lamplight-cli", "--", "info", "--json"])
        .output()
        .context("cannot run cargo")?;
    ensure!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let info: serde_json::Value = serde_json::from_slice(&output.stdout)?;
    let adapters = info["adapters"].as_array().context("`info --json` lists adapters")?;
    Ok(!adapters.is_empty())
}
