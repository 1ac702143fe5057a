//! Intervals: what a stretch of a ray adds to light and what it lets through, sixteen rows at once
//! and packed for storage.
//!
//! `⟨r_a, t_a⟩ ⊕ ⟨r_b, t_b⟩ = ⟨r_a + t_a·r_b, t_a·t_b⟩`, front to back (Freeman, Sannikov and
//! Margel 2025). Stored light has 8 significant bits (the upper half of an f32), transmittance
//! 15 bits after the point: thin fog needs steps that are fine near 1, and 1 itself exactly.
//! Rounding is to nearest, so that errors of the many intervals of a pixel cancel.
//!
//! Code that runs on vectors has no closures and no `array::from_fn` in this method: the compiler
//! does not carry the vector unit into them.

use crate::Rgb;
use fearless_simd::{f32x16, prelude::*, u32x16};

/// Rows in a vector.
pub const LANES: usize = 16;

/// Rows of empty space at both ends of a stored row of intervals.
pub const PAD: usize = LANES;

/// The stored transmittance 1.
const ONE: u32 = 1 << 15;

/// Light by channel, and transmittance by `K` channels (1, or 3 where matter tints).
#[derive(Clone, Copy, Debug)]
pub struct Interval<S: Simd, const K: usize> {
    pub light: [f32x16<S>; 3],
    pub through: [f32x16<S>; K],
}

/// 32-bit words of a stored interval: two values each.
pub const fn words(channels: usize) -> usize {
    (3 + channels).div_ceil(2)
}

/// The words of an interval in which nothing is.
pub fn empty(channels: usize) -> &'static [u32] {
    if channels == 1 { &[0, ONE] } else { &[0, ONE, ONE << 16 | ONE] }
}

/// Light and transmittance of one stored interval; the third word counts where matter tints.
pub fn scalar([a, b, tints]: [u32; 3], channels: usize) -> (Rgb, Rgb) {
    let fixed = |v: u32| (v & 0xffff) as f32 / ONE as f32;
    let high = |v: u32| f32::from_bits(v & 0xffff_0000);
    let through = match channels {
        1 => [fixed(b); 3],
        _ => [fixed(b), fixed(tints >> 16), fixed(tints)],
    };
    ([high(a), high(a << 16), high(b)], through)
}

impl<S: Simd, const K: usize> Interval<S, K> {
    /// Nothing in the way.
    #[inline(always)]
    pub fn empty(simd: S) -> Self {
        Self { light: [f32x16::splat(simd, 0.0); 3], through: [f32x16::splat(simd, 1.0); K] }
    }

    /// This interval and then another.
    #[inline(always)]
    pub fn then(mut self, behind: Self) -> Self {
        for c in 0..3 {
            self.light[c] = self.through[c % K].mul_add(behind.light[c], self.light[c]);
        }
        for k in 0..K {
            self.through[k] *= behind.through[k];
        }
        self
    }

    /// Half of this one and half of another.
    #[inline(always)]
    pub fn mean(mut self, other: Self) -> Self {
        for c in 0..3 {
            self.light[c] = (self.light[c] + other.light[c]) * 0.5;
        }
        for k in 0..K {
            self.through[k] = (self.through[k] + other.through[k]) * 0.5;
        }
        self
    }

    /// Reads rows from `at` on; the words of a row lie `stride` apart.
    #[inline(always)]
    pub fn load(simd: S, from: &[u32], stride: usize, at: usize) -> Self {
        let tints = if K == 3 { 2 * stride + at } else { at };
        Self::unpack([
            u32x16::from_slice(simd, &from[at..][..LANES]),
            u32x16::from_slice(simd, &from[stride + at..][..LANES]),
            u32x16::from_slice(simd, &from[tints..][..LANES]),
        ])
    }

