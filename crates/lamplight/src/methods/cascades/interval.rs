//! Intervals of rays: their radiance and transmittance.
//!
//! Intervals start and end anywhere, in the grid or beyond it, where space is empty. They are traced
//! exactly, sixteen at once ([`crate::grid::packet`]).

use crate::grid::class::CellClass;
use crate::grid::empty_space::MATTER;
use crate::grid::medium_grid::MediumGrid;
use crate::grid::packet::{self, LANES, NEVER, Stopped, Termination};
use crate::grid::traverse::Ray;
use crate::simd::floor;
use crate::stages::bounce::Surfaces;
use crate::{Inflow, Rgb};
use fearless_simd::{f32x16, i32x16, mask32x16, prelude::*};
use rayon::prelude::*;

/// The intervals of sixteen rays: radiance and transmittance by channel.
#[derive(Clone, Copy)]
pub struct PacketIntervals<S: Simd> {
    pub light: [f32x16<S>; 3],
    pub transmittance: [f32x16<S>; 3],
}

impl<S: Simd> PacketIntervals<S> {
    /// Returns empty intervals, ⟨0, 1⟩.
    #[inline(always)]
    pub fn empty(simd: S) -> Self {
        let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
        Self { light: [zero; 3], transmittance: [one; 3] }
    }
}

/// The empty space around each cell, px: nothing lies within a square of `2·radius + 1` cells.
#[derive(Debug, Default)]
pub struct EmptyRadius(Vec<u8>);

impl EmptyRadius {
    /// Measures it from the empty squares that open from a cell into the four quadrants.
    pub fn measure(&mut self, grid: &MediumGrid) {
        self.0.resize(grid.classes.len(), 0);
        let [a, b, c, d] = std::array::from_fn(|quadrant| grid.empty_space.plane(quadrant));
        self.0.par_chunks_mut(4096).enumerate().for_each(|(chunk, radii)| {
            for (i, radius) in (chunk * 4096..).zip(radii) {
                let least = a[i].min(b[i]).min(c[i]).min(d[i]);
                // A cell of matter has this bit in all four.
                *radius = if least >= MATTER { 0 } else { least.saturating_sub(1) };
            }
        });
    }

    /// Returns the least radius of sixteen cells.
    #[inline(always)]
    fn least(&self, cells: &[i32; LANES]) -> u8 {
        let mut least = u8::MAX;
        for &i in cells {
            least = least.min(self.0[i as usize]);
        }
        least
    }
}

/// The data that rays read.
#[derive(Clone, Copy)]
pub struct TracedScene<'a> {
    pub grid: &'a MediumGrid,
    pub surfaces: &'a Surfaces,
    pub empty_radius: &'a EmptyRadius,
}

