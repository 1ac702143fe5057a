//! The check of a number against its range.

use crate::{Error, Result};
use std::fmt::Display;
use std::ops::RangeInclusive;

/// The largest depth in px to which light may penetrate walls.
pub const MAX_WALL_DEPTH: f32 = 64.0;
/// The default `wall_depth`, px: soft, and deep enough for blocks of 32 px.
pub const WALL_DEPTH: f32 = 24.0;

/// Rejects a value out of its range.
pub fn within<T: PartialOrd + Display>(
    key: &str,
    value: T,
    range: RangeInclusive<T>,
) -> Result<()> {
    if range.contains(&value) {
        return Ok(());
    }
    Err(Error::value(key, value, format!("from {} to {}", range.start(), range.end())))
}
