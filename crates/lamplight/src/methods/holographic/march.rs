//! Sixteen rays of one direction through the cells on their way.

use super::interval::{Interval, LANES};
use super::slabs::Slabs;
use super::stencil::Crossing;
use crate::stages::transmittance::exp_negative_lanes;
use fearless_simd::{f32x16, prelude::*};

/// The interval of a ray from sixteen rows of a slab. `fraction`: whether any of the cells holds
/// matter that is not solid; without, lengths do not matter.
#[inline(always)]
pub fn march<S: Simd, const K: usize>(
    simd: S,
    slabs: &Slabs,
    slab: usize,
    row: usize,
    crossings: &[Crossing],
    fraction: bool,
) -> Interval<S, K> {
    let mut passed = Interval::<S, K>::empty(simd);
    for crossing in crossings {
        let at = cell(slabs, slab, row, crossing.slab, crossing.row);
        let load = |from: &[f32]| f32x16::from_slice(simd, &from[at..][..LANES]);
        let through: [_; K] = std::array::from_fn(|k| match fraction {
            true => exp_negative_lanes(load(&slabs.log_pass[k]) * crossing.length),
            false => load(&slabs.pass[k]),
        });
        let sent = slabs.sent(crossing.face);
        for c in 0..3 {
            let mut source = load(&slabs.source[c]);
            if let Some(sent) = sent {
                source += load(&sent[c]);
            }
            if fraction {
                source *= -through[c % K] + 1.0;
            }
            passed.light[c] += passed.through[c % K] * source;
        }
        for k in 0..K {
            passed.through[k] *= through[k];
        }
    }
    passed
}

/// Place of a cell relative to a row of a slab.
#[inline(always)]
pub fn cell(slabs: &Slabs, slab: usize, row: usize, slabs_on: usize, rows_on: isize) -> usize {
    (slabs.start(slab + slabs_on) + row).wrapping_add_signed(rows_on)
}
