//! Jump flood: from seeds to the nearest seed of every cell (Rong and Tan 2006).
//!
//! ⌈log2(max(w, h))⌉ passes with offsets 2^(passes−1) … 1; in each a cell reads nine cells that
//! far away and keeps the nearest of their seeds. Of two seeds at the same distance the one with
//! the smaller packed position wins (see [`super::seed::pack`]), in any order of reading, so
//! that CPU and GPU agree to the bit.
//!
//! Known limit: a few cells end with a seed that is not the nearest. Extra passes of offset 1
//! correct most of them (JFA+1). [`settle`] continues until nothing changes, after which every cell
//! agrees with its eight neighbours, and the remaining error is that of 8-neighbour propagation: under
//! 0.1 px (Danielsson 1980). Marching relies on that bound.

use super::seed::{NONE, unpack};
use rayon::prelude::*;

/// The largest distance error in px that can remain after [`settle`] (Danielsson 1980 bounds
/// 8-neighbour propagation by 0.09 px).
pub const SETTLED_ERROR: f32 = 0.1;

/// Returns the number of passes for a grid.
pub fn passes(width: u32, height: u32) -> u32 {
    width.max(height).next_power_of_two().trailing_zeros()
}

/// Spreads `seeds` over the grid in place and then makes `extra` passes of offset 1; `scratch` is
/// the other half of the ping-pong.
pub fn jump_flood(
    width: u32,
    height: u32,
    extra: u32,
    seeds: &mut Vec<u32>,
    scratch: &mut Vec<u32>,
) {
    scratch.resize(seeds.len(), NONE);
    let jumps = (0..passes(width, height)).rev().map(|pass| 1 << pass);
    for offset in jumps.chain((0..extra).map(|_| 1)) {
        pass(width, height, offset, seeds, scratch);
        std::mem::swap(seeds, scratch);
    }
}

/// Makes passes of offset 1 until nothing changes; `scratch` is the other half of the ping-pong.
pub fn settle(width: u32, height: u32, seeds: &mut Vec<u32>, scratch: &mut Vec<u32>) {
    scratch.resize(seeds.len(), NONE);
    loop {
        pass(width, height, 1, seeds, scratch);
        if seeds == scratch {
            return;
        }
        std::mem::swap(seeds, scratch);
    }
}

/// Returns the squared distance from (x, y) to a seed; beyond every real distance for [`NONE`].
#[inline]
fn distance2(x: i32, y: i32, seed: u32) -> i32 {
    let [sx, sy] = unpack(seed);
    let (dx, dy) = (sx as i32 - x, sy as i32 - y);
    if seed == NONE { i32::MAX } else { dx * dx + dy * dy }
}

fn pass(width: u32, height: u32, offset: u32, from: &[u32], to: &mut [u32]) {
    let w = width as usize;
    to.par_chunks_mut(w).enumerate().for_each(|(y, out)| {
        out.copy_from_slice(&from[y * w..][..w]);
        let rows = [y.checked_sub(offset as usize), Some(y), Some(y + offset as usize)];
        for row in rows.into_iter().flatten().filter(|&row| row < height as usize) {
            look(out, &from[row * w..][..w], y, offset as usize);
        }
    });
}

/// Compares every cell of row `y` with three cells of another row: `offset` to the left, in the same
/// column, and `offset` to the right.
fn look(out: &mut [u32], row: &[u32], y: usize, offset: usize) {
    let w = row.len();
    look_shifted(out, row, 0, y);
    if offset < w {
        look_shifted(&mut out[offset..], &row[..w - offset], offset, y);
        look_shifted(&mut out[..w - offset], &row[offset..], 0, y);
    }
}

/// Compares `out[i]`, at column `x + i`, with the seed of `row[i]`. Branch-free, so that it becomes
/// vector code.
fn look_shifted(out: &mut [u32], row: &[u32], x: usize, y: usize) {
    for (i, (best, &seed)) in out.iter_mut().zip(row).enumerate() {
        let x = (x + i) as i32;
        let (held, offered) = (distance2(x, y as i32, *best), distance2(x, y as i32, seed));
        let better = (offered < held) | ((offered == held) & (seed < *best));
        *best = if better { seed } else { *best };
    }
}
