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
        let sent = slabs.sent(crossing.face);
        let mut through = [f32x16::splat(simd, 1.0); K];
        for k in 0..K {
            through[k] = if fraction {
                exp_negative_lanes(load(simd, &slabs.log_pass[k], at) * crossing.length)
            } else {
                load(simd, &slabs.pass[k], at)
            };
        }
        for c in 0..3 {
            let mut source = load(simd, &slabs.source[c], at);
            if let Some(sent) = sent {
                source += load(simd, &sent[c], at);
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

#[inline(always)]
fn load<S: Simd>(simd: S, from: &[f32], at: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &from[at..][..LANES])
}

/// Whether any of sixteen bits is set.
#[inline(always)]
pub fn of_vector(bits: u64, first: usize) -> bool {
    bits >> first & 0xffff != 0
}
