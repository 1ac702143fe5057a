//! What a piece of a ray brings back, and how much gets through it.
//!
//! Pieces start and end anywhere, in the grid or beyond it, where all is empty. They are traced
//! exactly, sixteen at once ([`crate::stages::packet`]).

use crate::Rgb;
use crate::stages::bounce::Surfaces;
use crate::stages::clearance::MATTER;
use crate::stages::optics::{Kind, Optics};
use crate::stages::packet::{self, LANES, NEVER, Ray, Why};
use fearless_simd::{f32x16, i32x16, prelude::*};
use rayon::prelude::*;

/// Light gathered on the way, and the share of what lies behind that gets through, by channel, of
/// sixteen rays.
#[derive(Clone, Copy)]
pub struct Interval<S: Simd> {
    pub light: [f32x16<S>; 3],
    pub through: [f32x16<S>; 3],
}

impl<S: Simd> Interval<S> {
    /// Nothing in the way.
    #[inline(always)]
    pub fn clear(simd: S) -> Self {
        let [zero, one] = [0.0, 1.0].map(|v| f32x16::splat(simd, v));
        Self { light: [zero; 3], through: [one; 3] }
    }
}

/// px round each cell that are clear: nothing within a square of `2·room + 1` cells.
#[derive(Debug, Default)]
pub struct Room(Vec<u8>);

impl Room {
    /// From the clear squares that open from a cell into the four quadrants.
    pub fn measure(&mut self, optics: &Optics) {
        let n = optics.sites.len();
        self.0.resize(n, 0);
        let [a, b, c, d] = std::array::from_fn(|quadrant| &optics.squares[quadrant * n..][..n]);
        self.0.par_chunks_mut(4096).enumerate().for_each(|(chunk, room)| {
            for (i, room) in (chunk * 4096..).zip(room) {
                let least = a[i].min(b[i]).min(c[i]).min(d[i]);
                // A cell of matter has it in all four.
                *room = if least >= MATTER { 0 } else { least.saturating_sub(1) };
            }
        });
    }
}

/// Everything that rays read.
#[derive(Clone, Copy)]
pub struct Field<'a> {
    pub optics: &'a Optics,
    pub surfaces: &'a Surfaces,
    pub room: &'a Room,
}

impl Field<'_> {
    /// Whether nothing lies within `reach` px of any of sixteen points, along each axis.
    #[inline(always)]
    pub fn is_clear<S: Simd>(&self, from: [f32x16<S>; 2], reach: f32) -> bool {
        let inside = self.inside(from);
        if inside.to_bitmask() != u64::from(u16::MAX) {
            return false;
        }
        let [x, y] = from.map(|v| v.floor());
        let index = (y * self.optics.width as f32 + x).to_int::<i32x16<S>>().to_array();
        let room = index.into_iter().fold(u8::MAX, |least, i| least.min(self.room.0[i as usize]));
        f32::from(room) >= reach
    }

    /// Sixteen rays of `reach` px in unit directions.
    #[inline(always)]
    pub fn trace<S: Simd>(
        &self,
        simd: S,
        from: [f32x16<S>; 2],
        direction: [f32x16<S>; 2],
        reach: f32x16<S>,
    ) -> Interval<S> {
        let inside = self.inside(from);
        if inside.to_bitmask() == u64::from(u16::MAX) {
            let ray = Ray { from, cell: from.map(|v| v.floor()), direction };
            return self.march(simd, ray, reach);
        }
        let [zero, one] = [0.0, 1.0].map(|v| f32x16::splat(simd, v));
        let size = self.size();
        let (mut enter, mut leave) = (zero, reach);
        for a in 0..2 {
            let steep = direction[a].abs().simd_lt(NEVER);
            let inverse = one / steep.select(f32x16::splat(simd, NEVER), direction[a]);
            let [low, high] = [-from[a] * inverse, (-from[a] + size[a]) * inverse];
            enter = enter.max(low.min(high));
            leave = leave.min(low.max(high));
        }
        let enters = inside | enter.simd_lt(leave);
        if enters.to_bitmask() == 0 {
            return Interval::clear(simd);
        }
        let enter = inside.select(zero, enter);
        let at: [_; 2] = std::array::from_fn(|a| {
            enters.select(from[a] + direction[a] * enter, f32x16::splat(simd, 0.5))
        });
        let cell = std::array::from_fn(|a| at[a].floor().max(0.0).min(size[a] - 1.0));
        let reach = enters.select(reach - enter, zero);
        let seen = self.march(simd, Ray { from: at, cell, direction }, reach);
        Interval {
            light: seen.light.map(|v| enters.select(v, zero)),
            through: seen.through.map(|v| enters.select(v, one)),
        }
    }

    #[inline(always)]
    fn march<S: Simd>(&self, simd: S, ray: Ray<f32x16<S>>, reach: f32x16<S>) -> Interval<S> {
        let stopped = packet::march_within(simd, self.optics, ray, reach, u32::MAX);
        let (mut light, mut through) = (stopped.light, stopped.through);
        for l in 0..LANES {
            let Why::Closed(axis) = stopped.why(l) else { continue };
            let cell = [stopped.cell[0][l] as i32, stopped.cell[1][l] as i32];
            let direction = [stopped.direction[0][l], stopped.direction[1][l]];
            let axis = if stopped.travelled[l] > 0.0 {
                axis
            } else {
                way_in([stopped.at[0][l], stopped.at[1][l]], cell, direction)
            };
            let sent = self.sent(cell, axis, direction);
            for c in 0..3 {
                light[c][l] += through[c][l] * sent[c];
                through[c][l] = 0.0;
            }
        }
        let load = |v: [[f32; LANES]; 3]| v.map(|v| f32x16::load_array(simd, v));
        Interval { light: load(light), through: load(through) }
    }

    /// What the face of a wall sends out by which a ray enters it along an axis.
    #[inline(always)]
    fn sent(&self, cell: [i32; 2], axis: usize, direction: [f32; 2]) -> Rgb {
        let index = (cell[1] * self.optics.width + cell[0]) as usize;
        debug_assert_eq!(self.optics.sites[index].kind, Kind::Solid);
        let emission = self.optics.source[index];
        let face = 2 * axis + (direction[axis] < 0.0) as usize;
        match self.surfaces.slot(index) {
            Some(slot) => {
                let sent = self.surfaces.wall_sent[slot][face];
                std::array::from_fn(|c| emission[c] + sent[c])
            }
            None => emission,
        }
    }

    #[inline(always)]
    fn inside<S: Simd>(&self, at: [f32x16<S>; 2]) -> fearless_simd::mask32x16<S> {
        let [x, y] = [0, 1].map(|a| at[a].simd_ge(0.0) & at[a].simd_lt(self.size()[a]));
        x & y
    }

    #[inline(always)]
    fn size(&self) -> [f32; 2] {
        [self.optics.width as f32, self.optics.height as f32]
    }
}

/// The axis along which a ray that starts within a wall would have come in.
fn way_in(at: [f32; 2], cell: [i32; 2], direction: [f32; 2]) -> usize {
    let back: [f32; 2] = std::array::from_fn(|a| {
        let edge = (cell[a] + (direction[a] < 0.0) as i32) as f32;
        (at[a] - edge) / if direction[a].abs() < NEVER { NEVER } else { direction[a] }
    });
    (back[1] < back[0]) as usize
}
