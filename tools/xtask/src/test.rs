//! `cargo xtask test`: the checks of CI, on a machine that has only Rust and git.
//!
//! Two tiers. The first is what a contributor waits for: the crates that compile in minutes, and their
//! quick tests. `--all` adds Bevy, the sandbox, the browser, what is published, and the tests marked
//! `#[ignore = "slow: …"]`, and leaves Clippy to `--lints`.

use crate::optional::has_component;
use crate::process::{built, cargo, program};
use crate::python::Environment;
use crate::steps::Steps;
use crate::{browser, display, gpu, lint, publish, python, readme, web};
use anyhow::{Result, bail};
use std::process::Command;

/// Packages of the first tier.
const LIGHT: [&str; 7] = [
    "lamplight",
    "lamplight-truth",
    "lamplight-cli",
    "lamplight-wgpu",
    "lamplight-generate",
    "lamplight-page",
    "xtask",
];

/// Other plugins for Bevy, side by side with ours: with theirs, all of Bevy would be built again.
const BENCH: &str = "bevy_lamplight_bench";

/// The program that prints the shaders.
const GENERATE: &str = "lamplight-generate";

/// Packages whose tests all need a GPU.
const OF_THE_GPU: [&str; 2] = ["lamplight-wgpu", "bevy_lamplight"];
/// Beginning of the names of the other tests that need one.
const ON_THE_GPU: &str = "on_the_gpu";
/// Beginning of the names of tests that only measure times.
const TIMES: &str = "times_of";

/// Runs the first tier, or everything; without a GPU, what needs none.
pub fn run(all: bool, with_gpu: bool) -> Result<()> {
    let mut steps = Steps::new();
    if has_component("fmt", "rustfmt") {
        steps.step("format", || cargo(&["fmt", "--all", "--check"]))?;
    }
    steps.step("lints of our own", || lint::run(false, false))?;
    // With everything else they take too long for one job: `cargo xtask test --lints` is another.
    if !all && has_component("clippy", "clippy") {
        steps.step("lints", || clippy(&all_targets(false)))?;
    }
    let mut tests = vec!["test"];
    tests.extend(packages(all, with_gpu));
    let documentation = [&tests[..], &["--doc", "--quiet"]].concat();
    // Examples are compiled by the lints, and linking them takes minutes.
    tests.extend(["--lib", "--bins", "--tests"]);
    let compile = [&tests[..], &["--no-run"]].concat();
    steps.step("compiling the tests", || cargo(&compile))?;
    if with_gpu {
        steps.step("a GPU", gpu::ensure)?;
    }
    if with_gpu && all {
        steps.step("a display", display::ensure)?;
    }
    // A full run takes an hour: it names every failure, not the first.
    tests.extend(all.then_some("--no-fail-fast"));
    tests.extend(["--quiet", "--"]);
    tests.extend(all.then_some("--include-ignored"));
    tests.extend(["--skip", TIMES]);
    if !with_gpu {
        tests.extend(["--skip", ON_THE_GPU]);
    }
    steps.step("tests", || cargo(&tests))?;
    steps.step("examples in the documentation", || cargo(&documentation))?;
    steps.step("the README's first command", readme::first_command)?;
    if all {
        page(&mut steps, Command::new(built(GENERATE)?))?;
        with_python(&mut steps, "the package for Python", python::test)?;
        steps.step("workflows", publish::workflows)?;
        steps.step("licences and known faults of dependencies", publish::dependencies)?;
        steps.step("compatibility with the last release", publish::compatibility)?;
        steps.step("packages", publish::packages)?;
    }
    steps.finish();
    Ok(())
}

/// Runs Clippy on everything, natively and for the web.
pub fn lints() -> Result<()> {
    let mut steps = Steps::new();
    if !has_component("clippy", "clippy") {
        bail!("the lints need Clippy");
    }
    steps.step("lints", || clippy(&all_targets(true)))?;
    steps.step("lints of the web pages", || {
        web::ensure_target()?;
        [web::SANDBOX, web::BEVY].iter().try_for_each(|page| clippy(&page.program()))
    })?;
    with_python(&mut steps, "lints of the package for Python", python::lints)?;
    steps.finish();
    Ok(())
}

/// Cargo's arguments that select a tier's packages with their tests, examples and benches.
fn all_targets(all: bool) -> Vec<&'static str> {
    [&["--all-targets"], &packages(all, true)[..]].concat()
}

/// Runs Clippy on what Cargo's arguments select, and takes its warnings for errors.
fn clippy(selected: &[&str]) -> Result<()> {
    cargo(&[&["clippy"], selected, &["--", "-D", "warnings"]].concat())
}

/// Runs a step in an environment of Python's, or says that it is left out.
fn with_python(
    steps: &mut Steps,
    name: &str,
    work: impl FnOnce(&Environment) -> Result<()>,
) -> Result<()> {
    let Some(environment) = Environment::new()? else {
        println!("== the package for Python is left out; it needs {}", python::NEEDED);
        return Ok(());
    };
    steps.step(name, || work(&environment))
}

/// Builds the package for Python, and tests it.
pub fn python() -> Result<()> {
    let mut steps = Steps::new();
    let Some(environment) = Environment::new()? else {
        bail!("the package needs {}", python::NEEDED);
    };
    steps.step("the package for Python", || python::test(&environment))?;
    steps.finish();
    Ok(())
}

/// Builds the page of the sandbox, and uses it in a browser.
pub fn web() -> Result<()> {
    let mut steps = Steps::new();
    page(&mut steps, program(GENERATE))?;
    steps.finish();
    Ok(())
}

/// Builds the page of the sandbox, and uses it in a browser.
fn page(steps: &mut Steps, generate: Command) -> Result<()> {
    steps.step("the web page", || web::SANDBOX.build().map(|_| ()))?;
    steps.step("the web page in a browser", || browser::test(&web::SANDBOX.folder()?, generate))
}

/// Cargo's arguments that select a tier's packages.
fn packages(all: bool, with_gpu: bool) -> Vec<&'static str> {
    let skipped = |package: &&str| !with_gpu && OF_THE_GPU.contains(package);
    if all {
        let excluded = OF_THE_GPU.into_iter().filter(|package| skipped(package)).chain([BENCH]);
        ["--workspace"].into_iter().chain(excluded.flat_map(|p| ["--exclude", p])).collect()
    } else {
        LIGHT.into_iter().filter(|p| !skipped(p)).flat_map(|p| ["--package", p]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packages_of_the_gpu_are_left_out_without_one() {
        assert!(packages(false, true).contains(&"lamplight-wgpu"));
        assert!(!packages(false, false).contains(&"lamplight-wgpu"));
        assert_eq!(packages(true, true), ["--workspace", "--exclude", BENCH]);
        assert_eq!(packages(true, false).len(), 7);
    }
}
