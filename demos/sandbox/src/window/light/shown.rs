//! The options of a shown light: its display, and the way in which pixels are drawn.

use lamplight::Display;

/// Display options of the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shown {
    pub display: Display,
    /// The light alone, on white.
    pub light_alone: bool,
    /// True if light is interpolated between cells.
    pub smooth: bool,
}
