//! The error type of commands: a message, a hint, and the exit code.

use anstyle::{AnsiColor, Style};
use lamplight::maps::MapWorld;
use std::fmt::Display;

/// The result of a command or a part of one.
pub type Result<T = (), E = CliError> = std::result::Result<T, E>;

/// The reason why a command ended early.
#[derive(Debug)]
pub struct CliError {
    cause: Cause,
    message: String,
    hint: Option<String>,
}

#[derive(Clone, Copy, Debug)]
enum Cause {
    /// The request cannot be met on any machine: exit code 2.
    BadInput,
    /// The request failed here: exit code 1.
    Failed,
    /// There is nothing left to print: this exit code.
    Silent(u8),
}

impl CliError {
    /// An error for bad input or usage.
    pub fn bad_input(message: impl Display) -> Self {
        Self { cause: Cause::BadInput, message: message.to_string(), hint: None }
    }

    /// An error for a valid request that failed.
    pub fn failed(message: impl Display) -> Self {
        Self { cause: Cause::Failed, message: message.to_string(), hint: None }
    }

    /// The end of a command whose stdout nobody reads any more, as `head` leaves it: exit code 0.
    pub fn reader_left() -> Self {
        Self::silent(0)
    }

    /// The end of a command that has printed everything already.
    pub fn silent(code: u8) -> Self {
        Self { cause: Cause::Silent(code), message: String::new(), hint: None }
    }

    /// Adds advice for the user.
    pub fn hint(mut self, hint: impl Display) -> Self {
        self.hint = Some(hint.to_string());
        self
    }

    /// The message of a request that cannot be met; any other error is passed on.
    pub fn refusal(self) -> Result<String> {
        match self.cause {
            Cause::BadInput => Ok(self.message),
            Cause::Failed | Cause::Silent(_) => Err(self),
        }
    }

    /// Prints the error to stderr and returns the exit code.
    pub fn report(self) -> u8 {
        let code = match self.cause {
            Cause::Silent(code) => return code,
            Cause::Failed => 1,
            Cause::BadInput => 2,
        };
        print_labelled(AnsiColor::Red, "error", &self.message);
        if let Some(hint) = self.hint {
            print_labelled(AnsiColor::Cyan, "hint", &hint);
        }
        code
    }
}

/// Prints a warning to stderr.
pub fn warn(message: &str) {
    print_labelled(AnsiColor::Yellow, "warning", message);
}

/// Prints a line to stderr, coloured on a terminal unless `NO_COLOR` is set. A closed stderr is not
/// an error.
fn print_labelled(color: AnsiColor, label: &str, message: &str) {
    use std::io::Write;
    let style = Style::new().bold().fg_color(Some(color.into()));
    let _ = writeln!(anstream::stderr(), "{style}{label}:{style:#} {message}");
}

impl From<lamplight::Error> for CliError {
    fn from(error: lamplight::Error) -> Self {
        let refused = Self::bad_input(&error);
        match error {
            lamplight::Error::Read { path, source }
                if source.kind() == std::io::ErrorKind::NotFound =>
            {
                if path.as_os_str() == "-" {
                    return refused.hint("name a file; /dev/stdin reads a scene from a pipe");
                }
                if MapWorld::reads(&path) {
                    return refused;
                }
                let scene = path.with_extension("toml");
                let scene = scene.display();
                refused.hint(format_args!("`lamplight new {scene}` writes a scene to start from"))
            }
            _ => refused,
        }
    }
}
