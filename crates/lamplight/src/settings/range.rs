//! The check of a number against its range.

use crate::{Error, Result};
use std::fmt::Display;
use std::ops::RangeInclusive;

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
