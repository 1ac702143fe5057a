//! Temporary.
use crate::settings::Noise;
/// Temporary: replaced by the blue-noise stage.
pub fn first_angle(_noise: Noise, x: u32, y: u32, frame: u32, seed: u64) -> f32 {
    let mut h = x.wrapping_mul(0x9E37_79B9)
        ^ y.wrapping_mul(0x85EB_CA6B)
        ^ frame.wrapping_mul(0xC2B2_AE35)
        ^ seed as u32;
    h ^= h >> 16;
    h = h.wrapping_mul(0x7feb_352d);
    h ^= h >> 15;
    h = h.wrapping_mul(0x846c_a68b);
    h ^= h >> 16;
    (h >> 8) as f32 / 16_777_216.0
}
