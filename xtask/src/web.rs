//! `cargo xtask web`: web pages, in `target/web/`: the sandbox, or an example for Bevy.

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

const TARGET: &str = "wasm32-unknown-unknown";
/// The profile in `Cargo.toml`.
const PROFILE: &str = "web";

/// What a page is made of: a program, and the `web/index.html` of its package.
pub struct Page {
    package: &'static str,
    /// None: the package's own program.
    example: Option<&'static str>,
    /// What the script and the program on the page are called.
    name: &'static str,
    /// Bytes that it may have, compressed as servers send it.
    limit: usize,
}

pub const SANDBOX: Page =
    Page { package: "lamplight-sandbox", example: None, name: "lamplight", limit: 3_000_000 };
/// Bevy itself is most of it.
pub const BEVY: Page = Page {
    package: "bevy_lamplight",
    example: Some("neon_street"),
    name: "neon_street",
    limit: 12_000_000,
};

/// Builds a page, and serves it where a port is given; 0 is any free one.
pub fn run(page: &Page, port: Option<u16>) -> Result<()> {
    let folder = page.build()?;
    let Some(port) = port else { return Ok(()) };
    let server = Server::new(folder, port)?;
    println!("the page is at {}; Ctrl+C ends", server.address());
    server.run();
    Ok(())
}

impl Page {
    /// Where it is.
    pub fn folder(&self) -> Result<PathBuf> {
        Ok(target_folder()?.join("web").join(self.name))
    }

    /// What Cargo is told to compile.
    pub fn program(&self) -> Vec<&'static str> {
        let package = ["--package", self.package, "--target", TARGET];
        let example = self.example.map(|example| ["--example", example]);
        package.into_iter().chain(example.into_iter().flatten()).collect()
    }

    /// Builds it and says where it is.
    pub fn build(&self) -> Result<PathBuf> {
        ensure_target()?;
        let target = target_folder()?;
        let bindgen = bindgen(&target)?;
        cargo(&[&["build", "--profile", PROFILE], &self.program()[..]].concat())?;
        let built = target.join(TARGET).join(PROFILE);
        let program = match self.example {
            None => built.join(self.package),
            Some(example) => built.join("examples").join(example),
        };
        let folder = self.folder()?;
        if folder.exists() {
            fs::remove_dir_all(&folder)?;
        }
        fs::create_dir_all(&folder)?;
        let status = Command::new(&bindgen)
            .args(["--target", "web", "--no-typescript", "--remove-name-section"])
            .args(["--remove-producers-section", "--out-name", self.name, "--out-dir"])
            .arg(&folder)
            .arg(program.with_extension("wasm"))
            .status()?;
        ensure!(status.success(), "wasm-bindgen ended with {status}");
        let source = root().join("crates").join(self.package).join("web/index.html");
        fs::copy(&source, folder.join("index.html"))
            .with_context(|| source.display().to_string())?;
        weigh(&folder, self.limit)?;
        Ok(folder)
    }
}

/// Prints what a page weighs; an error where that is too much.
fn weigh(page: &Path, limit: usize) -> Result<()> {
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
        megabytes(limit),
        page.display()
    );
    ensure!(total <= limit, "the page is heavier than {:.2} MB", megabytes(limit));
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
