//! Light that enters through the border of the grid, for the cones of a quadrant.
//!
//! Rows beside the grid and planes behind it, which lie beyond the border, have the light that enters the grid
//! where the middle of its cone leaves it. It is linear between border cells. Wide cones see the mean of many columns,
//! which is found once for every cone and border cell; most cones are narrower than a column, and take theirs from two or
//! three.

use super::lattice::{BEYOND, edges, on_grid, slope};
use crate::inflow::ColumnWeights;
use crate::panorama::column;
use crate::{Inflow, Rgb};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_4, TAU};
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
    /// The inflow that it was read from, the way of the sweep, and the points of the grid and px between them.
    read: Option<(Inflow, Orientation, [usize; 3])>,
    /// Border cells of each point along the first row and along the last, slab by slab, and along the far end, row by row.
    cells: [Vec<usize>; 3],
    /// Radiance by column: of each point along the first row, along the last, and along the far end.
    columns: Vec<Rgb>,
    levels: Vec<LevelLight>,
}

/// The light of the cones of a level at the border.
#[derive(Debug, Default)]
struct LevelLight {
    /// Slopes of the middles of cones, rows per slab.
    slopes: Vec<f32>,
    cones: ConesLight,
}

#[derive(Debug)]
enum ConesLight {
    /// Cone by cone: along the side towards which it rises or falls, slab by slab, then along the far end, row by row.
    Wide(Vec<Rgb>),
    /// The first column that each cone sees, and the weights of it and the next.
    Narrow(Vec<(usize, [f32; MOST_COLUMNS])>),
}

/// The most columns that a cone sees that is narrower than one.
const MOST_COLUMNS: usize = 3;

impl Default for ConesLight {
    fn default() -> Self {
        Self::Wide(Vec::new())
    }
}

