//! Files made by code and kept in the repository: written, or checked to be up to date.

use anyhow::{Context, Result, bail};
use image::DynamicImage;
use std::fs;
use std::path::Path;

/// An action on a generated file.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// Write it where it differs.
    Write,
    /// Fail where it differs.
    Check,
}

/// The repository's root.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).expect("xtask lies in tools/")
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

/// Puts text between the marks of a block of a document: `<!-- begin NAME: cargo xtask CHORE -->` and
/// `<!-- end NAME -->`.
pub fn block(mode: Mode, path: &str, name: &str, text: &str, chore: &str) -> Result<()> {
    let page =
        fs::read_to_string(root().join(path)).with_context(|| format!("cannot read {path}"))?;
    let page =
        replace(&page, name, text, chore).with_context(|| format!("{path} has no block {name}"))?;
    bytes(mode, path, page.as_bytes(), chore)
}

fn replace(page: &str, name: &str, text: &str, chore: &str) -> Option<String> {
    let (begin, end) =
        (format!("<!-- begin {name}: cargo xtask {chore} -->\n"), format!("<!-- end {name} -->"));
    let from = page.find(&begin)? + begin.len();
    let to = from + page[from..].find(&end)?;
    Some(format!("{}{text}{}", &page[..from], &page[to..]))
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

#[cfg(test)]
mod tests {
    use super::*;
    use image::RgbImage;

    #[test]
    fn one_changed_pixel_is_not_up_to_date() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/picture.png");
        let mut picture = RgbImage::from_fn(5, 3, |x, y| image::Rgb([x as u8, y as u8, 200]));
        let run =
            |mode, picture: &RgbImage| super::picture(mode, &path, &picture.clone().into(), "x");
        assert!(run(Mode::Check, &picture).is_err(), "a missing picture passes");
        run(Mode::Write, &picture).unwrap();
        run(Mode::Check, &picture).unwrap();
        picture[(4, 2)].0[0] += 1;
        let error = run(Mode::Check, &picture).unwrap_err().to_string();
        assert!(error.contains("not up to date: run `cargo xtask x`"), "{error}");
    }

    #[test]
    fn a_block_is_replaced_and_nothing_else() {
        let page = "a\n<!-- begin x: cargo xtask docs -->\nold\n<!-- end x -->\nb\n";
        let new = replace(page, "x", "new\n", "docs").unwrap();
        assert_eq!(new, "a\n<!-- begin x: cargo xtask docs -->\nnew\n<!-- end x -->\nb\n");
        assert_eq!(replace(page, "y", "new\n", "docs"), None);
        assert_eq!(replace(page, "x", "new\n", "schema"), None);
    }

    #[test]
    fn one_changed_byte_is_not_up_to_date() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("text");
        bytes(Mode::Write, &path, b"light", "x").unwrap();
        bytes(Mode::Check, &path, b"light", "x").unwrap();
        assert!(bytes(Mode::Check, &path, b"night", "x").is_err());
    }
}
