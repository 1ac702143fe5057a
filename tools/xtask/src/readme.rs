//! The README's first command, run in an empty folder.

use crate::process::{built, finish, root, target_folder};
use anyhow::{Context, Result, ensure};
use std::fs;
use std::process::Command;

/// The command, and the scene in it.
const FIRST_COMMAND: &str = "cargo run --release -- render scenes/cave.toml";
const SCENE: &str = "scenes/cave.toml";
const PICTURE: &str = "cave.png";
/// The least bytes of the picture. One of a single colour has a hundredth of them; the tests of the
/// command line look at the light itself.
const BYTES: u64 = 20_000;

/// Lights the scene in an empty folder by the program that the tests have built, and looks at what came out. In release, as
/// the README says, all of it would be compiled again, for minutes.
pub fn first_command() -> Result<()> {
    let readme = fs::read_to_string(root().join("README.md"))?;
    ensure!(readme.contains(FIRST_COMMAND), "README.md has no `{FIRST_COMMAND}`");
    let folder = target_folder()?.join("first-command");
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    let mut render = Command::new(built("lamplight")?);
    finish(render.current_dir(&folder).arg("render").arg(root().join(SCENE)))?;
    let path = folder.join(PICTURE);
    let picture = fs::metadata(&path).with_context(|| path.display().to_string())?;
    ensure!(picture.len() > BYTES, "{} is empty: {} bytes", path.display(), picture.len());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first Rust example of a page.
    fn example(path: &str) -> String {
        let page = fs::read_to_string(root().join(path)).unwrap();
        let block = page.split("```rust\n").nth(1).unwrap().split("```").next().unwrap();
        block.to_owned()
    }

    /// The documentation tests of `lamplight` run the example in the package's own README.
    #[test]
    fn the_example_is_the_one_that_is_tested() {
        assert_eq!(example("README.md"), example("crates/lamplight/README.md"));
    }

    #[test]
    fn the_first_command_is_in_the_readme() {
        let readme = fs::read_to_string(root().join("README.md")).unwrap();
        assert!(readme.contains(FIRST_COMMAND) && readme.contains("cargo xtask test "));
    }
}
