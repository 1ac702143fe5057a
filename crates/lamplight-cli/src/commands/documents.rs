//! `lamplight completions`, `man` and `schema`: documents for shells, pagers and editors.

use crate::error::{CliError, Result};
use crate::output;
use clap_complete::Shell;
use clap_mangen::Man;
use clap_mangen::roff::{Roff, bold, roman};
use lamplight::Scene;
use std::io;

/// Print completions for a shell
#[derive(clap::Args, Debug)]
pub struct CompletionsArgs {
    /// The shell
    shell: Shell,
}

pub fn completions(args: CompletionsArgs, mut cli: clap::Command) -> Result {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut cli, "lamplight", &mut script);
    output::print(String::from_utf8_lossy(&script).trim_end())
}

/// Print the manual page of the program or of one command
#[derive(clap::Args, Debug)]
pub struct ManArgs {
    /// The command [default: the whole program]
    command: Option<String>,
}

pub fn man(args: ManArgs, mut cli: clap::Command) -> Result {
    cli.build();
    let commands: Vec<String> = cli.get_subcommands().map(|c| c.get_name().to_owned()).collect();
    let (command, name) = match &args.command {
        None => (cli, "lamplight".to_owned()),
        Some(name) => {
            let command = cli.find_subcommand(name).cloned().ok_or_else(|| {
                CliError::bad_input(format_args!("there is no command `{name}`"))
                    .hint("`lamplight help` lists the commands")
            })?;
            let name = format!("lamplight-{name}");
            (command.display_name(name.clone()), name)
        }
    };
    let page = manual_page(command, &name, &commands).map_err(CliError::failed)?;
    output::print(String::from_utf8_lossy(&page).trim_end())
}

/// The manual page of a command called `name`, in the sections that readers expect.
fn manual_page(command: clap::Command, name: &str, commands: &[String]) -> io::Result<Vec<u8>> {
    let mut page = Vec::new();
    let is_program = command.has_subcommands();
    let man = Man::new(command.clone())
        .title(name.to_uppercase())
        .source(concat!("lamplight ", env!("CARGO_PKG_VERSION")))
        .manual("lamplight manual");
    man.render_title(&mut page)?;
    man.render_name_section(&mut page)?;
    man.render_synopsis_section(&mut page)?;
    man.render_description_section(&mut page)?;
    man.render_options_section(&mut page)?;
    if is_program {
        man.render_subcommands_section(&mut page)?;
    }
    let mut end = Roff::default();
    end.control("SH", ["EXIT STATUS"]);
    for (code, meaning) in EXIT_STATUS {
        end.control("TP", []).text([bold(*code)]).text([roman(*meaning)]);
    }
    let examples: Vec<_> =
        EXAMPLES.iter().filter(|(of, ..)| is_program || name.ends_with(of)).collect();
    if !examples.is_empty() {
        end.control("SH", ["EXAMPLES"]);
        for (_, line, meaning) in examples {
            end.control("TP", []).text([bold(*line)]).text([roman(*meaning)]);
        }
    }
    end.control("SH", ["SEE ALSO"]);
    let others = commands.iter().map(|command| format!("lamplight-{command}"));
    let others = others.chain(["lamplight".to_owned()]).filter(|other| other != name);
    let others: Vec<_> = others.map(|other| format!("{other}(1)")).collect();
    end.text([roman(others.join(", "))]);
    end.to_writer(&mut page)?;
    Ok(page)
}

/// Exit codes and their meanings.
const EXIT_STATUS: &[(&str, &str)] = &[
    ("0", "Done."),
    ("1", "Failed, for example because a file cannot be written."),
    ("2", "Bad input or usage."),
    ("130, 143, 129", "Stopped by Ctrl-C, SIGTERM or SIGHUP; no file is left half-written."),
];

/// Commands, command lines, and what they do.
const EXAMPLES: &[(&str, &str, &str)] = &[
    ("new", "lamplight new cave.toml", "Write a commented scene to start from."),
    ("render", "lamplight render cave.toml", "Light it: cave.png."),
    (
        "render",
        "lamplight render cave.toml --stage light -o cave.exr",
        "Write the light alone, as linear floats.",
    ),
    (
        "render",
        "lamplight render cave.toml --quality high --bounces 3 --scale 4",
        "Light it more accurately, and show each cell as 4×4 pixels.",
    ),
    ("compare", "lamplight compare cave.toml --report report", "Compare all methods, with a page."),
    (
        "stages",
        "lamplight stages cave.toml -o stages",
        "Write every stage of a frame as a picture.",
    ),
    ("probe", "lamplight probe cave.toml 160,90 --json", "Print the light at a point."),
    (
        "sight",
        "lamplight sight cave.toml --from 160,90 -o seen.png",
        "Draw what is seen from a point.",
    ),
    ("bench", "lamplight bench --method holographic --size 512x512", "Time a method."),
    (
        "completions",
        "lamplight completions bash > ~/.local/share/bash-completion/completions/lamplight",
        "Complete commands and flags in bash.",
    ),
    ("man", "lamplight man render | man -l -", "Read the manual page of a command."),
    ("schema", "lamplight schema > scene.schema.json", "Write the schema for editors."),
];

/// Print the JSON Schema of scene files, for editors
#[derive(clap::Args, Debug)]
pub struct SchemaArgs {}

pub fn schema(_: SchemaArgs) -> Result {
    output::print(serde_json::to_string_pretty(&Scene::schema()).map_err(CliError::failed)?)
}
