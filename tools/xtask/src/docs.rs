//! The documents' pictures and figures: `cargo xtask docs`.
//!
//! `lamplight-generate` makes those that the command line renders and measures; those of windows are
//! made here.

use crate::display::{self, Display};
use crate::process::{cargo, command, finish, root, target_folder, tool};
use anyhow::{Result, ensure};
use std::fs;

/// A part of the documents.
#[derive(Clone, Debug, PartialEq)]
pub enum Part {
    All,
    /// A part that `lamplight-generate` knows by this name.
    Generated(String),
    Sandbox,
    Bevy,
}

/// Makes a part.
pub fn run(part: Part) -> Result<()> {
    match part {
        Part::All => {
            generate(&["docs"])?;
            bevy()?;
            sandbox()
        }
        Part::Generated(name) => generate(&["docs", "--only", &name]),
        Part::Sandbox => sandbox(),
        Part::Bevy => bevy(),
    }
}

fn generate(arguments: &[&str]) -> Result<()> {
    cargo(&["build", "--release", "--package", "lamplight-cli"])?;
    tool("lamplight-generate", arguments)
}

/// Pictures of the sandbox: name, world, and the script that its person plays.
const SANDBOX: [(&str, &str, &str); 12] = [
    ("paint", "paint", "frames 4"),
    ("bodies", "bodies", "frames 90"),
    ("sand", "sand", "frames 150"),
    ("room", "room", "frames 20"),
    ("split", "sand", "frames 150\nsplit raymarch\nset raymarch.rays=8\nframes 2"),
    ("voronoi", "sand", "frames 150\nview voronoi\nframes 2"),
    ("distance", "bodies", "frames 60\nview distance\nframes 2"),
    ("ray-textures", "room", "set method=polar\nview inside 0\nframes 3"),
    ("cascade", "paint", "set method=cascades\nset cascades.preset=plain\nview inside 0\nframes 3"),
    ("intervals", "sand", "frames 150\nview inside 4\nframes 2"),
    ("reference", "paint", "view reference\nframes 900"),
    ("error", "paint", "view error\nframes 900"),
];

/// Pictures of the sandbox's window.
fn sandbox() -> Result<()> {
    display::ensure()?;
    let display = Display::new()?;
    let script = target_folder()?.join("sandbox-script");
    for (name, world, lines) in SANDBOX {
        let picture = root().join(format!("docs/pictures/sandbox-{name}.png"));
        fs::write(&script, format!("{lines}\nshot {}\n", picture.display()))?;
        let mut window = command(root());
        window.args(["run", "--release", "--quiet", "--package", "lamplight-sandbox", "--"]);
        window.args(["--world", world, "--script"]).arg(&script);
        finish(window.env("DISPLAY", &display.name))?;
        ensure!(picture.exists(), "{} was not made", picture.display());
    }
    Ok(())
}

/// Pictures of the examples for Bevy, which its tests compare with.
fn bevy() -> Result<()> {
    let mut draw = command(root());
    draw.args(["test", "--package", "bevy_lamplight", "--test", "headless", "examples::"]);
    finish(draw.env("LAMPLIGHT_DRAW", "1"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every relative link and picture in the documents leads to a file.
    #[test]
    fn links_lead_somewhere() {
        let mut pages = vec![];
        for folder in ["", "docs"] {
            for entry in fs::read_dir(root().join(folder)).unwrap() {
                let path = entry.unwrap().path();
                if path.extension().is_some_and(|e| e == "md") {
                    pages.push(path);
                }
            }
        }
        assert!(pages.len() >= 5, "the documents are looked for in the wrong place");
        for page in pages {
            let text = fs::read_to_string(&page).unwrap();
            for rest in text.split("](").skip(1) {
                let link = rest.split([')', '#']).next().unwrap();
                let inside = !link.is_empty() && !link.contains("://");
                let target = page.parent().unwrap().join(link);
                assert!(!inside || target.exists(), "{}: no {link}", page.display());
            }
        }
    }
}
