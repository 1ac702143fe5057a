//! Two opposite quadrants: the light that arrives along one axis of the grid.

use super::border::Orientation;
use super::extend::IntervalLevels;
use super::faces::{self, Receivers, face_sums};
use super::gather::{FinalGather, GatherTile};
use super::interval::LANES;
use super::lattice::{GatherGeometry, on_grid, planes};
use super::merge::MergedLight;
use super::row_bits::{TILE, VECTORS, any_in_vector};
use super::slabs::{Axis, Slabs};
use crate::settings;
use crate::simd::dispatch_wide;
use crate::stages::bounce::Surfaces;
use crate::{Cells, Rgb};
use fearless_simd::{Level, f32x16, prelude::*};
use std::ops::Range;

/// The buffers of a pair of opposite quadrants.
#[derive(Debug)]
pub struct AxisSweep {
    axis: Axis,
    slabs: Slabs,
    intervals: IntervalLevels,
    merged: MergedLight,
    final_gather: FinalGather,
    /// ∫ L dω over both quadrants, by channel, slab by slab.
    light: [Vec<f32>; 3],
    /// ∫ L ω dω likewise, along the axis and across it; empty if it was not asked for.
    moment: [[Vec<f32>; 3]; 2],
    /// From one slab to the next in `light`.
    stride: usize,
    /// ∫ L cosθ dω on faces by normal, for each open cell in front of one.
    faces: Vec<[Rgb; 4]>,
}

/// The results of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// The light of the open cells whose light surfaces need.
    Surfaces,
    /// That of all open cells.
    Light,
    /// Their first moment, too.
    Moment,
}

/// The input of a sweep.
#[derive(Clone, Copy)]
pub struct SweepInput<'a> {
    pub cells: &'a Cells,
    /// Surfaces that reflect or scatter; none for direct light.
    pub surfaces: Option<&'a Surfaces>,
    pub receivers: &'a Receivers,
    pub wanted: Wanted,
    pub settings: &'a settings::Holographic,
}

impl AxisSweep {
    /// Creates the sweep along an axis.
    pub fn new(axis: Axis) -> Self {
        Self {
            axis,
            slabs: Slabs::default(),
            intervals: IntervalLevels::default(),
            merged: MergedLight::default(),
            final_gather: FinalGather::default(),
            light: Default::default(),
            moment: Default::default(),
            stride: 0,
            faces: Vec::new(),
        }
    }

    /// Lights the grid from both sides.
    pub fn solve(&mut self, unit: Level, input: SweepInput) {
        let settings = input.settings;
        let geometry = GatherGeometry::new(settings);
        let beyond = geometry.max_length().max(faces::REACH);
        let spacing = 1 << geometry.spacing_level;
        self.slabs.read(input.cells, self.axis, [beyond, spacing], input.surfaces);
        self.intervals.prepare(&self.slabs, geometry);
        let Slabs { depth, rows, .. } = self.slabs;
        self.merged.prepare(&self.slabs, &self.intervals, geometry);
        // Not a power of two: cells of neighbouring slabs would compete for places in caches.
        self.stride = rows.next_multiple_of(TILE) + LANES;
        for light in &mut self.light {
            light.resize(depth * self.stride, 0.0);
        }
        let with_moment = input.wanted == Wanted::Moment;
        for moment in self.moment.as_flattened_mut() {
            moment.resize(if with_moment { depth * self.stride } else { 0 }, 0.0);
        }
        self.faces.clear();
        self.faces.resize(input.receivers.face_cells(), [[0.0; 3]; 4]);
        self.intervals.prepare_bundles(&self.slabs, settings.bundle_rays);
        self.final_gather.prepare(&self.slabs, geometry);
        for _ in 0..2 {
            self.quadrant(unit, input, geometry);
            self.slabs.reverse();
        }
    }

    /// Adds the light that arrives from ahead.
    fn quadrant(&mut self, unit: Level, input: SweepInput, geometry: GatherGeometry) {
        let sky = input.cells.sky();
        let (along_x, reversed) = (self.axis == Axis::X, self.slabs.reversed);
        match input.cells.inflow() {
            Some(inflow) => {
                self.merged.begin_with_inflow(inflow, Orientation { along_x, reversed });
            }
            None => self.merged.begin(|edges| {
                let [from, to] = on_grid(along_x, reversed, edges);
                sky.mean(from, to)
            }),
        }
        for plane in (1..=geometry.last_plane(self.slabs.depth)).rev() {
            if plane < planes(self.slabs.depth, geometry.level) {
                self.intervals.make(unit, &self.slabs, plane);
            }
            self.merged.merge_down(unit, &self.intervals, plane);
            self.merged.spread(unit, &self.slabs, plane << geometry.level);
            let slabs = geometry.slabs(plane, self.slabs.depth);
            match self.slabs.channels {
                1 => dispatch_wide!(unit, simd => self.gather::<_, 1>(simd, input, plane, slabs)),
                _ => dispatch_wide!(unit, simd => self.gather::<_, 3>(simd, input, plane, slabs)),
            }
        }
    }

