//! The package for Python: built, installed and tested in a virtual environment in the target folder.

use crate::optional::has_component;
use crate::process::{command, finish, root, succeeds, target_folder};
use anyhow::Result;
use std::process::Command;

/// The requirement of the step beside Rust.
pub const NEEDED: &str = "Python 3.10 or later as `python3`, with venv";

/// The contents of the environment: the builder, the package's dependency, the tests'.
const PACKAGES: [&str; 4] = ["maturin>=1.16,<2", "numpy", "pytest", "mypy"];

/// Returns true if there is a Python that can make an environment. Debian's can import venv without having ensurepip.
pub fn is_here() -> bool {
    let check = "import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 10))";
    succeeds(Command::new("python3").args(["-c", check]))
}

/// Builds the wheel, installs it, checks its Rust, and runs its tests.
pub fn test() -> Result<()> {
    let target = target_folder()?;
    let environment = target.join("python");
    finish(Command::new("python3").args(["-m", "venv"]).arg(&environment))?;
    let programs = environment.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let python = programs.join("python");
    let pip = |arguments: &[&str]| {
        let mut pip = Command::new(&python);
        pip.args(["-m", "pip", "--quiet", "--disable-pip-version-check", "install"]);
        pip.args(arguments);
        pip
    };
    finish(&mut pip(&PACKAGES))?;

    let package = root().join("crates/lamplight-python");
    if has_component("fmt", "rustfmt") {
        finish(command(&package).args(["fmt", "--check"]))?;
    }
    if has_component("clippy", "clippy") {
        let mut clippy = command(&package);
        clippy.args(["clippy", "--release", "--locked", "--no-deps", "--", "-D", "warnings"]);
        finish(clippy.env("CARGO_TARGET_DIR", &target).env("PYO3_PYTHON", &python))?;
    }
    let wheels = environment.join("wheels");
    let mut build = Command::new(programs.join("maturin"));
    build.args(["build", "--quiet", "--release", "--locked", "--interpreter"]).arg(&python);
    build.arg("--out").arg(&wheels).env("CARGO_TARGET_DIR", &target);
    finish(build.current_dir(&package))?;
    let again = ["--force-reinstall", "--no-deps", "--no-index", "--find-links"];
    finish(pip(&again).arg(&wheels).arg("lamplight2d"))?;
    finish(Command::new(&python).args(["-m", "pytest", "--quiet"]).current_dir(&package))
}
