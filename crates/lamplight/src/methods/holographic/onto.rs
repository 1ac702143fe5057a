//! Light onto the faces of walls.
//!
//! `B = ½ ∫ L cosθ dω` on a face, where pixels know `L` at the centre of the cell in front, half a
//! px off. That is as good in the open, but not beside a step of the wall, which shades the face
//! more than it does the cell's centre: the stairs of a slanted wall would get light that in truth
//! grazes over them. Of a beam that comes down s px along the face for each px that it comes
//! nearer, a step that begins k px beside the cell in front stops
//!
//! `f = clamp(s − k, 0, 1)`
//!
//! exactly, over the whole px of the face. So `L` counts for 1 − f, and what the step sends out for
//! f.

use super::hop::Hop;
use super::interval::LANES;
use super::march::TILE;
use super::slabs::{FRACTION, Face, MATTER, Slabs};
use fearless_simd::{f32x16, mask32x16, prelude::*, u8x16};

/// Light onto faces that look ahead, to higher rows and to lower rows, by channel, in sixteen rows.
pub type Onto = [[[f32; LANES]; 3]; 3];

/// Cells beside the one in front that are looked at for a step.
pub const REACH: usize = 3;
/// Where there is none, px: farther than any beam comes down.
const NONE: f32 = 1e9;

/// Steps of walls beside the cells in front of sixteen faces, on one side.
struct Steps<S: Simd> {
    /// Px from each cell to its step.
    away: f32x16<S>,
    /// What the step sends out.
    light: [f32x16<S>; 3],
}

impl<S: Simd> Steps<S> {
    /// The first solid ones of `reach` cells, `next` from one to the other, that rays meet at `face`.
    #[inline(always)]
    fn find(simd: S, slabs: &Slabs, start: usize, next: isize, reach: usize, face: Face) -> Self {
        let mut steps =
            Self { away: f32x16::splat(simd, NONE), light: [f32x16::splat(simd, 0.0); 3] };
        for away in (0..reach).rev() {
            let at = start.wrapping_add_signed(next * (away as isize + 1));
            let kinds = u8x16::from_slice(simd, &slabs.kinds[at..at + LANES]);
            let solid = (kinds & (MATTER | FRACTION)).simd_eq(MATTER).to_bitmask();
            if solid == 0 {
                continue;
            }
            let solid = mask32x16::from_bitmask(simd, solid);
            steps.away = solid.select(f32x16::splat(simd, away as f32), steps.away);
            for c in 0..3 {
                let light = slabs.sends(simd, at, face, c);
                steps.light[c] = solid.select(light, steps.light[c]);
            }
        }
        steps
    }

    /// Light through a cone, of which a share meets the steps.
    #[inline(always)]
    fn shade(&self, light: [f32x16<S>; 3], angle: f32, slope: f32) -> [f32x16<S>; 3] {
        let share = (-self.away + slope).max(0.0).min(1.0);
        let mut shaded = light;
        for c in 0..3 {
            shaded[c] = share.mul_add(self.light[c] * angle - light[c], light[c]);
        }
        shaded
    }
}

/// Light onto the faces of sixteen rows of the tile that pixels last looked ahead from.
#[inline(always)]
pub fn onto<S: Simd>(simd: S, slabs: &Slabs, hop: &Hop, [slab, row]: [usize; 2]) -> Onto {
    let zero = f32x16::splat(simd, 0.0);
    let start = slabs.start(slab) + row;
    let ahead = Steps::find(simd, slabs, start, slabs.step(), REACH, Face::Front);
    let high = Steps::find(simd, slabs, start, 1, 1, Face::Low);
    let low = Steps::find(simd, slabs, start, -1, 1, Face::High);
    let (mut onto, mut before) = ([[zero; 3]; 3], [zero; 3]);
    for (cone, sums) in hop.sums() {
        let mut light = [zero; 3];
        for c in 0..3 {
            let sum = f32x16::from_slice(simd, &sums[c][row % TILE..][..LANES]);
            light[c] = sum - before[c];
            before[c] = sum;
        }
        let [along, across] = cone.cosines;
        let (side, beside) = if across > 0.0 { (1, &high) } else { (2, &low) };
        let across = across.abs();
        let to_side = ahead.shade(light, cone.angle, along / across);
        let to_front = beside.shade(light, cone.angle, across / along);
        for c in 0..3 {
            onto[0][c] = to_front[c].mul_add(along, onto[0][c]);
            onto[side][c] = to_side[c].mul_add(across, onto[side][c]);
        }
    }
    let mut stored = [[[0.0; LANES]; 3]; 3];
    for side in 0..3 {
        for c in 0..3 {
            onto[side][c].store_slice(&mut stored[side][c]);
        }
    }
    stored
}
