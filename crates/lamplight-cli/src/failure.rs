//! Why a command ended early: the message, what to do about it, and the exit code.

use anstyle::{AnsiColor, Style};
use std::fmt::Display;
use std::process::ExitCode;

/// What a command ends in.
pub type Outcome<T = ()> = Result<T, Failure>;

/// A command that did not do what was asked.
#[derive(Debug)]
pub struct Failure {
    kind: Kind,
    message: String,
    hint: Option<String>,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    /// What was asked cannot be done to anything: exit code 2.
    BadInput,
    /// It could have worked: exit code 1.
    Failed,
    /// Whoever read stdout has left, as `head` does: nothing to say, exit code 0.
    ReaderLeft,
}

impl Failure {
    /// Bad input or usage.
    pub fn bad_input(message: impl Display) -> Self {
        Self { kind: Kind::BadInput, message: message.to_string(), hint: None }
    }

    /// Something that should have worked did not.
    pub fn failed(message: impl Display) -> Self {
        Self { kind: Kind::Failed, message: message.to_string(), hint: None }
    }

    /// The reader of stdout is gone.
    pub fn reader_left() -> Self {
        Self { kind: Kind::ReaderLeft, message: String::new(), hint: None }
    }

    /// Adds what the user may do about it.
    pub fn hint(mut self, hint: impl Display) -> Self {
        self.hint = Some(hint.to_string());
        self
    }

    /// Why what was asked cannot be done, where that is what is wrong.
    pub fn refusal(self) -> Outcome<String> {
        match self.kind {
            Kind::BadInput => Ok(self.message),
            Kind::Failed | Kind::ReaderLeft => Err(self),
        }
    }

    /// Says what is wrong on stderr and gives the exit code.
    pub fn report(self) -> ExitCode {
        let code = match self.kind {
            Kind::ReaderLeft => return ExitCode::SUCCESS,
            Kind::Failed => 1,
            Kind::BadInput => 2,
        };
        label(AnsiColor::Red, "error", &self.message);
        if let Some(hint) = self.hint {
            label(AnsiColor::Cyan, "hint", &hint);
        }
        ExitCode::from(code)
    }
}

/// Says something on stderr that does not end the command.
pub fn warn(message: &str) {
    label(AnsiColor::Yellow, "warning", message);
}

/// A line on stderr; coloured on a terminal unless `NO_COLOR` is set. A stderr that nobody reads
/// is no reason to fail.
fn label(color: AnsiColor, word: &str, message: &str) {
    use std::io::Write;
    let style = Style::new().bold().fg_color(Some(color.into()));
    let _ = writeln!(anstream::stderr(), "{style}{word}:{style:#} {message}");
}

impl From<lamplight::Error> for Failure {
    fn from(error: lamplight::Error) -> Self {
        let failure = Self::bad_input(&error);
        match error {
            lamplight::Error::Read { path, source }
                if source.kind() == std::io::ErrorKind::NotFound =>
            {
                let path = path.display();
                failure.hint(format_args!("`lamplight new {path}` writes a scene to start from"))
            }
            _ => failure,
        }
    }
}
