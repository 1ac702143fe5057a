//! `cargo xtask web`: web pages, in `target/web/`: the sandbox, or an example for Bevy.

use crate::process::{cargo, root, target_folder, tool};
use anyhow::{Context, Result, bail};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "wasm32-unknown-unknown";
/// The program that puts pages together, weighs and serves them.
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
        cargo(&[&["build", "--profile", PROFILE], &self.program()[..]].concat())?;
        let built = target_folder()?.join(TARGET).join(PROFILE);
        let program = match self.example {
            None => built.join(self.package),
            Some(example) => built.join("examples").join(example),
        };
        let folder = self.folder()?;
        if folder.exists() {
            fs::remove_dir_all(&folder)?;
        }
        fs::create_dir_all(&folder)?;
        let source = root().join(self.folder).join("web/index.html");
        fs::copy(&source, folder.join("index.html"))
            .with_context(|| source.display().to_string())?;
        let (limit, program) = (self.limit.to_string(), program.with_extension("wasm"));
        let [page, program] = [&folder, &program].map(|path| path.display().to_string());
        tool(SERVER, &[&page, "--program", &program, "--name", self.name, "--limit", &limit])?;
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
