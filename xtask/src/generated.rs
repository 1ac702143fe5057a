//! Files made by code and kept in the repository: written, or checked to be up to date.

use anyhow::{Context, Result, bail, ensure};
use image::DynamicImage;
use std::fs;
use std::path::{Path, PathBuf};

/// What to do with a generated file.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Write it where it differs.
    Write,
    /// Fail where it differs.
    Check,
}

/// The repository's root.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("xtask lies in the repository")
}

/// Puts bytes at a path relative to the root.
pub fn bytes(mode: Mode, path: impl AsRef<Path>, content: &[u8], chore: &str) -> Result<()> {
    let path = root().join(path);
    let same = fs::read(&path).is_ok_and(|old| old == content);
    settle(mode, &path, same, chore, || Ok(fs::write(&path, content)?))
}

/// Puts a picture at a path relative to the root, as a PNG.
///
/// Pictures are compared by pixels and not by bytes, so that a new PNG encoder changes nothing.
pub fn picture(
    mode: Mode,
    path: impl AsRef<Path>,
    content: &DynamicImage,
    chore: &str,
) -> Result<()> {
    let path = root().join(path);
    let same = image::open(&path).is_ok_and(|old| old == *content);
    settle(mode, &path, same, chore, || Ok(content.save(&path)?))
}

fn settle(
    mode: Mode,
    path: &Path,
    same: bool,
    chore: &str,
    write: impl FnOnce() -> Result<()>,
) -> Result<()> {
    let name = path.strip_prefix(root()).unwrap_or(path).display();
    match mode {
        _ if same => Ok(()),
        Mode::Check => bail!("{name} is not up to date: run `cargo xtask {chore}`"),
        Mode::Write => {
            let folder = path.parent().context("a file has a folder")?;
            fs::create_dir_all(folder)?;
            write().with_context(|| format!("cannot write {name}"))?;
            println!("wrote {name}");
            Ok(())
        }
    }
}

/// Fails when a folder holds files with the given ending that no chore makes any more.
pub fn no_strays(folder: &str, ending: &str, made: &[PathBuf]) -> Result<()> {
    let folder = root().join(folder);
    for entry in fs::read_dir(&folder)? {
        let path = entry?.path();
        let stray = path.extension().is_some_and(|e| e == ending) && !made.contains(&path);
        ensure!(!stray, "{} is made by no chore: delete it", path.display());
    }
    Ok(())
}
