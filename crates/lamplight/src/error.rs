//! Everything that can go wrong, as one typed enum.
//!
//! Messages name what is wrong, where, the value found and what would be right, so that they can
//! be shown to a user as they are.

use std::path::{Path, PathBuf};

/// Shorthand for results of this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// Why a scene, a grid or a setting was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read from disk.
    #[error("cannot read {}: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// A file is not what it should be (not TOML, not JSON, not a PNG, cut short).
    #[error("cannot read {}: {problem}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// What is wrong with it, with line and column where known.
        problem: String,
    },
    /// A value is out of its range, of the wrong kind, or not known.
    #[error("`{key}` is {value}, but must be {expected}")]
    Value {
        /// The key as it is written in a file, such as `shape[2].circle.radius`.
        key: String,
        /// The value found.
        value: String,
        /// What would be right.
        expected: String,
    },
    /// A key is not known, is missing, or is there twice.
    #[error("`{key}` {problem}")]
    Key {
        /// The key as it is written in a file.
        key: String,
        /// What is wrong with it, and which keys there are.
        problem: String,
    },
    /// A text is not TOML or not JSON.
    #[error("line {line}, column {column}: {problem}")]
    Syntax {
        /// The line, from 1.
        line: usize,
        /// The column in characters, from 1.
        column: usize,
        /// What is wrong there.
        problem: String,
    },
    /// Another error, with the line of the text that it was found in.
    #[error("line {line}: {source}")]
    AtLine {
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        source: Box<Error>,
    },
    /// Another error, with the key that led to it, such as the layer whose image is missing.
    #[error("`{key}`: {source}")]
    Under {
        /// The key.
        key: String,
        /// What is wrong.
        source: Box<Error>,
    },
    /// Another error, with the file that it was found in.
    #[error("{}: {source}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: Box<Error>,
    },
    /// A cell of the grid holds a value that is not light or matter.
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
        /// What would be right.
        expected: &'static str,
    },
    /// A grid is empty or larger than this program accepts.
    #[error(
        "a grid of {width}×{height} cells is refused: each side must be 1 to {}, and the product at most {}",
        crate::Cells::MAX_SIDE,
        crate::Cells::MAX_CELLS
    )]
    Size {
        /// Columns asked for.
        width: u64,
        /// Rows asked for.
        height: u64,
    },
    /// A method cannot use what the scene has: its picture would be black.
    #[error("{method} {problem}")]
    Unsuited {
        /// The method's name.
        method: &'static str,
        /// What it needs, what is missing, and what would be right.
        problem: &'static str,
    },
}

impl Error {
    /// A bad value under a key.
    pub fn value(
        key: impl Into<String>,
        value: impl ToString,
        expected: impl Into<String>,
    ) -> Self {
        Self::Value { key: key.into(), value: value.to_string(), expected: expected.into() }
    }

    /// The same error with the key that led to it. A bad value under a relative key has its key
    /// completed.
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

    /// The same error with the file it was found in.
    pub fn in_file(self, path: &Path) -> Self {
        match self {
            Self::InFile { .. } | Self::Read { .. } | Self::Format { .. } => self,
            other => Self::InFile { path: path.to_owned(), source: Box::new(other) },
        }
    }
}
