//! Transmittance of matter by Beer–Lambert: `T(s) = e^(−σ_t·s) = ((1 − α)·tint)^s` over s px.

use crate::Rgb;
use fearless_simd::{f32x16, prelude::*, u32x16};

/// The transmittance under which light from behind is neglected.
pub const OPAQUE_TRANSMITTANCE: f32 = 1e-6;
/// The extinction of matter that stops all light; finite, so that 0 px of it still pass light.
pub const MAX_OPTICAL_DEPTH: f32 = 1e4;

/// Returns the extinction σ_t of matter, per px and channel.
pub fn extinction(opacity: f32, tint: Rgb) -> Rgb {
    tint.map(|t| (-((1.0 - opacity) * t).ln()).min(MAX_OPTICAL_DEPTH))
}

/// Returns the transmittance `T = e^−τ` of an optical depth τ ≥ 0, with a relative error under 3e-7.
#[inline]
pub fn transmittance(optical_depth: f32) -> f32 {
    attenuation(optical_depth).0
}

/// Returns the [`transmittance`] T of an optical depth and the absorptance 1 − T, which stays exact to
/// rounding however thin the medium: `T = 2^n·(1 + q)` and `1 − T = (1 − 2^n) − 2^n·q`, with 2^n by the
/// exponent bits and `q = e^f − 1` by a polynomial of degree 6 (Taylor, |f| ≤ ½·ln 2).
#[inline]
pub fn attenuation(optical_depth: f32) -> (f32, f32) {
    let t = (optical_depth * -std::f32::consts::LOG2_E).max(-126.0);
    let n = (t - 0.5) as i32; // rounds to nearest, as t ≤ 0
    let f = (t - n as f32) * std::f32::consts::LN_2;
    let p = 1.0 / 720.0;
    let p = p * f + 1.0 / 120.0;
    let p = p * f + 1.0 / 24.0;
    let p = p * f + 1.0 / 6.0;
    let p = p * f + 0.5;
    let p = p * f + 1.0;
    let q = p * f;
    let scale = f32::from_bits(((n + 127) as u32) << 23);
    ((q + 1.0) * scale, (1.0 - scale) - scale * q)
}

/// Returns the [`attenuation`] of sixteen optical depths, the same to the bit.
#[inline(always)]
pub fn attenuation_lanes<S: Simd>(optical_depth: f32x16<S>) -> (f32x16<S>, f32x16<S>) {
    let t = (optical_depth * -std::f32::consts::LOG2_E).max(-126.0);
    let n = (t - 0.5).trunc();
    let f = (t - n) * std::f32::consts::LN_2;
    let p = f * (1.0 / 720.0) + 1.0 / 120.0;
    let p = p * f + 1.0 / 24.0;
    let p = p * f + 1.0 / 6.0;
    let p = p * f + 0.5;
    let p = p * f + 1.0;
    let q = p * f;
    let scale = f32x16::from_bits((n + 127.0).to_int::<u32x16<S>>() << 23);
    ((q + 1.0) * scale, (-scale + 1.0) - scale * q)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::dispatch;
    use fearless_simd::Level;

    #[test]
    fn lanes_agree_with_the_scalar_to_the_bit() {
        for i in 0..5000 {
            let depth: [f32; 16] = std::array::from_fn(|l| (16 * i + l) as f32 * 1.3e-3);
            let lanes = dispatch!(Level::new(), simd => {
                let (t, absorbed) = attenuation_lanes(f32x16::load_array(simd, depth));
                (t.to_array(), absorbed.to_array())
            });
            let alone = depth.map(attenuation);
            assert_eq!(lanes, (alone.map(|a| a.0), alone.map(|a| a.1)));
        }
    }

    #[test]
    fn transmittance_is_exact_to_rounding() {
        for i in 0..=200_000 {
            let depth = i as f32 * 4e-4;
            let (got, want) = (f64::from(transmittance(depth)), (-f64::from(depth)).exp());
            let bound = 4e-6 * (1.0 + f64::from(depth));
            assert!((got / want - 1.0).abs() < bound, "{depth}: {got} {want}");
        }
        assert_eq!(transmittance(0.0), 1.0);
        assert!(transmittance(1e4) < 1e-37);
    }

    #[test]
    fn absorptance_is_exact_to_rounding_however_thin_the_medium() {
        assert_eq!(attenuation(0.0).1, 0.0);
        for i in 0..400 {
            let depth = 1e-9 * 1.06f32.powi(i);
            let (got, want) = (f64::from(attenuation(depth).1), -(-f64::from(depth)).exp_m1());
            assert!((got / want - 1.0).abs() < 1e-6, "{depth}: {got} {want}");
        }
    }
}
