//! The package for Python: built, installed and tested in a virtual environment in the target folder.

use crate::optional::has_component;
use crate::process::{command, finish, root, succeeds, target_folder};
use anyhow::Result;
use std::path::PathBuf;
use std::process::Command;

/// The requirement of the step beside Rust.
pub const NEEDED: &str =
    "Python 3.10 or later as `python3`, with venv, and packages of its registry";

/// The contents of the environment: the builder, the package's dependencies, the tests'.
const PACKAGES: [&str; 8] = [
    "maturin>=1.16,<2",
    "numpy",
    "dask[array,distributed]",
    "pytest",
    "pytest-xdist",
    "mypy",
    "matplotlib",
    "zarr>=3; python_version >= '3.11'",
];

/// A virtual environment in the target folder.
pub struct Environment {
    folder: PathBuf,
    /// The folder of its programs.
    programs: PathBuf,
}

impl Environment {
    /// Makes it, or finds it made; `None` without a Python that can, or if packages cannot be downloaded.
    pub fn new() -> Result<Option<Self>> {
        // Debian's can import venv without having ensurepip.
        let check = "import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 10))";
        if !succeeds(Command::new("python3").args(["-c", check])) {
            return Ok(None);
        }
        let folder = target_folder()?.join("python");
        finish(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
        let programs = folder.join(if cfg!(windows) { "Scripts" } else { "bin" });
        let environment = Self { folder, programs };
        let is_filled = succeeds(&mut environment.install(&PACKAGES));
        Ok(is_filled.then_some(environment))
    }

    fn install(&self, arguments: &[&str]) -> Command {
        let mut pip = self.python();
        pip.args(["-m", "pip", "--quiet", "--disable-pip-version-check", "install"]);
        pip.args(arguments);
        pip
    }

    fn python(&self) -> Command {
        Command::new(self.programs.join("python"))
    }
}

fn package() -> PathBuf {
    root().join("crates/lamplight-python")
}

/// Runs Clippy on its Rust.
pub fn lints(environment: &Environment) -> Result<()> {
    let mut clippy = command(&package());
    // The command too: only here it is built without the GPU.
    clippy.args(["clippy", "--locked", "--no-deps"]);
    clippy.args(["--package", "lamplight-python", "--package", "lamplight-cli"]);
    clippy.args(["--", "-D", "warnings"]);
    let python = environment.programs.join("python");
    finish(clippy.env("CARGO_TARGET_DIR", target_folder()?).env("PYO3_PYTHON", python))
}

/// Builds the wheel, installs it, and runs its tests.
pub fn test(environment: &Environment) -> Result<()> {
    let Environment { folder, programs } = environment;
    let target = target_folder()?;
    let python = programs.join("python");
    let package = package();
    if has_component("fmt", "rustfmt") {
        finish(command(&package).args(["fmt", "--check"]))?;
    }
    let wheels = folder.join("wheels");
    let mut build = Command::new(programs.join("maturin"));
    // By the dev profile, whose dependencies the other tests have built.
    build.args(["build", "--quiet", "--locked", "--interpreter"]).arg(&python);
    build.arg("--out").arg(&wheels).env("CARGO_TARGET_DIR", &target);
    finish(build.current_dir(&package))?;
    let again = ["--force-reinstall", "--no-deps", "--no-index", "--find-links"];
    finish(environment.install(&again).arg(&wheels).arg("lamplight2d"))?;
    // Solvers of one thread leave a core idle; the tests of a file share a cluster.
    let parallel = ["-m", "pytest", "--quiet", "-n", "2", "--dist", "loadfile"];
    finish(environment.python().args(parallel).current_dir(&package))
}
