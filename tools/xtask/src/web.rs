//! `cargo xtask web`: web pages, in `target/web/`: the sandbox, or an example for Bevy.

use crate::process::{cargo, command, finish, root, target_folder, tool};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const TARGET: &str = "wasm32-unknown-unknown";
/// The program that weighs and serves pages.
pub const SERVER: &str = "lamplight-page";
/// The profile in `Cargo.toml`.
const PROFILE: &str = "web";

/// A page: a program, and the `web/index.html` of its package.
pub struct Page {
    package: &'static str,
    /// The package's folder.
    folder: &'static str,
    /// None: the package's own program.
    example: Option<&'static str>,
    /// Name of the script and the program on the page.
    name: &'static str,
    /// Bytes that it may have, compressed as servers send it.
    limit: usize,
}

pub const SANDBOX: Page = Page {
    package: "lamplight-sandbox",
    folder: "demos/sandbox",
    example: None,
    name: "lamplight",
    limit: 3_000_000,
};
/// Bevy itself is most of it.
pub const BEVY: Page = Page {
    package: "bevy_lamplight",
    folder: "crates/bevy_lamplight",
    example: Some("neon_street"),
    name: "neon_street",
    limit: 12_000_000,
};

/// Builds a page, and serves it where a port is given; 0 is any free one.
pub fn run(page: &Page, port: Option<u16>) -> Result<()> {
    let folder = page.build()?;
    let Some(port) = port else { return Ok(()) };
    println!("the page is served until Ctrl+C, at");
    tool(SERVER, &[&folder.display().to_string(), "--serve", &port.to_string()])
}

impl Page {
    /// The folder that it is built into.
    pub fn folder(&self) -> Result<PathBuf> {
        Ok(target_folder()?.join("web").join(self.name))
    }

    /// Cargo's arguments that select the program.
    pub fn program(&self) -> Vec<&'static str> {
        let package = ["--package", self.package, "--target", TARGET];
        let example = self.example.map(|example| ["--example", example]);
        package.into_iter().chain(example.into_iter().flatten()).collect()
    }

    /// Builds it, and returns its folder.
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
        finish(
            Command::new(&bindgen)
                .args(["--target", "web", "--no-typescript", "--remove-name-section"])
                .args(["--remove-producers-section", "--out-name", self.name, "--out-dir"])
                .arg(&folder)
                .arg(program.with_extension("wasm")),
        )?;
        let source = root().join(self.folder).join("web/index.html");
        fs::copy(&source, folder.join("index.html"))
            .with_context(|| source.display().to_string())?;
        let limit = self.limit.to_string();
        tool(SERVER, &[&folder.display().to_string(), "--limit", &limit])?;
        Ok(folder)
    }
}

/// Checks that the toolchain can compile for the web, and adds the target if not.
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

/// The program that makes JavaScript of what a program exports: it has to be of the release that the
/// program is compiled with. One on the PATH, else one of ours, which is installed where it is missing.
fn bindgen(target: &Path) -> Result<PathBuf> {
    let release = locked_release("wasm-bindgen")?;
    let tools = target.join("tools");
    let ours = tools.join("bin/wasm-bindgen");
    let fits = |program: &Path| {
        let output = Command::new(program).arg("--version").stderr(Stdio::null()).output();
        output.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains(&release))
    };
    for program in ["wasm-bindgen".into(), ours.clone()] {
        if fits(&program) {
            return Ok(program);
        }
    }
    println!("== wasm-bindgen {release} is not found: installing it into {}", tools.display());
    let version = format!("={release}");
    // Its own lock file names releases that may have been withdrawn since.
    for locked in [&["--locked"][..], &[]] {
        let status = command(root())
            .args(["install", "wasm-bindgen-cli", "--version", &version, "--root"])
            .arg(&tools)
            .args(locked)
            .status()?;
        if status.success() && fits(&ours) {
            return Ok(ours);
        }
    }
    bail!(
        "wasm-bindgen could not be installed; to do so: cargo install wasm-bindgen-cli --version {version}"
    );
}

/// The release of a package in `Cargo.lock`.
fn locked_release(package: &str) -> Result<String> {
    let lock = fs::read_to_string(root().join("Cargo.lock"))?;
    let name = format!("name = \"{package}\"\nversion = \"");
    let (_, after) = lock.split_once(&name).with_context(|| format!("no {package} is locked"))?;
    Ok(after.split('"').next().unwrap_or_default().to_owned())
}