impl BorderLight {
    /// Reads the inflow of a grid of `depth` × `rows` points `spacing` px apart, whose cones of each level, by number, stand for these angles.
    pub fn read<'a>(
        &mut self,
        inflow: &Inflow,
        orientation: Orientation,
        grid: [usize; 3],
        levels: impl ExactSizeIterator<Item = (u32, &'a [f32])>,
    ) {
        let is_same = |(held, way, size): &(Inflow, Orientation, [usize; 3])| {
            held.is(inflow) && (*way, *size) == (orientation, grid)
        };
        if self.read.as_ref().is_some_and(is_same) {
            return;
        }
        self.read = Some((inflow.clone(), orientation, grid));
        let [depth, rows, spacing] = grid;
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
        self.levels.resize_with(levels.len(), LevelLight::default);
        let all = inflow.columns();
        // Angles of the grid between which a cone lies. Those beyond the quadrant look along its edge.
        let between = |level, count: usize, cone: usize| {
            let inside = cone.clamp(BEYOND, count - 1 - BEYOND);
            on_grid(orientation.along_x, orientation.reversed, edges(level, inside))
        };
        let quadrant = on_grid(orientation.along_x, orientation.reversed, [-FRAC_PI_4, FRAC_PI_4]);
        // Rounding may put its edge into the column before.
        let [from, to] = quadrant.map(|angle| (column(all, angle) - 1e-6).floor() as i64);
        let begin = from.rem_euclid(all as i64) as usize;
        let count = all.min((to - from) as usize + MOST_COLUMNS);
        // The place in the table of a column of the inflow.
        let place_of = |column: usize| (column + all - begin) % all;
        let [first, last, end] = &self.cells;
        let points = 2 * depth + rows;
        self.columns.resize(count * points, [0.0; 3]);
        let columns = self.columns.par_chunks_mut(points).enumerate();
        columns.for_each(|(number, light)| {
            let number = (begin + number) % all;
            let cells = [first, last, end].into_iter().flat_map(|side| side.chunks(spacing));
            for (light, cells) in light.iter_mut().zip(cells) {
                let sum = cells.iter().fold([0.0; 3], |sum: Rgb, &cell| {
                    let radiance = inflow.strip(cell)[number];
                    std::array::from_fn(|c| sum[c] + radiance[c])
                });
                *light = sum.map(|v| v / spacing as f32);
            }
        });
        for (held, (level, angles)) in self.levels.iter_mut().zip(levels) {
            let inside = |cone: usize| cone.clamp(BEYOND, angles.len() - 1 - BEYOND);
            let middle = |cone| 0.5 * (slope(level, cone) + slope(level, cone + 1));
            let slopes = (0..angles.len()).map(|cone| middle(inside(cone)) as f32);
            held.slopes.clear();
            held.slopes.extend(slopes);
            let widest = angles.iter().copied().fold(0.0, f32::max);
            if f64::from(widest) * all as f64 <= TAU {
                let mut weights = ColumnWeights::default();
                let narrow = angles.iter().enumerate().map(|(cone, &angle)| {
                    let [from, to] = between(level, angles.len(), cone);
                    weights.set(all, from, to);
                    let (first, found) = weights.of_columns();
                    let mut of_columns = [0.0; MOST_COLUMNS];
                    for (weight, found) in of_columns.iter_mut().zip(found) {
                        *weight = angle * found;
                    }
                    (place_of(first), of_columns)
                });
                held.cones = ConesLight::Narrow(narrow.collect());
                continue;
            }
            let mut light = match std::mem::take(&mut held.cones) {
                ConesLight::Wide(light) => light,
                ConesLight::Narrow(_) => Vec::new(),
            };
            light.resize(angles.len() * (depth + rows), [0.0; 3]);
            let cones = light.par_chunks_mut(depth + rows).zip(&held.slopes).enumerate();
            let found = &self.columns;
            cones.for_each_init(ColumnWeights::default, |weights, (cone, (light, slope))| {
                let [from, to] = between(level, angles.len(), cone);
                weights.set(all, from, to);
                let (first, weights) = weights.of_columns();
                let first = place_of(first);
                light.fill([0.0; 3]);
                for (i, weight) in weights.iter().enumerate() {
                    let column = &found[(first + i) % count * points..][..points];
                    let side = if *slope > 0.0 { &column[depth..] } else { column };
                    let seen = side[..depth].iter().chain(&column[2 * depth..]);
                    for (light, radiance) in light.iter_mut().zip(seen) {
                        (0..3).for_each(|c| light[c] += angles[cone] * weight * radiance[c]);
                    }
                }
            });
            held.cones = ConesLight::Wide(light);
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
        let LevelLight { slopes, cones } = &self.levels[level];
        let [depth, rows] = [self.depth, self.rows];
        let slope = slopes[cone];
        let [x, y] = [slab as f32 + 0.5, row as f32 + 0.5];
        let row = y + slope * (depth as f32 - x);
        let at_end = row >= 0.0 && row <= rows as f32 || slope == 0.0;
        let rises = slope > 0.0;
        let place =
            if at_end { row } else { x + (if rises { rows as f32 } else { 0.0 } - y) / slope };
        let place = SidePlace::new(place, if at_end { rows } else { depth });
        match cones {
            ConesLight::Wide(light) => {
                let light = &light[cone * (depth + rows)..];
                place.of(if at_end { &light[depth..] } else { light })
            }
            ConesLight::Narrow(narrow) => {
                let points = 2 * depth + rows;
                let side = if at_end { 2 * depth } else { depth * usize::from(rises) };
                let (first, weights) = narrow[cone];
                let count = self.columns.len() / points;
                let mut sum = [0.0; 3];
                for (i, weight) in weights.into_iter().enumerate() {
                    let column = first + i;
                    let column = if column >= count { column % count } else { column };
                    let radiance = place.of(&self.columns[column * points + side..]);
                    (0..3).for_each(|c| sum[c] += weight * radiance[c]);
                }
                sum
            }
        }
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

impl Orientation {
    /// Returns the place in the grid of one in its slabs, `depth` of them.
    fn on_grid(self, depth: usize, [slab, row]: [f32; 2]) -> [f32; 2] {
        let slab = if self.reversed { depth as f32 - slab } else { slab };
        if self.along_x { [slab, row] } else { [row, slab] }
    }
}

/// A place along a side: the cells before and after it, and the fraction of the way between their middles.
struct SidePlace {
    cells: [usize; 2],
    past: f32,
}

impl SidePlace {
    #[inline]
    fn new(at: f32, cells: usize) -> Self {
        let at = (at - 0.5).clamp(0.0, (cells - 1) as f32);
        let before = at as usize;
        Self { cells: [before, (before + 1).min(cells - 1)], past: at - before as f32 }
    }

    /// Returns the light there, linear between the middles of the cells of the side.
    #[inline]
    fn of(&self, side: &[Rgb]) -> Rgb {
        let [one, other] = self.cells.map(|cell| side[cell]);
        std::array::from_fn(|c| one[c] + (other[c] - one[c]) * self.past)
    }
}
