//! sRGB (IEC 61966-2-1), in and out.

/// Linear 0 to 1 → sRGB 0 to 1.
pub fn encode(v: f32) -> f32 {
    if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// Linear → sRGB byte.
pub fn encode_byte(v: f32) -> u8 {
    (encode(v.clamp(0.0, 1.0)) * 255.0 + 0.5) as u8
}
