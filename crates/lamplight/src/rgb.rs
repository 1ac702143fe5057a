//! Colour and radiance: three channels of light.
//!
//! The primaries and the white point are those of sRGB, and values are linear: twice the number is twice
//! the light, so that light adds. [`crate::srgb`] converts to and from the bytes of images.

/// Linear red, green, blue.
pub type Rgb = [f32; 3];
