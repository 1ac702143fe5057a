//! Angles of sixteen pixels at once.

use fearless_simd::{f32x16, prelude::*};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// tan(π/8): beyond it the argument is turned back by π/4.
const TAN_PI_8: f32 = 0.414_213_57;

/// `atan2(y, x)` in −π to π, within 3e-7 (Moshier's Cephes, `atanf.c`: an odd polynomial up to
/// tan(π/8), one turn by π/4 beyond, reflections for the rest). 0 at the origin.
#[inline(always)]
pub fn atan2<S: Simd>(y: f32x16<S>, x: f32x16<S>) -> f32x16<S> {
    let (ax, ay) = (x.abs(), y.abs());
    let (small, large) = (ax.min(ay), ax.max(ay));
    let zero = f32x16::splat(y.token(), 0.0);
    let turned = small.simd_gt(large * TAN_PI_8);
    let top = turned.select(small - large, small);
    let bottom = turned.select(small + large, large).max(f32::MIN_POSITIVE);
    let t = top / bottom;
    let z = t * t;
    let p = z * 8.053_744_5e-2 - 1.387_768_6e-1;
    let p = p * z + 1.997_771_1e-1;
    let p = p * z - 3.333_295e-1;
    let a = p * z * t + t + turned.select(zero + FRAC_PI_4, zero);
    let a = ay.simd_gt(ax).select(-a + FRAC_PI_2, a);
    let a = x.simd_lt(0.0).select(-a + PI, a);
    y.simd_lt(0.0).select(-a, a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::dispatch;
    use fearless_simd::Level;

    /// The error of the polynomial and of f32, radians.
    const TOLERANCE: f32 = 4e-7;

    fn lanes(y: [f32; 16], x: [f32; 16]) -> [f32; 16] {
        dispatch!(Level::new(), simd => {
            atan2(f32x16::load_array(simd, y), f32x16::load_array(simd, x)).to_array()
        })
    }

    #[test]
    fn angles_are_right_all_round() {
        for i in 0..4000 {
            let angle = |l: usize| (i * 16 + l) as f32 * 1e-4 - PI + 1e-3;
            let radius = 1e-3 * 1.003f32.powi(i as i32);
            let y = std::array::from_fn(|l| angle(l).sin() * radius);
            let x = std::array::from_fn(|l| angle(l).cos() * radius);
            for (l, a) in lanes(y, x).into_iter().enumerate() {
                let right = f64::from(y[l]).atan2(f64::from(x[l])) as f32;
                assert!((a - right).abs() <= TOLERANCE, "atan2({}, {}) is {a}", y[l], x[l]);
            }
        }
        let axes = lanes(
            std::array::from_fn(|l| [0.0, 2.0, 0.0, -2.0, 0.0][l % 5]),
            std::array::from_fn(|l| [3.0, 0.0, -3.0, 0.0, 0.0][l % 5]),
        );
        assert_eq!(axes[..5], [0.0, FRAC_PI_2, PI, -FRAC_PI_2, 0.0]);
    }
}
