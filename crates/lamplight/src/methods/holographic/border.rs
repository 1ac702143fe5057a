//! Light that enters through the border of the grid, for the cones of a quadrant.
//!
//! Rows beside the grid and planes behind it, which lie beyond the border, have the light that enters the grid
//! where the middle of its cone leaves it. It is found once for every cone and border cell, and is linear between
//! them.

use super::lattice::{BEYOND, edges, on_grid, slope};
use crate::inflow::ColumnWeights;
use crate::{Inflow, Rgb};
use rayon::prelude::*;
use std::ops::Range;

/// The way in which the slabs of a sweep lie in the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Orientation {
    pub along_x: bool,
    pub reversed: bool,
}

/// The light of all cones at the border.
#[derive(Debug, Default)]
pub struct BorderLight {
    depth: usize,
    rows: usize,
    /// Border cells of each point along the first row and along the last, slab by slab, and along the far end, row by row.
    cells: [Vec<usize>; 3],
    /// Radiance at those points, column by column of the inflow, as far as cones have weights there: cones read it point by
    /// point, in the order of memory.
    columns: Vec<Vec<Rgb>>,
    levels: Vec<LevelLight>,
}

/// The light of the cones of a level at the border.
#[derive(Debug, Default)]
struct LevelLight {
    /// Slopes of the middles of cones, rows per slab.
    slopes: Vec<f32>,
    /// The weights of columns, by cone.
    weights: Vec<ColumnWeights>,
    /// Cone by cone: along the side towards which it rises or falls, slab by slab, then along the far end, row by row.
    light: Vec<Rgb>,
}

impl BorderLight {
    /// Reads the inflow of a grid of `depth` × `rows` points `spacing` px apart, whose cones of each level, by number, stand for these angles.
    pub fn read<'a>(
        &mut self,
        inflow: &Inflow,
        orientation: Orientation,
        [depth, rows, spacing]: [usize; 3],
        levels: impl ExactSizeIterator<Item = (u32, &'a [f32])>,
    ) {
        (self.depth, self.rows) = (depth, rows);
        let cell = |place| {
            let place = orientation.on_grid(depth, place);
            inflow.nearest_cell(place.map(|v| v * spacing as f32))
        };
        // The middle of each cell, in points.
        let middles =
            |count: usize| (0..count * spacing).map(|i| (i as f32 + 0.5) / spacing as f32);
        for (cells, row) in self.cells.iter_mut().zip([0.0, rows as f32]) {
            cells.clear();
            cells.extend(middles(depth).map(|slab| cell([slab, row])));
        }
        let [_, _, end] = &mut self.cells;
        end.clear();
        end.extend(middles(rows).map(|row| cell([depth as f32, row])));
        let count = inflow.columns();
        self.columns.resize_with(count, Vec::new);
        self.columns.iter_mut().for_each(Vec::clear);
        let mut needed = vec![false; count];
        self.levels.resize_with(levels.len(), LevelLight::default);
        let levels = self.levels.iter_mut().zip(levels).map(|(held, (level, angles))| {
            // Those beyond the quadrant look along its edge.
            let inside = |cone: usize| cone.clamp(BEYOND, angles.len() - 1 - BEYOND);
            let middle = |cone| 0.5 * (slope(level, cone) + slope(level, cone + 1));
            let slopes = (0..angles.len()).map(|cone| middle(inside(cone)) as f32);
            held.slopes.clear();
            held.slopes.extend(slopes);
            held.weights.resize_with(angles.len(), ColumnWeights::default);
            for (cone, weights) in held.weights.iter_mut().enumerate() {
                let [from, to] =
                    on_grid(orientation.along_x, orientation.reversed, edges(level, inside(cone)));
                weights.set(count, from, to);
                weights.columns(count).for_each(|(column, _)| needed[column] = true);
            }
            (held, angles)
        });
        let levels: Vec<_> = levels.collect();
        let points = 2 * depth + rows;
        let of_columns = self.columns.par_iter_mut().zip(&needed).enumerate();
        of_columns.filter(|(_, (_, needed))| **needed).for_each(|(column, (light, _))| {
            let mean = |cells: &[usize]| {
                let sum = cells.iter().fold([0.0; 3], |sum: Rgb, &cell| {
                    let own = inflow.strip(cell)[column];
                    std::array::from_fn(|c| sum[c] + own[c])
                });
                sum.map(|v| v / spacing as f32)
            };
            light.reserve_exact(points);
            light.extend(self.cells.iter().flat_map(|cells| cells.chunks(spacing)).map(mean));
        });
        for (held, angles) in levels {
            let LevelLight { slopes, weights, light } = held;
            light.resize(angles.len() * (depth + rows), [0.0; 3]);
            let cones = light.par_chunks_mut(depth + rows).zip(&*slopes).zip(&*weights).zip(angles);
            cones.for_each(|(((light, slope), weights), angle)| {
                let (side, end) = light.split_at_mut(depth);
                side.fill([0.0; 3]);
                end.fill([0.0; 3]);
                let first = if *slope > 0.0 { depth } else { 0 };
                for (column, weight) in weights.columns(count) {
                    let of_column = &self.columns[column];
                    add(side, &of_column[first..first + depth], angle * weight);
                    add(end, &of_column[2 * depth..], angle * weight);
                }
            });
        }
    }

