//! Rays of one direction from neighbouring rows through the cells on their way.
//!
//! Sixteen at once, with vectors of transmittance, where matter lets part of the light through;
//! where all of it is solid 64 at once, with a bit each: open or not.

use super::interval::{Interval, LANES};
use super::slabs::{FRACTION, GLOWING, LOG_OF_SOLID, Slabs};
use super::stencil::Step;
use crate::stages::transmittance::exp_negative_lanes;
use fearless_simd::{f32x16, mask32x16, prelude::*, u8x64};

/// Rows that are looked at together: a word of bits.
pub const TILE: usize = 64;

/// Vectors in a tile.
pub const VECTORS: usize = TILE / LANES;

/// Light of a tile by channel.
pub type Light<S> = [[f32x16<S>; VECTORS]; 3];

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
                let log = load(simd, &slabs.log_pass[k], at);
                let t = exp_negative_lanes(log * step.length);
                // Not even the corner of a wall lets anything through, over a way of no length.
                log.simd_gt(LOG_OF_SOLID).select(t, f32x16::splat(simd, 0.0))
            } else {
                load(simd, &slabs.pass[k], at)
            };
        }
        if kinds.glowing {
            for c in 0..3 {
                let mut source = slabs.sends(simd, at, step.face, c);
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

/// Sends on the rays of 64 cells of a slab that are `open` through matter that is solid only, by
/// the bits of their fan ([`solid`]); returns those that are open still, and adds a share of the
/// light that the others meet.
#[inline(always)]
pub fn march_solid<S: Simd>(
    simd: S,
    slabs: &Slabs,
    (start, solid): (usize, &[[u64; 2]]),
    steps: &[Step],
    (mut open, share): (u64, Option<f32>),
    light: &mut Light<S>,
) -> u64 {
    for step in steps {
        let [solid, glowing] = solid[step.cell];
        let hit = open & glowing;
        open &= !solid;
        if hit == 0 {
            continue;
        }
        let Some(share) = share else { continue };
        let at = start.wrapping_add_signed(step.offset);
        for v in 0..VECTORS {
            if !of_vector(hit, v * LANES) {
                continue;
            }
            let hit = mask(simd, hit, v);
            for c in 0..3 {
                let source = slabs.sends(simd, at + v * LANES, step.face, c);
                light[c][v] = hit.select(source.mul_add(share, light[c][v]), light[c][v]);
            }
        }
    }
    open
}

/// Where each of the cells at these places is matter, for 64 rows.
#[inline(always)]
pub fn solid<S: Simd>(simd: S, kinds: &[u8], start: usize, cells: &[isize], bits: &mut [[u64; 2]]) {
    for (&offset, bits) in cells.iter().zip(bits) {
        let at = start.wrapping_add_signed(offset);
        let kinds = u8x64::from_slice(simd, &kinds[at..at + TILE]);
        let glowing = (kinds & GLOWING).simd_gt(0).to_bitmask();
        *bits = [kinds.simd_gt(0).to_bitmask(), glowing];
    }
}

/// A vector of 64 bits.
#[inline(always)]
pub fn mask<S: Simd>(simd: S, bits: u64, vector: usize) -> mask32x16<S> {
    mask32x16::from_bitmask(simd, bits >> (vector * LANES) & 0xffff)
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
    pub fraction: u64,
    pub glowing: u64,
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
pub fn meet<S: Simd>(
    simd: S,
    kinds: &[u8],
    start: usize,
    cells: impl Iterator<Item = isize>,
) -> Met {
    let mut met = u8x64::splat(simd, 0);
    for offset in cells {
        let at = start.wrapping_add_signed(offset);
        met |= u8x64::from_slice(simd, &kinds[at..at + TILE]);
    }
    kinds_of(met)
}

/// What 64 rays meet in some of the cells whose bits are known ([`solid`]).
#[inline(always)]
pub fn meet_solid(bits: &[[u64; 2]], cells: &[usize]) -> Met {
    let [mut matter, mut glowing] = [0; 2];
    for &cell in cells {
        matter |= bits[cell][0];
        glowing |= bits[cell][1];
    }
    Met { matter, fraction: 0, glowing }
}

/// Which of 64 rays are on their way through which kinds of matter.
#[inline(always)]
pub fn kinds_of<S: Simd>(met: u8x64<S>) -> Met {
    let matter = met.simd_gt(0).to_bitmask();
    if matter == 0 {
        return Met::NOTHING;
    }
    let fraction = (met & FRACTION).simd_gt(0).to_bitmask();
    Met { matter, fraction, glowing: (met & GLOWING).simd_gt(0).to_bitmask() }
}

/// All bits of the vectors that have any.
#[inline(always)]
pub fn whole_vectors(bits: u64) -> u64 {
    let mut whole = 0;
    for v in 0..VECTORS {
        if of_vector(bits, v * LANES) {
            whole |= 0xffff << (v * LANES);
        }
    }
    whole
}

/// Whether any of sixteen bits is set.
#[inline(always)]
pub fn of_vector(bits: u64, first: usize) -> bool {
    bits >> first & 0xffff != 0
}
