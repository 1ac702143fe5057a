//! Sixteen rays at once through what lets light pass.
//!
//! Nearly all of a ray's way leads through empty cells, fog or glass. A packet takes its rays along
//! it in lockstep, from square to square of the same matter ([`crate::stages::clearance`]), until
//! each has left the grid, come to a closed cell or gone as far as it was to; what happens there is
//! up to the method.
//! Rays of neighbouring cells in about the same direction stay together, so few of them idle. The
//! vector units are chosen at run time; no fused multiply-add is used, so the results are the same
//! to the bit on every one.

use super::clearance::MATTER;
use super::optics::Optics;
use super::transmittance::{OPAQUE, exp_negative_lanes};
use fearless_simd::{f32x16, i32x16, mask32x16, prelude::*};

/// Rays in a packet.
pub const LANES: usize = 16;

/// One value a ray.
pub type Lanes<T> = [T; LANES];

/// Slope under which a ray never crosses an edge of an axis.
pub const NEVER: f32 = 1e-12;

// Cell indices are computed in f32, which holds whole numbers up to 2^24 exactly.
const _: () = assert!(crate::Cells::MAX_CELLS <= 1 << 24);

/// Where a ray starts, in which cell, and its unit direction; or sixteen of them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Ray<T> {
    pub from: [T; 2],
    pub cell: [T; 2],
    pub direction: [T; 2],
}

/// Where rays stopped.
#[derive(Clone, Copy, Debug)]
pub struct Stopped {
    pub at: [Lanes<f32>; 2],
    pub cell: [Lanes<f32>; 2],
    pub direction: [Lanes<f32>; 2],
    pub travelled: Lanes<f32>,
    /// Light gathered in fog, and the share of what lies behind that gets through, by channel.
    pub light: [Lanes<f32>; 3],
    pub through: [Lanes<f32>; 3],
    /// Bit by bit: rays that left the grid.
    left: u64,
    /// Rays whose steps ran out, or through which nothing gets any more.
    tired: u64,
    /// Rays that went as far as they were to.
    reached: u64,
    /// Rays whose last step went along x.
    by_x: u64,
}

/// Why a ray stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// It left the grid.
    Left,
    /// It ran out of steps or of light.
    Tired,
    /// It went as far as it was to.
    Reached,
    /// It entered a closed cell by a step along this axis.
    Closed(usize),
}

impl Stopped {
    /// Rays that ended at a closed cell, bit by bit.
    #[inline(always)]
    pub fn closed(&self) -> u64 {
        !(self.left | self.tired | self.reached) & u64::from(u16::MAX)
    }

    /// Why a ray stopped.
    #[inline(always)]
    pub fn why(&self, lane: usize) -> Why {
        let is = |mask: u64| mask >> lane & 1 == 1;
        match () {
            () if is(self.left) => Why::Left,
            () if is(self.tired) => Why::Tired,
            () if is(self.reached) => Why::Reached,
            () => Why::Closed(!is(self.by_x) as usize),
        }
    }
}

/// Marches rays that start inside the grid until each has stopped or made `steps`.
#[inline(always)]
pub fn march<S: Simd>(simd: S, optics: &Optics, ray: Ray<f32x16<S>>, steps: u32) -> Stopped {
    let anywhere = f32x16::splat(simd, f32::INFINITY);
    march_up_to::<S, false>(simd, optics, ray, anywhere, steps)
}

/// Marches rays that start inside the grid until each has stopped, gone `reach` px or made `steps`.
#[inline(always)]
pub fn march_within<S: Simd>(
    simd: S,
    optics: &Optics,
    ray: Ray<f32x16<S>>,
    reach: f32x16<S>,
    steps: u32,
) -> Stopped {
    march_up_to::<S, true>(simd, optics, ray, reach, steps)
}

