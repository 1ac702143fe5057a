//! Intervals: what a stretch of a ray adds to light and what it lets through, sixteen rows at once
//! and packed for storage.
//!
//! `⟨r_a, t_a⟩ ⊕ ⟨r_b, t_b⟩ = ⟨r_a + t_a·r_b, t_a·t_b⟩`, front to back (Freeman, Sannikov and
//! Margel 2025). Stored light has 8 significant bits (the upper half of an f32), transmittance
//! 15 bits after the point: thin fog needs steps that are fine near 1, and 1 itself exactly.
//! Rounding is to nearest, so that errors of the many intervals of a pixel cancel.

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

impl<S: Simd, const K: usize> Interval<S, K> {
    /// Nothing in the way.
    #[inline(always)]
    pub fn empty(simd: S) -> Self {
        Self { light: [f32x16::splat(simd, 0.0); 3], through: [f32x16::splat(simd, 1.0); K] }
    }

    /// This interval and then another.
    #[inline(always)]
    pub fn then(self, behind: Self) -> Self {
        Self {
            light: std::array::from_fn(|c| self.light[c] + self.through[c % K] * behind.light[c]),
            through: std::array::from_fn(|c| self.through[c] * behind.through[c]),
        }
    }

    /// Half of this one and half of another.
    #[inline(always)]
    pub fn mean(self, other: Self) -> Self {
        Self {
            light: std::array::from_fn(|c| (self.light[c] + other.light[c]) * 0.5),
            through: std::array::from_fn(|c| (self.through[c] + other.through[c]) * 0.5),
        }
    }

    /// Reads rows from `at` on; the words of a row lie `stride` apart.
    #[inline(always)]
    pub fn load(simd: S, from: &[u32], stride: usize, at: usize) -> Self {
        let word = |i: usize| u32x16::from_slice(simd, &from[i * stride + at..][..LANES]);
        let (a, b) = (word(0), word(1));
        let light = [high(a), low(a), high(b)];
        let through = match K {
            1 => std::array::from_fn(|_| fixed(b & 0xffff)),
            _ => {
                let c = word(2);
                let all = [fixed(b & 0xffff), fixed(c >> 16), fixed(c & 0xffff)];
                std::array::from_fn(|k| all[k])
            }
        };
        Self { light, through }
    }

    /// Writes rows from `at` on.
    #[inline(always)]
    pub fn store(self, to: &mut [u32], stride: usize, at: usize) {
        let mut put = |i: usize, word: u32x16<S>| {
            word.store_slice(&mut to[i * stride + at..][..LANES]);
        };
        let [r, g, b] = self.light.map(|v| v.bitcast::<u32x16<S>>() + 0x8000);
        let t = self.through.map(|v| (v * ONE as f32 + 0.5).to_int::<u32x16<S>>());
        put(0, (r & 0xffff_0000) | (g >> 16));
        put(1, (b & 0xffff_0000) | t[0]);
        if K == 3 {
            put(2, (t[1 % K] << 16) | t[2 % K]);
        }
    }
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