    /// Reads words of sixteen rows; the third counts where matter tints.
    #[inline(always)]
    pub fn unpack([a, b, tints]: [u32x16<S>; 3]) -> Self {
        let mut through = [fixed(b & 0xffff); K];
        if K == 3 {
            through[1 % K] = fixed(tints >> 16);
            through[2 % K] = fixed(tints & 0xffff);
        }
        Self { light: [high(a), low(a), high(b)], through }
    }

    /// Writes rows from `at` on.
    #[inline(always)]
    pub fn store(self, to: &mut [u32], stride: usize, at: usize) {
        let [r, g, b] = self.light;
        let (r, g, b) = (rounded(r), rounded(g), rounded(b));
        let a = (r & 0xffff_0000) | (g >> 16);
        a.store_slice(&mut to[at..][..LANES]);
        let b = (b & 0xffff_0000) | to_fixed(self.through[0]);
        b.store_slice(&mut to[stride + at..][..LANES]);
        if K == 3 {
            let c = (to_fixed(self.through[1 % K]) << 16) | to_fixed(self.through[2 % K]);
            c.store_slice(&mut to[2 * stride + at..][..LANES]);
        }
    }
}

#[inline(always)]
fn rounded<S: Simd>(value: f32x16<S>) -> u32x16<S> {
    value.bitcast::<u32x16<S>>() + 0x8000
}

#[inline(always)]
fn to_fixed<S: Simd>(value: f32x16<S>) -> u32x16<S> {
    (value * ONE as f32 + 0.5).to_int::<u32x16<S>>()
}

#[inline(always)]
fn high<S: Simd>(word: u32x16<S>) -> f32x16<S> {
    f32x16::from_bits(word & 0xffff_0000)
}

#[inline(always)]
fn low<S: Simd>(word: u32x16<S>) -> f32x16<S> {
    f32x16::from_bits(word << 16)
}

#[inline(always)]
fn fixed<S: Simd>(word: u32x16<S>) -> f32x16<S> {
    word.to_float::<f32x16<S>>() * (1.0 / ONE as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use fearless_simd::{Level, dispatch};

    /// Half of the last of 8 bits; and of the last of 15 after the point.
    const LIGHT: f32 = 1.0 / 256.0;
    const THROUGH: f32 = 1.0 / 32768.0;

    fn stored<const K: usize>(light: [f32; 3], through: [f32; K]) -> ([f32; 3], [f32; K]) {
        let mut words = vec![0; words(K) * LANES];
        dispatch!(Level::new(), simd => {
            let light = light.map(|v| f32x16::splat(simd, v));
            let through = through.map(|v| f32x16::splat(simd, v));
            Interval { light, through }.store(&mut words, LANES, 0);
            let read = Interval::<_, K>::load(simd, &words, LANES, 0);
            (read.light.map(|v| v.to_array()[7]), read.through.map(|v| v.to_array()[7]))
        })
    }

    #[test]
    fn what_is_stored_is_kept_to_rounding() {
        let light = [0.0, 3.456_789, 7.89e4];
        for through in [[0.0, 0.123_45, 0.999_97], [1.0, 0.5, 1.0 / 3.0]] {
            let (l, t) = stored(light, through);
            for c in 0..3 {
                assert!((l[c] - light[c]).abs() <= LIGHT * light[c], "{l:?}");
                assert!((t[c] - through[c]).abs() <= THROUGH, "{t:?}");
            }
            let (l, t) = stored(light, [through[0]]);
            assert!((l[2] - light[2]).abs() <= LIGHT * light[2], "{l:?}");
            assert!((t[0] - through[0]).abs() <= THROUGH, "{t:?}");
        }
    }

    #[test]
    fn nothing_and_everything_are_kept_exactly() {
        for v in [0.0, 1.0] {
            assert_eq!(stored([v; 3], [v; 3]), ([v; 3], [v; 3]));
            assert_eq!(stored([v; 3], [v]), ([v; 3], [v]));
        }
    }
}
