//! Sixteen rays of one direction through the cells on their way.

use super::interval::{Interval, LANES};
use super::slabs::Slabs;
use super::stencil::Step;
use crate::stages::transmittance::exp_negative_lanes;
use fearless_simd::{f32x16, prelude::*, u8x64};

/// The interval of a ray from sixteen cells of a slab. `fraction`: whether any of the cells holds
/// matter that is not solid; without, lengths do not matter.
#[inline(always)]
pub fn march<S: Simd, const K: usize>(
    simd: S,
    slabs: &Slabs,
    start: usize,
    steps: &[Step],
    fraction: bool,
) -> Interval<S, K> {
    let mut passed = Interval::<S, K>::empty(simd);
    for step in steps {
        let at = start.wrapping_add_signed(step.offset);
        let sent = slabs.sent(step.face);
        let mut through = [f32x16::splat(simd, 1.0); K];
        for k in 0..K {
            through[k] = if fraction {
                exp_negative_lanes(load(simd, &slabs.log_pass[k], at) * step.length)
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

#[inline(always)]
fn load<S: Simd>(simd: S, from: &[f32], at: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &from[at..at + LANES])
}

/// Which of 64 rays cross matter, and which matter that is not solid, bit by bit.
#[inline(always)]
pub fn meet<S: Simd>(simd: S, kinds: &[u8], start: usize, cells: &[isize]) -> [u64; 2] {
    let mut met = u8x64::splat(simd, 0);
    for &offset in cells {
        let at = start.wrapping_add_signed(offset);
        met |= u8x64::from_slice(simd, &kinds[at..at + 64]);
    }
    let matter = met.simd_gt(0).to_bitmask();
    let fraction = if matter == 0 { 0 } else { met.simd_gt(1).to_bitmask() };
    [matter, fraction]
}

/// Whether any of sixteen bits is set.
#[inline(always)]
pub fn of_vector(bits: u64, first: usize) -> bool {
    bits >> first & 0xffff != 0
}
