//! Directions evenly round the circle, as symmetric as the circle itself.

use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_4, TAU};

/// Returns the angle of direction `i` of `n`, radians: 0 is +x, on towards +y.
pub fn angle(i: u32, n: u32) -> f32 {
    (f64::from(TAU) * f64::from(i) / f64::from(n)) as f32
}

/// Returns the unit vector at `angle`. Directions that are images of one another, mirrored or turned by
/// quarters, are so to the bit, which `sin` and `cos` of rounded angles are not: each is computed
/// in the first eighth of the circle. `n` is less than 2^29.
pub fn direction(i: u32, n: u32) -> [f32; 2] {
    let (eighth, rest) = (8 * i / n, 8 * i % n);
    let rest = if eighth % 2 == 0 { rest } else { n - rest };
    let [long, short] = if rest == n {
        [FRAC_1_SQRT_2; 2]
    } else {
        let (sin, cos) = (FRAC_PI_4 * (f64::from(rest) / f64::from(n)) as f32).sin_cos();
        [cos, sin]
    };
    match eighth % 8 {
        0 => [long, short],
        1 => [short, long],
        2 => [-short, long],
        3 => [-long, short],
        4 => [-long, -short],
        5 => [-short, -long],
        6 => [short, -long],
        _ => [long, -short],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_lie_at_their_angles() {
        for n in [1, 3, 7, 8, 16, 402, 804, 100_003] {
            for i in (0..n).step_by((n / 1000).max(1) as usize) {
                let ([x, y], angle) =
                    (direction(i, n), f64::from(i) / f64::from(n) * std::f64::consts::TAU);
                let off = (f64::from(x) - angle.cos()).hypot(f64::from(y) - angle.sin());
                assert!(off < 2e-7, "{i} of {n}: {off}");
            }
        }
    }

    #[test]
    fn images_are_the_same_to_the_bit() {
        for n in [8, 16, 804] {
            for i in 0..n {
                let [x, y] = direction(i, n);
                assert_eq!(direction((i + n / 4) % n, n), [-y, x], "{i} of {n}, turned");
                assert_eq!(direction((n - i) % n, n), [x, -y], "{i} of {n}, mirrored");
            }
            assert!(n % 8 != 0 || direction(n / 8, n) == [FRAC_1_SQRT_2; 2]);
        }
    }
}
