//! The command line of `cargo xtask`.

use crate::docs::Part;
use anyhow::{Result, bail};
use lexopt::prelude::*;
use std::ffi::OsString;

pub const HELP: &str = "\
The project's chores: cargo xtask CHORE

  test             Format, lints, tests of the light crates, generated files, the README's first command
    --all          and Bevy, the sandbox, its web page, slow tests, dependencies, packages, but no Clippy
    --lints        only Clippy, of everything
    --python       only the package for Python, in an environment of its own
    --web          only the web page, in a browser
    --without-gpu  without the tests that need a GPU, a software one at least
  lint             Rules of this project's source that Clippy does not have
    --baseline     write the numbers of findings that are left, if none has grown
    --list         print every finding that is left, with its file and line
  web              The sandbox as a web page, in target/web/
    --bevy         an example for Bevy instead
    --serve[=PORT] serve it to this machine, at port 8080 or another
  docs             The documents' pictures and figures
    --only PART    only pictures, or the figures of one page: readme, holographic, cascades, polar, flood,
                   methods, raymarch, gpu
    --sandbox      only pictures of the sandbox
    --bevy         only pictures of the examples for Bevy
  scenes           The example scenes
  noise            The blue-noise texture
  schema           The JSON Schema of scene files, and the table of materials
    --check        (any of these three) Write nothing; fail if a file is out of date
";

/// The port of `web --serve`.
const PORT: u16 = 8080;

/// A chore and its flags.
#[derive(Debug, PartialEq)]
pub enum Chore {
    Help,
    Test { all: bool, only: Only, gpu: bool },
    Lint { baseline: bool, list: bool },
    Web { bevy: bool, serve: Option<u16> },
    Docs(Part),
    Generate { what: &'static str, check: bool },
}

/// The part of the tests that runs alone.
#[derive(Debug, PartialEq)]
pub enum Only {
    Nothing,
    Lints,
    Python,
    Web,
}

/// Reads the arguments after the program's name.
pub fn parse(arguments: impl IntoIterator<Item = OsString>) -> Result<Chore> {
    let mut parser = lexopt::Parser::from_args(arguments);
    let mut chore = match parser.next()? {
        None | Some(Short('h') | Long("help")) => return Ok(Chore::Help),
        Some(Value(name)) => match name.to_str() {
            Some("test") => Chore::Test { all: false, only: Only::Nothing, gpu: true },
            Some("lint") => Chore::Lint { baseline: false, list: false },
            Some("web") => Chore::Web { bevy: false, serve: None },
            Some("docs") => Chore::Docs(Part::All),
            Some("scenes") => Chore::Generate { what: "scenes", check: false },
            Some("noise") => Chore::Generate { what: "noise", check: false },
            Some("schema") => Chore::Generate { what: "schema", check: false },
            _ => bail!("there is no chore {}; see cargo xtask --help", name.display()),
        },
        Some(flag) => return Err(flag.unexpected().into()),
    };
    while let Some(flag) = parser.next()? {
        if matches!(flag, Short('h') | Long("help")) {
            return Ok(Chore::Help);
        }
        match (&mut chore, flag) {
            (Chore::Test { all, .. }, Long("all")) => *all = true,
            (Chore::Test { only, .. }, Long("lints")) => *only = Only::Lints,
            (Chore::Test { only, .. }, Long("python")) => *only = Only::Python,
            (Chore::Test { only, .. }, Long("web")) => *only = Only::Web,
            (Chore::Test { gpu, .. }, Long("without-gpu")) => *gpu = false,
            (Chore::Lint { baseline, .. }, Long("baseline")) => *baseline = true,
            (Chore::Lint { list, .. }, Long("list")) => *list = true,
            (Chore::Web { bevy, .. }, Long("bevy")) => *bevy = true,
            (Chore::Web { serve, .. }, Long("serve")) => {
                *serve = Some(parser.optional_value().map_or(Ok(PORT), |port| port.parse())?);
            }
            // `--serve PORT`.
            (Chore::Web { serve: Some(port), .. }, Value(text)) => *port = text.parse()?,
            (Chore::Docs(part @ Part::All), Long("only")) => {
                *part = Part::Generated(parser.value()?.string()?);
            }
            (Chore::Docs(part @ Part::All), Long("sandbox")) => *part = Part::Sandbox,
            (Chore::Docs(part @ Part::All), Long("bevy")) => *part = Part::Bevy,
            (Chore::Generate { check, .. }, Long("check")) => *check = true,
            (_, flag) => return Err(flag.unexpected().into()),
        }
    }
    Ok(chore)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Result<Chore> {
        parse(line.split_whitespace().map(OsString::from))
    }

    #[test]
    fn every_chore_takes_its_flags() {
        for (line, chore) in [
            ("", Chore::Help),
            ("--help", Chore::Help),
            ("web --help", Chore::Help),
            ("test", Chore::Test { all: false, only: Only::Nothing, gpu: true }),
            (
                "test --all --without-gpu",
                Chore::Test { all: true, only: Only::Nothing, gpu: false },
            ),
            ("test --lints", Chore::Test { all: false, only: Only::Lints, gpu: true }),
            ("test --web", Chore::Test { all: false, only: Only::Web, gpu: true }),
            ("test --python", Chore::Test { all: false, only: Only::Python, gpu: true }),
            ("lint --list", Chore::Lint { baseline: false, list: true }),
            ("web --serve", Chore::Web { bevy: false, serve: Some(PORT) }),
            ("web --serve 80 --bevy", Chore::Web { bevy: true, serve: Some(80) }),
            ("web --serve --bevy", Chore::Web { bevy: true, serve: Some(PORT) }),
            ("web --serve=80", Chore::Web { bevy: false, serve: Some(80) }),
            ("docs --only gpu", Chore::Docs(Part::Generated("gpu".to_owned()))),
            ("noise --check", Chore::Generate { what: "noise", check: true }),
        ] {
            assert_eq!(read(line).unwrap(), chore, "{line}");
        }
    }

    #[test]
    fn what_is_no_chore_or_flag_is_refused() {
        for line in [
            "paint",
            "--all",
            "test --check",
            "docs --only gpu --bevy",
            "web --serve no",
            "scenes x",
        ] {
            assert!(read(line).is_err(), "{line}");
        }
    }
}
