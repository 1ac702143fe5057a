//! Errors of the canvas.

use super::limits::{MAX_CELLS, MAX_LAMPS, MAX_PIXELS};

/// An error of the canvas. Its message is meant for users.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A scene, a lamp or a size that `lamplight` rejects.
    #[error(transparent)]
    Scene(#[from] lamplight::Error),
    /// Too many cells.
    #[error("{width}×{height} cells are too many: a canvas has at most {}", MAX_CELLS)]
    Cells {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// Too many pixels in an image.
    #[error("an image of {width}×{height} px is refused: it may have {} px at most", MAX_PIXELS)]
    Pixels {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// Not an image, or a broken one.
    #[error("this image cannot be read: {0}")]
    Image(String),
    /// Too long a file.
    #[error("this file has {found} bytes; at most {most} are read")]
    Long {
        /// Length in bytes.
        found: usize,
        /// Largest length in bytes.
        most: usize,
    },
    /// Too many lamps.
    #[error("{0} lamps are too many: a canvas has at most {most}", most = MAX_LAMPS)]
    Lamps(usize),
    /// No lamp of this index.
    #[error("there is no lamp {0}")]
    NoLamp(usize),
}

/// The result type of the canvas.
pub type Result<T, E = Error> = std::result::Result<T, E>;
