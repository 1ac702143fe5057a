//! The page in a browser without a window: `cargo xtask test --web`.

use crate::apt;
use crate::process::{built, finish, on_path, root, target_folder};
use crate::web::SERVER;
use anyhow::{Context, Result, ensure};
use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// Names under which the browser is found.
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];
/// Debian's packages of the browser, and of what drives it.
const BROWSER: [&str; 1] = ["chromium"];
const DRIVER: [&str; 2] = ["nodejs", "npm"];
/// The npm package that drives it.
const LIBRARY: &str = "playwright-core";

/// Opens a page, and judges it by `browser/test.mjs`. `generate` runs `lamplight-generate`.
pub fn test(page: &Path, mut generate: Command) -> Result<()> {
    let browser = browser()?;
    library()?;
    // A browser reads WGSL more strictly than naga does.
    let shaders = generate.arg("shaders").output().context("cannot print the shaders")?;
    ensure!(shaders.status.success(), "{}", String::from_utf8_lossy(&shaders.stderr));
    let file = target_folder()?.join("web/shaders.json");
    fs::write(&file, shaders.stdout)?;
    let server = Server::new(page)?;
    finish(
        Command::new("node")
            .arg("test.mjs")
            .arg(&server.address)
            .args([&browser, &file])
            .current_dir(folder()),
    )
}

/// A page, served until this is dropped.
struct Server {
    process: Child,
    address: String,
}

impl Server {
    fn new(page: &Path) -> Result<Self> {
        let mut process = Command::new(built(SERVER)?)
            .arg(page)
            .args(["--serve", "0"])
            .stdout(Stdio::piped())
            .spawn()
            .context("cannot serve the page")?;
        let mut address = String::new();
        let output = process.stdout.take().context("the server's output is read")?;
        BufReader::new(output).read_line(&mut address)?;
        ensure!(!address.is_empty(), "the page is not served");
        Ok(Self { process, address: address.trim().to_owned() })
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        // An error means that it has ended already.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

fn folder() -> PathBuf {
    root().join("tools/xtask/browser")
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
    finish(Command::new("npm").args(["ci", "--no-audit", "--no-fund"]).current_dir(folder()))
        .with_context(|| advice)
}

/// A release, by its keys in a JSON file.
fn release(path: &Path, keys: &[&str]) -> Result<String> {
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let json: Value = serde_json::from_str(&text)?;
    let value = keys.iter().fold(&json, |value, key| &value[*key]);
    Ok(value.as_str().with_context(|| format!("{} names no release", path.display()))?.to_owned())
}
