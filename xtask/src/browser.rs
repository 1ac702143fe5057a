//! The page in a browser without a window: `cargo xtask test --web`.

use crate::apt;
use crate::generated::root;
use crate::serve::Server;
use anyhow::{Context, Result, bail, ensure};
use serde_json::{Map, Value};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Names under which the browser is found.
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];
/// Debian's packages of the browser, and of what drives it.
const BROWSER: [&str; 1] = ["chromium"];
const DRIVER: [&str; 2] = ["nodejs", "npm"];
/// What drives it, from npm.
const LIBRARY: &str = "playwright-core";

/// Opens a page, and judges it by `browser/test.mjs`.
pub fn test(page: PathBuf) -> Result<()> {
    let browser = browser()?;
    library()?;
    // A browser reads WGSL more strictly than naga does.
    let shaders: Map<String, Value> = lamplight_wgpu::shaders()
        .map(|(name, text)| (name.to_owned(), Value::from(text)))
        .collect();
    let file = tempfile::NamedTempFile::new()?;
    serde_json::to_writer(&file, &shaders)?;
    let server = Server::new(page, 0)?;
    let address = server.address();
    std::thread::spawn(move || server.run());
    let status = Command::new("node")
        .arg("test.mjs")
        .arg(&address)
        .args([browser.as_path(), file.path()])
        .current_dir(folder())
        .status()?;
    ensure!(status.success(), "the page failed in {}: {status}", browser.display());
    Ok(())
}

fn folder() -> PathBuf {
    root().join("xtask/browser")
}

/// The browser; it is installed where that can be done.
fn browser() -> Result<PathBuf> {
    let find = || BROWSERS.into_iter().find_map(on_path);
    if let Some(found) = find() {
        return Ok(found);
    }
    println!("== no Chromium is found: installing it");
    let advice = "the page is tested in Chromium. On Debian and its kin: apt-get install chromium";
    apt::install(&BROWSER, advice)?;
    find().with_context(|| format!("Chromium is installed and not found; {advice}"))
}

/// Sees to it that what drives the browser is there, in the release that the lock file names.
fn library() -> Result<()> {
    if ["node", "npm"].into_iter().any(|program| on_path(program).is_none()) {
        println!("== no Node.js is found: installing it");
        let advice = "the page is tested by a script for Node.js 20 or later, and a library from npm. \
                      On Debian and its kin: apt-get install nodejs npm";
        apt::install(&DRIVER, advice)?;
    }
    let asked = release(&folder().join("package.json"), &["dependencies", LIBRARY])?;
    let package = folder().join("node_modules").join(LIBRARY).join("package.json");
    if release(&package, &["version"]).is_ok_and(|here| here == asked) {
        return Ok(());
    }
    println!("== {LIBRARY} {asked} is not found: fetching it");
    let advice = format!("to fetch {LIBRARY}: npm ci, in {}", folder().display());
    let status = Command::new("npm")
        .args(["ci", "--no-audit", "--no-fund"])
        .current_dir(folder())
        .status()
        .with_context(|| advice.clone())?;
    if !status.success() {
        bail!("npm ci: {status}; {advice}");
    }
    Ok(())
}

/// A release, by its keys in a JSON file.
fn release(path: &Path, keys: &[&str]) -> Result<String> {
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let json: Value = serde_json::from_str(&text)?;
    let value = keys.iter().fold(&json, |value, key| &value[*key]);
    Ok(value.as_str().with_context(|| format!("{} names no release", path.display()))?.to_owned())
}

/// Where a program lies.
fn on_path(program: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders).map(|folder| folder.join(program)).find(|path| path.is_file())
}