    /// Returns whether light of a cone comes from before the first row, and from behind the last.
    pub fn sides(&self, level: usize, cone: usize) -> [bool; 2] {
        let slopes = &self.levels[level].slopes;
        // Paths are bent to the rays of neighbours.
        let around =
            &slopes[cone.saturating_sub(2 * BEYOND)..(cone + 2 * BEYOND + 1).min(slopes.len())];
        [around.iter().any(|slope| *slope < 0.0), around.iter().any(|slope| *slope > 0.0)]
    }

    /// Returns the light of a cone at a place beyond the border, by its slab and row; of a level by its index.
    #[inline]
    pub fn at(&self, level: usize, cone: usize, slab: usize, row: isize) -> Rgb {
        let LevelLight { slopes, light, .. } = &self.levels[level];
        let light = &light[cone * (self.depth + self.rows)..][..self.depth + self.rows];
        let (side, end) = light.split_at(self.depth);
        let slope = slopes[cone];
        let [x, y] = [slab as f32 + 0.5, row as f32 + 0.5];
        let row = y + slope * (self.depth as f32 - x);
        if row >= 0.0 && row <= self.rows as f32 || slope == 0.0 {
            return between(end, row);
        }
        let edge = if slope > 0.0 { self.rows as f32 } else { 0.0 };
        between(side, x + (edge - y) / slope)
    }

    /// Stores the light of a cone at some rows of a plane, counted from the grid's first, which is at `pad`.
    pub fn store(
        &self,
        level: usize,
        cone: usize,
        slab: usize,
        range: Range<isize>,
        pad: usize,
        mut channels: [&mut [f32]; 3],
    ) {
        for row in range {
            let light = self.at(level, cone, slab, row);
            let place = pad.wrapping_add_signed(row);
            for (channel, light) in channels.iter_mut().zip(light) {
                channel[place] = light;
            }
        }
    }
}

/// Adds light, weighted.
#[inline]
fn add(to: &mut [Rgb], light: &[Rgb], weight: f32) {
    for (to, light) in to.as_flattened_mut().iter_mut().zip(light.as_flattened()) {
        *to += weight * light;
    }
}

impl Orientation {
    /// Returns the place in the grid of one in its slabs, `depth` of them.
    fn on_grid(self, depth: usize, [slab, row]: [f32; 2]) -> [f32; 2] {
        let slab = if self.reversed { depth as f32 - slab } else { slab };
        if self.along_x { [slab, row] } else { [row, slab] }
    }
}

/// Returns the light at a place along a side, linear between the middles of its cells.
#[inline]
fn between(side: &[Rgb], at: f32) -> Rgb {
    let at = (at - 0.5).clamp(0.0, (side.len() - 1) as f32);
    let before = at as usize;
    let past = at - before as f32;
    let (one, other) = (side[before], side[(before + 1).min(side.len() - 1)]);
    std::array::from_fn(|c| one[c] + (other[c] - one[c]) * past)
}