    /// Lights the pixels of some slabs from a plane.
    #[inline(always)]
    fn gather<S: Simd, const K: usize>(
        &mut self,
        simd: S,
        input: SweepInput,
        plane: usize,
        slabs: Range<usize>,
    ) {
        // Tile by tile: 64 rows of the plane stay in the caches while all slabs gather from it.
        for row in (0..self.slabs.rows).step_by(TILE) {
            for slab in slabs.clone() {
                let bits = input.receivers.bits(self.axis, self.slabs.column(slab), row / TILE);
                let all = input.wanted != Wanted::Surfaces;
                let lit = if all { bits.open } else { bits.surfaces };
                if lit != 0 {
                    let pixels = GatherTile { slab, row, plane, lit, faces: bits.faces };
                    self.gather_tile::<S, K>(simd, input, pixels);
                }
            }
        }
    }

    /// Lights 64 pixels of a slab.
    #[inline(always)]
    fn gather_tile<S: Simd, const K: usize>(
        &mut self,
        simd: S,
        input: SweepInput,
        pixels: GatherTile,
    ) {
        let GatherTile { slab, row, faces, .. } = pixels;
        let (slabs, reversed) = (&self.slabs, self.slabs.reversed);
        let mut moment = [[[f32x16::splat(simd, 0.0); VECTORS]; 3]; 2];
        let with_moment = input.wanted == Wanted::Moment;
        let moments = with_moment.then_some(&mut moment);
        let light = self.final_gather.light::<S, K>(simd, slabs, &self.merged, pixels, moments);
        let place = slabs.column(slab) * self.stride + row;
        for (c, sum) in self.light.iter_mut().enumerate() {
            store(simd, light[c], 1.0, reversed, &mut sum[place..][..TILE]);
        }
        if with_moment {
            // Ahead is the other way in the opposite quadrant; rows are the same.
            let ahead = if reversed { -1.0 } else { 1.0 };
            for ((sums, moment), sign) in self.moment.iter_mut().zip(&moment).zip([ahead, 1.0]) {
                for (sum, moment) in sums.iter_mut().zip(moment) {
                    store(simd, *moment, sign, reversed, &mut sum[place..][..TILE]);
                }
            }
        }
        let width = input.cells.width() as usize;
        let normals = normals(self.axis, reversed);
        for v in (0..VECTORS).filter(|v| any_in_vector(faces, v * LANES)) {
            let sums = face_sums(simd, slabs, &self.final_gather, slab, row + v * LANES);
            let mut left = faces >> (v * LANES) & 0xffff;
            while left != 0 {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                let row = row + v * LANES + lane;
                let slot = input.receivers.slot(slabs.cell(self.axis, slab, row, width));
                for (sum, normal) in sums.iter().zip(normals) {
                    for c in 0..3 {
                        self.faces[slot][normal][c] += sum[c][lane];
                    }
                }
            }
        }
    }

    /// Returns ∫ L dω of a channel at the rows of a slab, in the order of the grid.
    #[inline(always)]
    pub fn slab(&self, channel: usize, slab: usize) -> &[f32] {
        &self.light[channel][slab * self.stride..][..self.stride]
    }

    /// Returns ∫ L ω dω of a channel at the rows of a slab, along an axis of the grid: 0 for x, 1 for y.
    #[inline(always)]
    pub fn moment_slab(&self, axis: usize, channel: usize, slab: usize) -> &[f32] {
        let across = axis != self.axis as usize;
        &self.moment[usize::from(across)][channel][slab * self.stride..][..self.stride]
    }

    /// Returns ∫ L dω at a cell.
    #[inline(always)]
    pub fn light(&self, x: usize, y: usize) -> Rgb {
        let at = match self.axis {
            Axis::X => x * self.stride + y,
            Axis::Y => y * self.stride + x,
        };
        [self.light[0][at], self.light[1][at], self.light[2][at]]
    }

    /// Returns ∫ L cosθ dω on a face, by the slot of the cell in front and the index of its normal.
    pub fn face(&self, slot: usize, normal: usize) -> Rgb {
        self.faces[slot][normal]
    }
}

/// Stores the values of a tile times a sign, or adds them to those that are there.
#[inline(always)]
fn store<S: Simd>(simd: S, values: [f32x16<S>; VECTORS], sign: f32, add: bool, to: &mut [f32]) {
    for (value, to) in values.into_iter().zip(to.chunks_exact_mut(LANES)) {
        let mut value = value * sign;
        if add {
            value += f32x16::from_slice(simd, to);
        }
        value.store_slice(to);
    }
}

/// Returns the normals (indices in [`crate::stages::faces::NORMALS`]) of faces that look ahead, to
/// higher rows and to lower ones.
fn normals(axis: Axis, reversed: bool) -> [usize; 3] {
    match (axis, reversed) {
        (Axis::X, false) => [1, 3, 2],
        (Axis::X, true) => [0, 3, 2],
        (Axis::Y, false) => [3, 1, 0],
        (Axis::Y, true) => [2, 1, 0],
    }
}
