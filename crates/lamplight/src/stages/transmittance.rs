//! How much light gets through matter: Beer–Lambert, `T(s) = ((1 − α)·τ)^s` over s px.

use crate::Rgb;
use fearless_simd::{f32x16, prelude::*, u32x16};

/// Transmittance under which what lies behind no longer counts.
pub const OPAQUE: f32 = 1e-6;

/// Logarithm that stands for "lets nothing through"; finite, so that 0 px of it still pass light.
pub const LOG_OF_ZERO: f32 = -1e4;

/// Natural logarithm of the transmittance of one px, per channel.
pub fn log_transmittance(opacity: f32, tint: Rgb) -> Rgb {
    tint.map(|t| ((1.0 - opacity) * t).ln().max(LOG_OF_ZERO))
}

/// `e^x` for x ≤ 0, with a relative error under 3e-7: 2^n by the exponent bits, 2^f by a
/// polynomial of degree 6 (Taylor, |f| ≤ ½).
#[inline]
pub fn exp_negative(x: f32) -> f32 {
    let t = (x * std::f32::consts::LOG2_E).max(-126.0);
    let n = (t - 0.5) as i32; // rounds to nearest, as t ≤ 0
    let f = (t - n as f32) * std::f32::consts::LN_2;
    let p = 1.0 / 720.0;
    let p = p * f + 1.0 / 120.0;
    let p = p * f + 1.0 / 24.0;
    let p = p * f + 1.0 / 6.0;
    let p = p * f + 0.5;
    let p = p * f + 1.0;
    let p = p * f + 1.0;
    p * f32::from_bits(((n + 127) as u32) << 23)
}

/// [`exp_negative`] of sixteen numbers, the same to the bit.
#[inline(always)]
pub fn exp_negative_lanes<S: Simd>(x: f32x16<S>) -> f32x16<S> {
    let t = (x * std::f32::consts::LOG2_E).max(-126.0);
    let n = (t - 0.5).trunc();
    let f = (t - n) * std::f32::consts::LN_2;
    let p = f * (1.0 / 720.0) + 1.0 / 120.0;
    let p = p * f + 1.0 / 24.0;
    let p = p * f + 1.0 / 6.0;
    let p = p * f + 0.5;
    let p = p * f + 1.0;
    let p = p * f + 1.0;
    p * f32x16::from_bits((n + 127.0).to_int::<u32x16<S>>() << 23)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    #[test]
    fn lanes_agree_with_the_scalar_to_the_bit() {
        for i in 0..5000 {
            let x: [f32; 16] = std::array::from_fn(|l| -((16 * i + l) as f32) * 1.3e-3);
            let lanes = dispatch!(Level::new(), simd => {
                exp_negative_lanes(f32x16::load_array(simd, x)).to_array()
            });
            assert_eq!(lanes, x.map(exp_negative));
        }
    }

    #[test]
    fn exp_negative_is_exact_to_rounding() {
        for i in 0..=200_000 {
            let x = -(i as f32) * 4e-4;
            let (got, want) = (f64::from(exp_negative(x)), f64::from(x).exp());
            assert!((got / want - 1.0).abs() < 4e-6 * (1.0 + f64::from(-x)), "{x}: {got} {want}");
        }
        assert_eq!(exp_negative(0.0), 1.0);
        assert!(exp_negative(-1e4) < 1e-37);
    }
}
