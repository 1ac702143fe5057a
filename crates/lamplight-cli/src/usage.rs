//! The command line as typed, with hints for what users often try.

use crate::commands::Cli;
use crate::error::{CliError, Result};
use clap::error::{ContextKind, ContextValue, Error, ErrorKind};
use clap::{Arg, CommandFactory, FromArgMatches};
use std::borrow::Cow;
use std::ffi::OsString;

/// Parses the command line, which begins with the program's name. Help, versions and most errors are
/// printed by clap.
pub fn parse(arguments: &[OsString]) -> Result<Cli> {
    cli(arguments).map_err(|error| {
        let typed: Vec<_> = arguments.iter().skip(1).map(|a| a.to_string_lossy()).collect();
        match explain(error, &typed) {
            Explained::Ours(error) => error,
            Explained::Clap(error) => {
                // Nobody may be reading.
                let _ = error.print();
                CliError::silent(error.exit_code().try_into().unwrap_or(1))
            }
        }
    })
}

fn cli(arguments: &[OsString]) -> Result<Cli, Error> {
    // A number below 0 is a value: whatever reads it says which ones there are.
    let with_signs = |arg: Arg| {
        let takes_value = arg.get_action().takes_values() && !arg.is_positional();
        if takes_value { arg.allow_negative_numbers(true) } else { arg }
    };
    let mut command = Cli::command().mut_subcommands(|subcommand| subcommand.mut_args(with_signs));
    let mut matches = command.try_get_matches_from_mut(arguments)?;
    Cli::from_arg_matches_mut(&mut matches).map_err(|error| error.format(&mut command))
}

enum Explained {
    Ours(CliError),
    Clap(Error),
}

/// An error of clap with a better hint, or an error of ours in its place.
fn explain(mut error: Error, typed: &[Cow<str>]) -> Explained {
    let unknown = match (error.kind(), error.get(ContextKind::InvalidArg)) {
        (ErrorKind::UnknownArgument, Some(ContextValue::String(argument))) => argument.clone(),
        _ => return Explained::Clap(error),
    };
    let command = typed.first().map_or("", |text| text);
    // clap names `-5` of `-5,-5`.
    if let ("probe", Some(point)) = (command, typed.iter().find(|text| is_negative_point(text))) {
        let outside = format_args!("the point {point} lies outside the scene");
        return Explained::Ours(CliError::bad_input(outside).hint("x and y start at 0"));
    }
    let hint = match (command, unknown.as_str()) {
        (_, "--preset") => {
            "use '--quality fast', or a preset of a method: '--set holographic.preset=fast'"
        }
        ("probe", "--exposure" | "--tonemap") => {
            "probe prints linear light, to which neither exposure nor tone map applies"
        }
        ("render" | "stages" | "compare", argument) if !argument.starts_with('-') => {
            "one scene at a time: run the command once for each"
        }
        _ => return Explained::Clap(error),
    };
    error.insert(ContextKind::Suggested, ContextValue::StyledStrs(vec![hint.into()]));
    Explained::Clap(error)
}

/// True for two numbers with a comma between them, the first of them negative.
fn is_negative_point(text: &str) -> bool {
    let number = |text: &str| text.trim().parse::<f32>().is_ok();
    text.starts_with('-') && text.split_once(',').is_some_and(|(x, y)| number(x) && number(y))
}
