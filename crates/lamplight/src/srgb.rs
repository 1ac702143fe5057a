//! The sRGB curve (IEC 61966-2-1:1999), which maps linear light to values in files and on screens.
//!
//! Values are decoded once on the way in and encoded once on the way out; all maths is linear.

use crate::Rgb;
use std::sync::LazyLock;

/// The linear value up to which the curve is a straight line.
pub const STRAIGHT: f32 = 0.003_130_8;
/// The slope of the straight line.
pub const SLOPE: f32 = 12.92;
/// The offset of the curve above it, `(1 + OFFSET)·v^(1/GAMMA) − OFFSET`.
pub const OFFSET: f32 = 0.055;
/// The exponent of the curve.
pub const GAMMA: f32 = 2.4;

/// Decodes an sRGB value to a linear one, both 0 to 1. Values above 1 continue the curve, negative
/// ones the straight line.
pub fn decode(encoded: f32) -> f32 {
    if encoded <= 0.04045 {
        encoded / SLOPE
    } else {
        ((encoded + OFFSET) / (1.0 + OFFSET)).powf(GAMMA)
    }
}

/// Encodes a linear value as sRGB: the inverse of [`decode`].
pub fn encode(linear: f32) -> f32 {
    if linear <= STRAIGHT {
        linear * SLOPE
    } else {
        (1.0 + OFFSET) * linear.powf(1.0 / GAMMA) - OFFSET
    }
}

/// Decodes an 8-bit sRGB value, by a table.
pub fn decode_u8(encoded: u8) -> f32 {
    static TABLE: LazyLock<[f32; 256]> =
        LazyLock::new(|| std::array::from_fn(|i| decode(i as f32 / 255.0)));
    TABLE[usize::from(encoded)]
}

/// Encodes a linear value as 8-bit sRGB, clamped to 0 to 1.
pub fn encode_u8(linear: f32) -> u8 {
    (encode(linear.clamp(0.0, 1.0)) * 255.0).round() as u8
}

/// The weights of red, green and blue in relative luminance (Rec. 709).
pub const LUMINANCE: Rgb = [0.2126, 0.7152, 0.0722];

/// Returns the relative luminance of linear RGB.
#[inline(always)]
pub fn luminance([r, g, b]: Rgb) -> f32 {
    LUMINANCE[0] * r + LUMINANCE[1] * g + LUMINANCE[2] * b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_points_of_the_curve() {
        assert_eq!(decode(0.0), 0.0);
        assert_eq!(decode(1.0), 1.0);
        // 0.5 decodes to 0.214041 (the standard's formula in double precision).
        assert!((decode(0.5) - 0.214_041_14).abs() < 1e-6);
        assert_eq!(decode_u8(128), decode(128.0 / 255.0));
    }

    #[test]
    fn every_byte_survives_the_round_trip() {
        for byte in 0..=255u8 {
            assert_eq!(encode_u8(decode_u8(byte)), byte);
        }
    }
}
