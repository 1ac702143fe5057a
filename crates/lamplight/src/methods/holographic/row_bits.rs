//! Rows of cells as bits: 64 rows, a tile, are a word, and sixteen of them a vector.

use super::interval::LANES;
use fearless_simd::{mask32x16, prelude::*};

/// Rows that are processed together: a word of bits.
pub const TILE: usize = 64;

/// Vectors in a tile.
pub const VECTORS: usize = TILE / LANES;

/// Returns a vector of a tile's bit mask.
#[inline(always)]
pub fn mask<S: Simd>(simd: S, bits: u64, vector: usize) -> mask32x16<S> {
    mask32x16::from_bitmask(simd, bits >> (vector * LANES) & 0xffff)
}

/// Returns the bit mask of one row of a tile; none if it is not in the tile.
#[inline(always)]
pub fn bit(row: isize) -> u64 {
    if (0..TILE as isize).contains(&row) { 1 << row } else { 0 }
}

/// Returns the mask with all bits set in each vector that has any.
#[inline(always)]
pub fn whole_vectors(bits: u64) -> u64 {
    let mut whole = 0;
    for v in 0..VECTORS {
        if any_in_vector(bits, v * LANES) {
            whole |= 0xffff << (v * LANES);
        }
    }
    whole
}

/// Returns whether any of sixteen bits is set.
#[inline(always)]
pub fn any_in_vector(bits: u64, first: usize) -> bool {
    bits >> first & 0xffff != 0
}
