//! What a piece of a ray brings back, and how much gets through it.
//!
//! Pieces start and end anywhere, in the grid or beyond it, where all is empty. They are traced
//! exactly, sixteen at once ([`crate::stages::packet`]).

use crate::Rgb;
use crate::stages::bounce::Surfaces;
use crate::stages::clearance::MATTER;
use crate::stages::optics::{Kind, Optics};
use crate::stages::packet::{self, LANES, NEVER, Ray, Stopped, Why};
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
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
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

impl Room {
    #[inline(always)]
    fn least(&self, cells: &[i32; LANES]) -> u8 {
        let mut least = u8::MAX;
        for &i in cells {
            least = least.min(self.0[i as usize]);
        }
        least
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
        let [x, y] = [from[0].floor(), from[1].floor()];
        let index = (y * self.optics.width as f32 + x).to_int::<i32x16<S>>().to_array();
        let room = self.room.least(&index);
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
            let ray = Ray { from, cell: [from[0].floor(), from[1].floor()], direction };
            return self.march(simd, ray, reach);
        }
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
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
        let mut ray = Ray { from, cell: from, direction };
        for a in 0..2 {
            let at = from[a] + direction[a] * enter;
            ray.from[a] = enters.select(at, f32x16::splat(simd, 0.5));
            ray.cell[a] = ray.from[a].floor().max(0.0).min(size[a] - 1.0);
        }
        let reach = enters.select(reach - enter, zero);
        let mut seen = self.march(simd, ray, reach);
        for c in 0..3 {
            seen.light[c] = enters.select(seen.light[c], zero);
            seen.through[c] = enters.select(seen.through[c], one);
        }
        seen
    }

    #[inline(always)]
    fn march<S: Simd>(&self, simd: S, ray: Ray<f32x16<S>>, reach: f32x16<S>) -> Interval<S> {
        let stopped = packet::march_within(simd, self.optics, ray, reach, u32::MAX);
        let (mut light, mut through) = (stopped.light, stopped.through);
        let mut closed = stopped.closed();
        while closed != 0 {
            let l = closed.trailing_zeros() as usize;
            closed &= closed - 1;
            let sent = self.sent(&stopped, l);
            for c in 0..3 {
                light[c][l] += through[c][l] * sent[c];
                through[c][l] = 0.0;
            }
        }
        let mut seen = Interval::clear(simd);
        for c in 0..3 {
            seen.light[c] = f32x16::load_array(simd, light[c]);
            seen.through[c] = f32x16::load_array(simd, through[c]);
        }
        seen
    }

    /// What the face of the wall sends out at which a ray ended.
    #[inline(always)]
    fn sent(&self, stopped: &Stopped, lane: usize) -> Rgb {
        let cell = [stopped.cell[0][lane] as i32, stopped.cell[1][lane] as i32];
        let index = (cell[1] * self.optics.width + cell[0]) as usize;
        debug_assert_eq!(self.optics.sites[index].kind, Kind::Solid);
        let emission = self.optics.source[index];
        let Some(slot) = self.surfaces.slot(index) else { return emission };
        let direction = [stopped.direction[0][lane], stopped.direction[1][lane]];
        let axis = match stopped.why(lane) {
            Why::Closed(axis) if stopped.travelled[lane] > 0.0 => axis,
            _ => way_in([stopped.at[0][lane], stopped.at[1][lane]], cell, direction),
        };
        let face = 2 * axis + (direction[axis] < 0.0) as usize;
        let sent = self.surfaces.wall_sent[slot][face];
        [emission[0] + sent[0], emission[1] + sent[1], emission[2] + sent[2]]
    }

    #[inline(always)]
    fn inside<S: Simd>(&self, at: [f32x16<S>; 2]) -> fearless_simd::mask32x16<S> {
        let [w, h] = self.size();
        at[0].simd_ge(0.0) & at[0].simd_lt(w) & at[1].simd_ge(0.0) & at[1].simd_lt(h)
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