/// Whether rays end before they stop is known when this is compiled: raymarch's never do.
#[inline(always)]
fn march_up_to<S: Simd, const ENDS: bool>(
    simd: S,
    optics: &Optics,
    ray: Ray<f32x16<S>>,
    reach: f32x16<S>,
    steps: u32,
) -> Stopped {
    // Written out by axis, not by closures: those are not always compiled for the vector unit.
    let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
    let size = [optics.width as f32, optics.height as f32];
    let Ray { from: mut at, mut cell, direction: way } = ray;
    let never = f32x16::splat(simd, NEVER);
    let inverse = [
        one / way[0].abs().simd_lt(NEVER).select(never, way[0]),
        one / way[1].abs().simd_lt(NEVER).select(never, way[1]),
    ];
    let back = [way[0].simd_lt(0.0), way[1].simd_lt(0.0)];
    let sign = [back[0].select(-one, one), back[1].select(-one, one)];
    // An edge has the coordinate of the cell behind it, seen from the left or from above.
    let beyond = [back[0].select(one, zero), back[1].select(one, zero)];
    let plane = back[0].select(one, zero) + back[1].select(one + one, zero);
    let plane = plane.to_int::<i32x16<S>>() * (optics.sites.len() as i32);

    let mut travelled = zero;
    let mut by_x = mask32x16::splat(simd, false);
    let mut inside = mask32x16::splat(simd, true);
    let (mut square, mut index) = look_up(simd, optics, plane, cell);
    let mut going = square.simd_gt(0.0);
    let (mut spent, mut reached) = (by_x, by_x);
    let (mut light, mut through) = ([zero; 3], [one; 3]);
    for _ in 0..steps {
        let matter = going & square.simd_ge(f32::from(MATTER));
        let side = matter.select(square - f32::from(MATTER), square);
        let next = [cell[0] + sign[0] * side, cell[1] + sign[1] * side];
        let edge = [next[0] + beyond[0], next[1] + beyond[1]];
        let tx = (edge[0] - at[0]) * inverse[0];
        let ty = (edge[1] - at[1]) * inverse[1];
        let x_first = tx.simd_lt(ty);
        let mut t = tx.min(ty);
        let mut crosses = [going & x_first, going & !x_first];
        if ENDS {
            let left = reach - travelled;
            let ends = going & t.simd_ge(left);
            t = t.min(left);
            crosses = [crosses[0] & !ends, crosses[1] & !ends];
            reached |= ends;
        }
        for a in 0..2 {
            // Along the axis that it crosses a ray lands exactly on the edge; along the other it
            // stays within the square, whatever rounding says.
            let along = at[a] + way[a] * t;
            let last = next[a] - sign[a];
            let within = along.floor().max(cell[a].min(last)).min(cell[a].max(last));
            at[a] = going.select(crosses[a].select(edge[a], along), at[a]);
            cell[a] = going.select(crosses[a].select(next[a], within), cell[a]);
        }
        if matter.to_bitmask() != 0 {
            let length = matter.select(t.max(0.0), zero);
            cross(optics, &index, length, &mut light, &mut through);
            let most = through[0].max(through[1]).max(through[2]);
            spent |= going & most.simd_lt(OPAQUE);
        }
        travelled = going.select(travelled + t, travelled);
        by_x = crosses[0] | (!going & by_x);
        let in_x = cell[0].simd_ge(0.0) & cell[0].simd_lt(size[0]);
        let in_y = cell[1].simd_ge(0.0) & cell[1].simd_lt(size[1]);
        inside = in_x & in_y;
        let safe = [inside.select(cell[0], zero), inside.select(cell[1], zero)];
        (square, index) = look_up(simd, optics, plane, safe);
        going = going & inside & !spent & !reached & square.simd_gt(0.0);
        if going.to_bitmask() == 0 {
            break;
        }
    }
    Stopped {
        at: [at[0].to_array(), at[1].to_array()],
        cell: [cell[0].to_array(), cell[1].to_array()],
        direction: [way[0].to_array(), way[1].to_array()],
        travelled: travelled.to_array(),
        left: !inside.to_bitmask(),
        light: [light[0].to_array(), light[1].to_array(), light[2].to_array()],
        through: [through[0].to_array(), through[1].to_array(), through[2].to_array()],
        tired: (going | spent).to_bitmask(),
        reached: reached.to_bitmask(),
        by_x: by_x.to_bitmask(),
    }
}

/// The squares that sixteen rays stand in, and the indices of their cells.
#[inline(always)]
fn look_up<S: Simd>(
    simd: S,
    optics: &Optics,
    plane: i32x16<S>,
    cell: [f32x16<S>; 2],
) -> (f32x16<S>, Lanes<i32>) {
    let index = (cell[1] * optics.width as f32 + cell[0]).to_int::<i32x16<S>>();
    let place = (index + plane).to_array();
    let squares = i32x16::from_fn(simd, |l| i32::from(optics.squares[place[l] as usize]));
    (squares.to_float(), index.to_array())
}

/// Crosses fog and glass, 0 px where there is none.
#[inline(always)]
fn cross<S: Simd>(
    optics: &Optics,
    index: &Lanes<i32>,
    length: f32x16<S>,
    light: &mut [f32x16<S>; 3],
    through: &mut [f32x16<S>; 3],
) {
    let simd = length.token();
    let mut t = length;
    for c in 0..3 {
        if c == 0 || optics.tints {
            let log = f32x16::from_fn(simd, |l| optics.log_transmittance[index[l] as usize][c]);
            t = exp_negative_lanes(log * length);
        }
        let source = f32x16::from_fn(simd, |l| optics.source[index[l] as usize][c]);
        light[c] += through[c] * ((-t + 1.0) * source);
        through[c] *= t;
    }
}
