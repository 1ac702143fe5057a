//! Checks of single values under a key, shared by shapes, lamps and layers.

use crate::{Error, Result, Rgb};
use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::Path;

/// The farthest coordinate, px. Beyond it, single precision would blur the edges of cells.
const FAR: f32 = 1e6;
/// The brightest radiance of matter and of the sky. Products of two such values still fit single precision.
pub const BRIGHT: f32 = 1e12;

/// 2π, rounded up to four digits.
#[expect(clippy::approx_constant, reason = "6.2832 in a file means the whole circle")]
pub(crate) const TURN: f32 = 6.2832;

/// Checks a direction, radians.
pub(crate) fn direction(key: impl Display, value: f32) -> Result<()> {
    number(key, value, -TURN..=TURN)
}

/// Checks that a number is in a range; NaN is in none.
pub(crate) fn number(key: impl Display, value: f32, range: RangeInclusive<f32>) -> Result<()> {
    if range.contains(&value) {
        return Ok(());
    }
    let expected = format!("a number from {} to {}", range.start(), range.end());
    Err(Error::value(key.to_string(), value, expected))
}

/// Checks a length: more than 0.
pub(crate) fn length(key: impl Display, value: f32) -> Result<()> {
    if value > 0.0 && value <= FAR {
        return Ok(());
    }
    Err(Error::value(key.to_string(), value, format!("more than 0 and at most {FAR} px")))
}

/// Checks the coordinates of a point.
pub(crate) fn point(key: impl Display, [x, y]: [f32; 2]) -> Result<()> {
    let range = -FAR..=FAR;
    if range.contains(&x) && range.contains(&y) {
        return Ok(());
    }
    let expected = format!("two numbers from -{FAR} to {FAR}");
    Err(Error::value(key.to_string(), format!("[{x}, {y}]"), expected))
}

/// Checks the path of an image. Whether there is one is seen when it is read.
pub(crate) fn image(key: impl Display, path: &Path) -> Result<()> {
    if !path.as_os_str().is_empty() {
        return Ok(());
    }
    Err(Error::value(key.to_string(), "empty", "the path of an image"))
}

/// Checks a radiance.
pub(crate) fn radiance(key: impl Display, rgb: Rgb) -> Result<()> {
    channels(key, rgb, 0.0..=BRIGHT, "three numbers from 0 to 1e12")
}

/// Checks fractions: 0 to 1 in each channel.
pub(crate) fn unit(key: impl Display, rgb: Rgb) -> Result<()> {
    channels(key, rgb, 0.0..=1.0, "three numbers from 0 to 1")
}

fn channels(
    key: impl Display,
    rgb: Rgb,
    range: RangeInclusive<f32>,
    expected: &'static str,
) -> Result<()> {
    if rgb.iter().all(|v| range.contains(v)) {
        return Ok(());
    }
    let [r, g, b] = rgb;
    Err(Error::value(key.to_string(), format!("[{r}, {g}, {b}]"), expected))
}
