//! Intervals of rays: the radiance that an interval adds and its transmittance, for sixteen rows at
//! once, and their packed form.
//!
//! `⟨r_a, t_a⟩ ⊕ ⟨r_b, t_b⟩ = ⟨r_a + t_a·r_b, t_a·t_b⟩`, front to back (Freeman, Sannikov and
//! Margel 2025). Stored radiance has 8 significant bits (the upper half of an f32), transmittance
//! 15 bits after the point: thin media need fine steps near 1, and exactly 1 must be representable.
//! Rounding is to nearest, so that the errors of a pixel's many intervals cancel.
//!
//! Vector code of this method has no closures and no `array::from_fn`: the compiler does not compile
//! them for the vector unit.

use crate::Rgb;
use fearless_simd::{f32x16, mask32x16, prelude::*, u32x16};

/// Rows in a vector.
pub const LANES: usize = 16;

/// Empty intervals at both ends of a stored row of intervals.
pub const PAD: usize = LANES;

/// The stored form of transmittance 1.
const ONE: u32 = 1 << 15;

/// The intervals of one ray from sixteen rows: radiance by channel, and transmittance by `K` channels
/// (1, or 3 if matter tints).
#[derive(Clone, Copy, Debug)]
pub struct RowIntervals<S: Simd, const K: usize> {
    pub light: [f32x16<S>; 3],
    pub transmittance: [f32x16<S>; K],
}

/// Returns the number of 32-bit words of a stored interval: two values each.
pub const fn words(channels: usize) -> usize {
    (3 + channels).div_ceil(2)
}

/// Returns the words of an empty interval.
pub fn empty(channels: usize) -> &'static [u32] {
    if channels == 1 { &[0, ONE] } else { &[0, ONE, ONE << 16 | ONE] }
}

/// Returns the radiance and the transmittance of one stored interval; the third word is read if matter
/// tints.
pub fn unpack_one([a, b, tints]: [u32; 3], channels: usize) -> (Rgb, Rgb) {
    let fixed = |v: u32| (v & 0xffff) as f32 / ONE as f32;
    let high = |v: u32| f32::from_bits(v & 0xffff_0000);
    let transmittance = match channels {
        1 => [fixed(b); 3],
        _ => [fixed(b), fixed(tints >> 16), fixed(tints)],
    };
    ([high(a), high(a << 16), high(b)], transmittance)
}

impl<S: Simd, const K: usize> RowIntervals<S, K> {
    /// Returns empty intervals, ⟨0, 1⟩.
    #[inline(always)]
    pub fn empty(simd: S) -> Self {
        Self { light: [f32x16::splat(simd, 0.0); 3], transmittance: [f32x16::splat(simd, 1.0); K] }
    }

    /// Returns these intervals followed by others, ⊕.
    #[inline(always)]
    pub fn then(mut self, behind: Self) -> Self {
        for c in 0..3 {
            self.light[c] = self.transmittance[c % K].mul_add(behind.light[c], self.light[c]);
        }
        for k in 0..K {
            self.transmittance[k] *= behind.transmittance[k];
        }
        self
    }

    /// Returns the mean of these intervals and others.
    #[inline(always)]
    pub fn mean(mut self, other: Self) -> Self {
        for c in 0..3 {
            self.light[c] = (self.light[c] + other.light[c]) * 0.5;
        }
        for k in 0..K {
            self.transmittance[k] = (self.transmittance[k] + other.transmittance[k]) * 0.5;
        }
        self
    }

    /// Returns these intervals, and others in the rows of a mask.
    #[inline(always)]
    pub fn or(mut self, other: Self, rows: mask32x16<S>) -> Self {
        for c in 0..3 {
            self.light[c] = rows.select(other.light[c], self.light[c]);
        }
        for k in 0..K {
            self.transmittance[k] = rows.select(other.transmittance[k], self.transmittance[k]);
        }
        self
    }

    /// Reads the intervals of sixteen rows from `at` on; the words of a row lie `stride` apart.
    #[inline(always)]
    pub fn load(simd: S, from: &[u32], stride: usize, at: usize) -> Self {
        let tints = if K == 3 { 2 * stride + at } else { at };
        Self::unpack([
            u32x16::from_slice(simd, &from[at..][..LANES]),
            u32x16::from_slice(simd, &from[stride + at..][..LANES]),
            u32x16::from_slice(simd, &from[tints..][..LANES]),
        ])
    }

    /// Unpacks the words of sixteen rows; the third is read if matter tints.
    #[inline(always)]
    pub fn unpack([a, b, tints]: [u32x16<S>; 3]) -> Self {
        let mut transmittance = [fixed(b & 0xffff); K];
        if K == 3 {
            transmittance[1 % K] = fixed(tints >> 16);
            transmittance[2 % K] = fixed(tints & 0xffff);
        }
        Self { light: [high(a), low(a), high(b)], transmittance }
    }

    /// Stores the intervals of sixteen rows from `at` on.
    #[inline(always)]
    pub fn store(self, to: &mut [u32], stride: usize, at: usize) {
        let [r, g, b] = self.light;
        let (r, g, b) = (rounded(r), rounded(g), rounded(b));
        let a = (r & 0xffff_0000) | (g >> 16);
        a.store_slice(&mut to[at..][..LANES]);
        let b = (b & 0xffff_0000) | to_fixed(self.transmittance[0]);
        b.store_slice(&mut to[stride + at..][..LANES]);
        if K == 3 {
            let c =
                (to_fixed(self.transmittance[1 % K]) << 16) | to_fixed(self.transmittance[2 % K]);
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
    use crate::simd::dispatch;
    use fearless_simd::Level;

    /// Half of the last of 8 bits; and of the last of 15 after the point.
    const LIGHT: f32 = 1.0 / 256.0;
    const TRANSMITTANCE: f32 = 1.0 / 32768.0;

    fn stored<const K: usize>(light: [f32; 3], transmittance: [f32; K]) -> ([f32; 3], [f32; K]) {
        let mut words = vec![0; words(K) * LANES];
        dispatch!(Level::new(), simd => {
            let light = light.map(|v| f32x16::splat(simd, v));
            let transmittance = transmittance.map(|v| f32x16::splat(simd, v));
            RowIntervals { light, transmittance }.store(&mut words, LANES, 0);
            let read = RowIntervals::<_, K>::load(simd, &words, LANES, 0);
            (read.light.map(|v| v.to_array()[7]), read.transmittance.map(|v| v.to_array()[7]))
        })
    }

    #[test]
    fn what_is_stored_is_kept_to_rounding() {
        let light = [0.0, 3.456_789, 7.89e4];
        for transmittance in [[0.0, 0.123_45, 0.999_97], [1.0, 0.5, 1.0 / 3.0]] {
            let (l, t) = stored(light, transmittance);
            for c in 0..3 {
                assert!((l[c] - light[c]).abs() <= LIGHT * light[c], "{l:?}");
                assert!((t[c] - transmittance[c]).abs() <= TRANSMITTANCE, "{t:?}");
            }
            let (l, t) = stored(light, [transmittance[0]]);
            assert!((l[2] - light[2]).abs() <= LIGHT * light[2], "{l:?}");
            assert!((t[0] - transmittance[0]).abs() <= TRANSMITTANCE, "{t:?}");
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
