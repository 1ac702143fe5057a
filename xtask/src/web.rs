//! `cargo xtask web`: the sandbox as a web page, in `target/web/`.

use crate::generated::root;
use crate::serve::Server;
use crate::test::{cargo, command};
use anyhow::{Context, Result, bail, ensure};
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::Value;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

pub const TARGET: &str = "wasm32-unknown-unknown";
pub const PACKAGE: &str = "lamplight-sandbox";
/// The profile in `Cargo.toml`.
const PROFILE: &str = "web";
/// What the script and the program on the page are called.
const NAME: &str = "lamplight";
/// Bytes that the page may have, compressed as servers send it.
const LIMIT: usize = 3_000_000;

/// Builds the page, and serves it where a port is given; 0 is any free one.
pub fn run(port: Option<u16>) -> Result<()> {
    let page = build()?;
    let Some(port) = port else { return Ok(()) };
    let server = Server::new(page, port)?;
    println!("the page is at {}; Ctrl+C ends", server.address());
    server.run();
    Ok(())
}

/// Where the page is.
pub fn folder() -> Result<PathBuf> {
    Ok(target_folder()?.join("web"))
}

/// Builds the page and says where it is.
pub fn build() -> Result<PathBuf> {
    ensure_target()?;
    let target = target_folder()?;
    let bindgen = bindgen(&target)?;
    cargo(&["build", "--package", PACKAGE, "--target", TARGET, "--profile", PROFILE])?;
    let page = folder()?;
    if page.exists() {
        fs::remove_dir_all(&page)?;
    }
    fs::create_dir_all(&page)?;
    let status = Command::new(&bindgen)
        .args(["--target", "web", "--no-typescript", "--remove-name-section"])
        .args(["--remove-producers-section", "--out-name", NAME, "--out-dir"])
        .arg(&page)
        .arg(target.join(TARGET).join(PROFILE).join(PACKAGE).with_extension("wasm"))
        .status()?;
    ensure!(status.success(), "wasm-bindgen ended with {status}");
    let source = root().join("crates").join(PACKAGE).join("web/index.html");
    fs::copy(&source, page.join("index.html")).with_context(|| source.display().to_string())?;
    weigh(&page)?;
    Ok(page)
}

/// Prints what the page weighs; an error where that is too much.
fn weigh(page: &Path) -> Result<()> {
    let mut total = 0;
    for (name, bytes) in files(page)? {
        let mut gzip = GzEncoder::new(Vec::new(), Compression::best());
        gzip.write_all(&bytes)?;
        let compressed = gzip.finish()?.len();
        total += compressed;
        let kilobytes = |bytes: usize| bytes as f64 / 1e3;
        println!(
            "{:>8.1} kB, compressed {:>8.1} kB: {name}",
            kilobytes(bytes.len()),
            kilobytes(compressed)
        );
    }
    let megabytes = |bytes: usize| bytes as f64 / 1e6;
    println!(
        "{:.2} MB compressed, of {:.2} at most: {}",
        megabytes(total),
        megabytes(LIMIT),
        page.display()
    );
    ensure!(total <= LIMIT, "the page is heavier than {:.2} MB", megabytes(LIMIT));
    Ok(())
}

/// All files under a folder, by their paths from there.
fn files(folder: &Path) -> Result<Vec<(String, Vec<u8>)>> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(here) = folders.pop() {
        for entry in fs::read_dir(here)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder)?.display().to_string();
                found.push((name, fs::read(&path)?));
            }
        }
    }
    found.sort();
    Ok(found)
}

/// Sees to it that the toolchain can compile for the web.
pub fn ensure_target() -> Result<()> {
    if has_target()? {
        return Ok(());
    }
    println!("== the toolchain has no {TARGET}: adding it");
    let advice = format!("to add it: rustup target add {TARGET}");
    let added = Command::new("rustup").args(["target", "add", TARGET]).current_dir(root()).status();
    if !added.with_context(|| advice.clone())?.success() || !has_target()? {
        bail!("the toolchain cannot compile for the web; {advice}");
    }
    Ok(())
}

fn has_target() -> Result<bool> {
    let asked = Command::new(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()))
        .args(["--print", "target-libdir", "--target", TARGET])
        .current_dir(root())
        .output()
        .context("cannot run rustc")?;
    Ok(Path::new(String::from_utf8(asked.stdout)?.trim()).exists())
}

/// Where Cargo builds.
fn target_folder() -> Result<PathBuf> {
    let told = command(root()).args(["metadata", "--no-deps", "--format-version", "1"]).output()?;
    ensure!(told.status.success(), "{}", String::from_utf8_lossy(&told.stderr));
    let metadata: Value = serde_json::from_slice(&told.stdout)?;
    Ok(metadata["target_directory"].as_str().context("Cargo builds nowhere")?.into())
}

/// The program that makes JavaScript of what a program exports: it has to be of the release that the
/// program is compiled with. One on the PATH, else one of ours, which is installed where it is missing.
fn bindgen(target: &Path) -> Result<PathBuf> {
    let release = locked_release("wasm-bindgen")?;
    let tools = target.join("tools");
    let ours = tools.join("bin/wasm-bindgen");
    let fits = |program: &Path| {
        let told = Command::new(program).arg("--version").stderr(Stdio::null()).output();
        told.is_ok_and(|told| String::from_utf8_lossy(&told.stdout).contains(&release))
    };
    for program in ["wasm-bindgen".into(), ours.clone()] {
        if fits(&program) {
            return Ok(program);
        }
    }
    println!("== wasm-bindgen {release} is not found: installing it into {}", tools.display());
    let version = format!("={release}");
    let status = command(root())
        .args(["install", "--quiet", "wasm-bindgen-cli", "--version", &version, "--root"])
        .arg(&tools)
        .status()?;
    if !status.success() || !fits(&ours) {
        bail!(
            "wasm-bindgen could not be installed; to do so: cargo install wasm-bindgen-cli --version {version}"
        );
    }
    Ok(ours)
}

/// The release of a package in `Cargo.lock`.
fn locked_release(package: &str) -> Result<String> {
    let lock = fs::read_to_string(root().join("Cargo.lock"))?;
    let name = format!("name = \"{package}\"\nversion = \"");
    let (_, after) = lock.split_once(&name).with_context(|| format!("no {package} is locked"))?;
    Ok(after.split('"').next().unwrap_or_default().to_owned())
}
