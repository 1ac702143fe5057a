//! Why the canvas refuses something.

use super::Canvas;

/// Why something was refused; the messages can be shown as they are.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A scene, a lamp or a size that lamplight refuses.
    #[error(transparent)]
    Scene(#[from] lamplight::Error),
    /// More cells than a canvas has.
    #[error("{width}×{height} cells are more than a canvas has, {}", Canvas::MAX_CELLS)]
    Cells {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// An image with more px than are read.
    #[error(
        "an image of {width}×{height} px is refused: it may have {} px at most",
        Canvas::MAX_PIXELS
    )]
    Pixels {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// Bytes that are no image, or a broken one.
    #[error("this image cannot be read: {0}")]
    Image(String),
    /// A text or file that is too long.
    #[error("this file has {found} bytes; at most {most} are read")]
    Long {
        /// Bytes found.
        found: usize,
        /// Most that are read.
        most: usize,
    },
    /// More lamps than a canvas has.
    #[error("{0} lamps are more than a canvas has, {most}", most = Canvas::MAX_LAMPS)]
    Lamps(usize),
    /// There is no lamp of this number.
    #[error("there is no lamp {0}")]
    NoLamp(usize),
}

/// Shorthand for results of the canvas.
pub type Result<T, E = Error> = std::result::Result<T, E>;
