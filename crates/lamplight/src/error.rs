//! Everything that can go wrong, as one typed enum.
//!
//! Messages name what is wrong, where, the value found and what would be right, so that they can
//! be shown to a user as they are.

use crate::limits::{MAX_CELLS, MAX_SIDE};
use std::path::{Path, PathBuf};

/// Shorthand for results of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// The reason why a scene, a grid or a setting was rejected.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read from disk.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: std::io::Error,
    },
    /// A file has the wrong format (not TOML, JSON or PNG) or is truncated.
    #[error("cannot read {}: {problem}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// A description of the problem, with line and column if known.
        problem: String,
    },
    /// A value is out of range, of the wrong type, or unknown.
    #[error("`{key}` is {value}, but must be {expected}")]
    Value {
        /// The key as it is written in a file, such as `shape[2].circle.radius`.
        key: String,
        /// The value found.
        value: String,
        /// A description of valid values.
        expected: String,
    },
    /// A key is unknown, missing or duplicated.
    #[error("`{key}` {problem}")]
    Key {
        /// The key as it is written in a file.
        key: String,
        /// A description of the problem, with the valid keys.
        problem: String,
    },
    /// A text is not TOML or not JSON.
    #[error("line {line}, column {column}: {problem}")]
    Syntax {
        /// The line, from 1.
        line: usize,
        /// The column in characters, from 1.
        column: usize,
        /// A description of the problem.
        problem: String,
    },
    /// Another error, with the line of the text that it was found in.
    #[error("line {line}: {source}")]
    AtLine {
        /// The line, from 1.
        line: usize,
        /// The underlying error.
        source: Box<Error>,
    },
    /// Another error, with the key that led to it, such as the layer whose image is missing.
    #[error("`{key}`: {source}")]
    Under {
        /// The key.
        key: String,
        /// The underlying error.
        source: Box<Error>,
    },
    /// Another error, with the file that it was found in.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// The underlying error.
        source: Box<Error>,
    },
    /// A cell of the grid holds an invalid value.
    #[error("cell ({x}, {y}): {field} is {value}, but must be {expected}")]
    Cell {
        /// Column.
        x: u32,
        /// Row.
        y: u32,
        /// The field of the cell.
        field: &'static str,
        /// The value found.
        value: f32,
        /// A description of valid values.
        expected: &'static str,
    },
    /// A grid is empty or larger than this program accepts.
    #[error(
        "a grid of {width}×{height} cells is refused: each side must be 1 to {}, and the product at most {}",
        MAX_SIDE,
        MAX_CELLS
    )]
    Size {
        /// The requested number of columns.
        width: u64,
        /// The requested number of rows.
        height: u64,
    },
    /// A method cannot light the scene: its picture would be black.
    #[error("{method} {problem}")]
    Unsuited {
        /// The method's name.
        method: &'static str,
        /// A description of the missing part, and a remedy.
        problem: &'static str,
    },
}

impl Error {
    /// An invalid value under a key.
    pub fn value(
        key: impl Into<String>,
        value: impl ToString,
        expected: impl Into<String>,
    ) -> Self {
        Self::Value { key: key.into(), value: value.to_string(), expected: expected.into() }
    }

    /// Adds the key that led to the error. An invalid value under a relative key gets the full key.
    pub fn under(self, key: &str) -> Self {
        match self {
            Self::Value { key: inner, value, expected } => {
                Self::Value { key: format!("{key}.{inner}"), value, expected }
            }
            Self::Key { key: inner, problem } => {
                Self::Key { key: format!("{key}.{inner}"), problem }
            }
            other => Self::Under { key: key.to_owned(), source: Box::new(other) },
        }
    }

    /// Adds the file in which the error was found.
    pub fn in_file(self, path: &Path) -> Self {
        match self {
            Self::InFile { .. } | Self::Read { .. } | Self::Format { .. } => self,
            other => Self::InFile { path: path.to_owned(), source: Box::new(other) },
        }
    }
}
