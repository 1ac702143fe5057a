//! Sixteen rays of one direction through the cells on their way.

use super::interval::{Interval, LANES};
use super::slabs::{FRACTION, GLOWING, Slabs};
use super::stencil::Step;
use crate::stages::transmittance::exp_negative_lanes;
use fearless_simd::{f32x16, prelude::*, u8x64};

/// Transmittance that counts as none: walls among fog let exactly nothing through.
const VANISHED: f32 = 1e-30;

/// The interval of a ray from sixteen cells of a slab, which crosses only matter of these kinds.
#[inline(always)]
pub fn march<S: Simd, const K: usize>(
    simd: S,
    slabs: &Slabs,
    start: usize,
    steps: &[Step],
    kinds: Kinds,
) -> Interval<S, K> {
    let mut passed = Interval::<S, K>::empty(simd);
    for step in steps {
        let at = start.wrapping_add_signed(step.offset);
        let mut through = [f32x16::splat(simd, 1.0); K];
        for k in 0..K {
            through[k] = if kinds.fraction {
                let t = exp_negative_lanes(load(simd, &slabs.log_pass[k], at) * step.length);
                t.simd_gt(VANISHED).select(t, f32x16::splat(simd, 0.0))
            } else {
                load(simd, &slabs.pass[k], at)
            };
        }
        if kinds.glowing {
            let sent = slabs.sent(step.face);
            for c in 0..3 {
                let mut source = load(simd, &slabs.source[c], at);
                if let Some(sent) = sent {
                    source += load(simd, &sent[c], at);
                }
                if kinds.fraction {
                    source *= -through[c % K] + 1.0;
                }
                passed.light[c] = passed.through[c % K].mul_add(source, passed.light[c]);
            }
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

/// Kinds of matter that sixteen rays cross.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kinds {
    /// Some is not solid, so that lengths matter.
    pub fraction: bool,
    /// Some gives off light.
    pub glowing: bool,
}

impl Kinds {
    /// Nothing whose length or light counts.
    pub const NONE: Self = Self { fraction: false, glowing: false };
}

/// Which of 64 rays cross which kinds of matter, bit by bit.
#[derive(Clone, Copy, Debug)]
pub struct Met {
    pub matter: u64,
    fraction: u64,
    glowing: u64,
}

impl Met {
    /// No matter.
    pub const NOTHING: Self = Self { matter: 0, fraction: 0, glowing: 0 };

    /// The kinds that sixteen rays from the first on cross; none: they cross no matter.
    #[inline(always)]
    pub fn kinds(&self, first: usize) -> Option<Kinds> {
        if !of_vector(self.matter, first) {
            return None;
        }
        Some(Kinds {
            fraction: of_vector(self.fraction, first),
            glowing: of_vector(self.glowing, first),
        })
    }
}

/// What 64 rays meet in the cells at these places relative to where they start.
#[inline(always)]
pub fn meet<S: Simd>(simd: S, kinds: &[u8], start: usize, cells: &[isize]) -> Met {
    let mut met = u8x64::splat(simd, 0);
    for &offset in cells {
        let at = start.wrapping_add_signed(offset);
        met |= u8x64::from_slice(simd, &kinds[at..at + 64]);
    }
    let matter = met.simd_gt(0).to_bitmask();
    if matter == 0 {
        return Met::NOTHING;
    }
    let fraction = (met & FRACTION).simd_gt(0).to_bitmask();
    Met { matter, fraction, glowing: (met & GLOWING).simd_gt(0).to_bitmask() }
}

/// Whether any of sixteen bits is set.
#[inline(always)]
pub fn of_vector(bits: u64, first: usize) -> bool {
    bits >> first & 0xffff != 0
}