impl TracedScene<'_> {
    /// Returns whether nothing lies within `reach` px of any of sixteen points, along each axis.
    #[inline(always)]
    pub fn is_empty_around<S: Simd>(&self, from: [f32x16<S>; 2], reach: f32) -> bool {
        let inside = self.inside(from);
        if inside.to_bitmask() != u64::from(u16::MAX) {
            return false;
        }
        let [x, y] = [floor(from[0]), floor(from[1])];
        if self.grid.inflow().is_some() {
            // The border is not empty.
            let [w, h] = self.size();
            let to_border = x.min(y).min(-x + (w - 1.0)).min(-y + (h - 1.0));
            if to_border.simd_ge(reach).to_bitmask() != u64::from(u16::MAX) {
                return false;
            }
        }
        let index = (y * self.grid.size[0] as f32 + x).to_int::<i32x16<S>>().to_array();
        f32::from(self.empty_radius.least(&index)) >= reach
    }

    /// Returns the intervals of sixteen rays of `reach` px in unit directions, which stand for the angles between
    /// `edges`.
    pub fn trace<S: Simd>(
        &self,
        simd: S,
        from: [f32x16<S>; 2],
        direction: [f32x16<S>; 2],
        reach: f32x16<S>,
        edges: [f64; 2],
    ) -> PacketIntervals<S> {
        // Not inlined, so that it is compiled once per vector unit, not once per caller.
        simd.vectorize(
            #[inline(always)]
            || {
                let traced = self.clip_and_march(simd, from, direction, reach);
                match self.grid.inflow() {
                    None => traced,
                    Some(inflow) => {
                        let rays = Ray { from, cell: from, direction };
                        self.end_at_border(simd, traced, rays, reach, (inflow, edges))
                    }
                }
            },
        )
    }

    /// Ends rays where they leave the grid, with the light that enters there. Those that start outside have left it
    /// on their way.
    #[inline(always)]
    fn end_at_border<S: Simd>(
        &self,
        simd: S,
        traced: PacketIntervals<S>,
        rays: Ray<f32x16<S>>,
        reach: f32x16<S>,
        (inflow, [first, last]): (&Inflow, [f64; 2]),
    ) -> PacketIntervals<S> {
        let mut light = traced.light.map(|v| v.to_array());
        let mut transmittance = traced.transmittance.map(|v| v.to_array());
        for l in 0..LANES {
            let [from, direction] = [rays.from, rays.direction].map(|v| [v[0][l], v[1][l]]);
            let exit = self.grid.exit(from, direction);
            let inside = self.grid.contains(from);
            let length = (exit[0] - from[0]).hypot(exit[1] - from[1]);
            if inside && length >= reach[l] {
                continue;
            }
            let entering = inflow.mean(exit, first, last);
            for c in 0..3 {
                let passed = if inside { transmittance[c][l] } else { 1.0 };
                let near = if inside { light[c][l] } else { 0.0 };
                light[c][l] = near + passed * entering[c];
                transmittance[c][l] = 0.0;
            }
        }
        PacketIntervals {
            light: light.map(|v| f32x16::load_array(simd, v)),
            transmittance: transmittance.map(|v| f32x16::load_array(simd, v)),
        }
    }

    #[inline(always)]
    fn clip_and_march<S: Simd>(
        &self,
        simd: S,
        from: [f32x16<S>; 2],
        direction: [f32x16<S>; 2],
        reach: f32x16<S>,
    ) -> PacketIntervals<S> {
        let mut enters = self.inside(from);
        let all_inside = enters.to_bitmask() == u64::from(u16::MAX);
        let cell = [floor(from[0]), floor(from[1])];
        let (mut ray, mut length) = (Ray { from, cell, direction }, reach);
        if !all_inside {
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
            enter = enters.select(zero, enter);
            enters |= enter.simd_lt(leave);
            if enters.to_bitmask() == 0 {
                return PacketIntervals::empty(simd);
            }
            for a in 0..2 {
                let at = from[a] + direction[a] * enter;
                ray.from[a] = enters.select(at, f32x16::splat(simd, 0.5));
                ray.cell[a] = floor(ray.from[a]).max(0.0).min(size[a] - 1.0);
            }
            length = enters.select(reach - enter, zero);
        }
        let mut traced = self.march(simd, ray, length);
        if !all_inside {
            let (zero, one) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, 1.0));
            for c in 0..3 {
                traced.light[c] = enters.select(traced.light[c], zero);
                traced.transmittance[c] = enters.select(traced.transmittance[c], one);
            }
        }
        traced
    }

    /// Like [`Self::trace`], for rays that start inside the grid.
    #[inline(always)]
    fn march<S: Simd>(&self, simd: S, ray: Ray<f32x16<S>>, reach: f32x16<S>) -> PacketIntervals<S> {
        let stopped = packet::march_within(simd, self.grid, ray, reach, u32::MAX);
        let (mut light, mut transmittance) = (stopped.light, stopped.transmittance);
        let mut hits = stopped.hits();
        while hits != 0 {
            let l = hits.trailing_zeros() as usize;
            hits &= hits - 1;
            let outgoing = self.outgoing(&stopped, l);
            for c in 0..3 {
                light[c][l] += transmittance[c][l] * outgoing[c];
                transmittance[c][l] = 0.0;
            }
        }
        let mut traced = PacketIntervals::empty(simd);
        for c in 0..3 {
            traced.light[c] = f32x16::load_array(simd, light[c]);
            traced.transmittance[c] = f32x16::load_array(simd, transmittance[c]);
        }
        traced
    }

    /// Returns the outgoing radiance of the face at which a ray ended.
    #[inline(always)]
    fn outgoing(&self, stopped: &Stopped, lane: usize) -> Rgb {
        let cell = [stopped.cell[0][lane] as i32, stopped.cell[1][lane] as i32];
        let index = (cell[1] * self.grid.size[0] + cell[0]) as usize;
        debug_assert_eq!(self.grid.classes[index], CellClass::Solid);
        let emission = self.grid.source[index];
        let Some(slot) = self.surfaces.slot(index) else { return emission };
        let direction = [stopped.direction[0][lane], stopped.direction[1][lane]];
        let axis = match stopped.termination(lane) {
            Termination::Hit(axis) if stopped.travelled[lane] > 0.0 => axis,
            _ => entry_axis([stopped.at[0][lane], stopped.at[1][lane]], cell, direction),
        };
        let face = 2 * axis + (direction[axis] < 0.0) as usize;
        let reflected = self.surfaces.wall_reflected[slot][face];
        [emission[0] + reflected[0], emission[1] + reflected[1], emission[2] + reflected[2]]
    }

    #[inline(always)]
    fn inside<S: Simd>(&self, at: [f32x16<S>; 2]) -> mask32x16<S> {
        let [w, h] = self.size();
        at[0].simd_ge(0.0) & at[0].simd_lt(w) & at[1].simd_ge(0.0) & at[1].simd_lt(h)
    }

    #[inline(always)]
    fn size(&self) -> [f32; 2] {
        [self.grid.size[0] as f32, self.grid.size[1] as f32]
    }
}

/// Returns the axis along which a ray that starts within a wall would have entered it.
fn entry_axis(at: [f32; 2], cell: [i32; 2], direction: [f32; 2]) -> usize {
    let back: [f32; 2] = std::array::from_fn(|a| {
        let edge = (cell[a] + (direction[a] < 0.0) as i32) as f32;
        (at[a] - edge) / if direction[a].abs() < NEVER { NEVER } else { direction[a] }
    });
    (back[1] < back[0]) as usize
}
