//! `lamplight completions`, `man` and `schema`: what shells, pagers and editors read.

use super::Cli;
use crate::failure::{Failure, Outcome};
use crate::output;
use clap::CommandFactory;
use clap_complete::Shell;
use lamplight::Scene;

/// Print completions for a shell
#[derive(clap::Args, Debug)]
pub struct CompletionsArgs {
    /// The shell
    shell: Shell,
}

pub fn completions(args: CompletionsArgs) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "lamplight", &mut script);
    output::print(String::from_utf8_lossy(&script).trim_end())
}

/// Print the manual page, of all or of one command
#[derive(clap::Args, Debug)]
pub struct ManArgs {
    /// The command
    command: Option<String>,
}

pub fn man(args: ManArgs) -> Outcome {
    let mut cli = Cli::command();
    cli.build();
    let command = match &args.command {
        None => cli,
        Some(name) => {
            let command = cli.find_subcommand(name).cloned().ok_or_else(|| {
                Failure::bad_input(format_args!("there is no command `{name}`"))
                    .hint("`lamplight help` lists the commands")
            })?;
            command.display_name(format!("lamplight-{name}"))
        }
    };
    let mut page = Vec::new();
    clap_mangen::Man::new(command).render(&mut page).map_err(Failure::failed)?;
    output::print(String::from_utf8_lossy(&page).trim_end())
}

/// Print the JSON Schema of scene files, for editors
#[derive(clap::Args, Debug)]
pub struct SchemaArgs {}

pub fn schema(_: SchemaArgs) -> Outcome {
    output::print(serde_json::to_string_pretty(&Scene::schema()).map_err(Failure::failed)?)
}
