//! Light masks: which lamp lights which layer.
//!
//! A mask is a set of layers, a bit each. Lamps and suns have one, and so have cells. A lamp lights a cell, or the faces
//! of a solid one, if both have a layer in common. There are eight layers, so that a grey picture holds the mask of every
//! cell in a byte. Masks decide who receives direct light; all matter throws shadows, and light that is reflected,
//! scattered or emitted by matter goes everywhere.

use crate::{Error, Result};
use std::fmt::Display;

/// The mask of all layers.
pub const ALL_LAYERS: u8 = u8::MAX;

/// The masks that there are.
pub(crate) const EXPECTED: &str = "a whole number from 1 to 255";

/// Returns [`ALL_LAYERS`], the mask of what a file gives none.
pub(crate) fn all_layers() -> u8 {
    ALL_LAYERS
}

/// Returns whether a mask is that of all layers.
pub(crate) fn is_all(mask: &u8) -> bool {
    *mask == ALL_LAYERS
}

/// Checks that a mask has a layer.
pub(crate) fn check(key: impl Display, mask: u8) -> Result<()> {
    if mask == 0 { Err(Error::value(key.to_string(), mask, EXPECTED)) } else { Ok(()) }
}
