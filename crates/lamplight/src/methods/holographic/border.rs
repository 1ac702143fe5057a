//! Light that enters through the border of the grid, for the cones of a quadrant.
//!
//! Rows beside the grid and planes behind it, which lie beyond the border, have the light that enters the grid
//! where the middle of its cone leaves it. Paths of the merge read it there, each once; rows beside the grid are stored
//! as far as paths rise. Light is linear between border cells. Wide cones see the mean of many columns, which is found
//! once for every cone and border cell. Most cones are half cones that are narrower than a column: the two along a ray see
//! the same, the mean of both, which is taken from a few columns.

use super::interval::LANES;
use super::lattice::{BEYOND, cones, edges, on_grid, slope};
use crate::inflow::ColumnWeights;
use crate::panorama::column;
use crate::{Inflow, Rgb};
use fearless_simd::{f32x16, prelude::*};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_4, TAU};
use std::ops::Range;

/// The orientation of a sweep: how its slabs lie in the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Orientation {
    pub along_x: bool,
    pub reversed: bool,
}

/// The light of all cones at the border.
#[derive(Debug, Default)]
pub struct BorderLight {
    points: BorderPoints,
    /// The inflow that it was read from, the orientation of the sweep, and the points of the grid and px between them.
    read: Option<(Inflow, Orientation, [usize; 3])>,
    columns: QuadrantColumns,
    /// Radiance by column.
    radiance: PointLights,
    levels: Vec<LevelLight>,
}

/// The light at all points, several times.
#[derive(Debug, Default)]
struct PointLights {
    /// Along the first row and the last, with a fourth value that makes whole vectors: neighbouring rows see points that
    /// lie farther apart.
    rows: Vec<[f32; 4]>,
    /// Along the far end, channel by channel: neighbouring rows see neighbouring points.
    end: Vec<f32>,
}

/// The points along the border of a grid of `depth` slabs: its first row and its last, slab by slab, and its far end,
/// row by row. The outermost of each side are there twice, so that light is linear between two points everywhere.
#[derive(Clone, Copy, Debug, Default)]
struct BorderPoints {
    depth: usize,
    rows: usize,
}

/// The columns of an inflow of `all` columns that the cones of a quadrant see.
#[derive(Clone, Copy, Debug, Default)]
struct QuadrantColumns {
    all: usize,
    first: usize,
    count: usize,
}

/// The light of the cones of a level at the border.
#[derive(Debug, Default)]
struct LevelLight {
    /// Slopes of the middles of what cones see, rows per slab.
    slopes: Vec<f32>,
    cones: ConesLight,
}

#[derive(Debug)]
enum ConesLight {
    /// By cone; not along the row from which none of a cone's light comes.
    Wide(PointLights),
    /// By cone.
    Narrow(Vec<NarrowView>),
}

/// The columns that a cone sees: the place of the first, how many they are, and their weights.
#[derive(Clone, Copy, Debug)]
struct NarrowView {
    first: usize,
    count: usize,
    weights: [f32; MOST_COLUMNS],
}

/// The most columns that two cones see that are narrower than one each.
const MOST_COLUMNS: usize = 4;

impl Default for ConesLight {
    fn default() -> Self {
        Self::Wide(PointLights::default())
    }
}

/// The part of the light that enters a grid which a cone sees.
#[derive(Clone, Copy, Debug)]
pub struct BorderView {
    /// The slope of its middle.
    pub slope: f64,
    /// The angles between which it lies in the quadrant, radians.
    pub edges: [f64; 2],
}

/// Returns whether both half cones along a ray see the same: they do if each is narrower than one of so many columns.
pub fn is_shared(level: u32, columns: usize) -> bool {
    columns as f64 <= TAU * f64::from(1u32 << level)
}

/// Returns the view of a cone of a level; `shared`: that of both half cones along its ray. Those beyond the quadrant look along
/// its edge.
pub fn border_view(level: u32, cone: usize, shared: bool) -> BorderView {
    let inside = |cone: usize| cone.clamp(BEYOND, cones(level) - 1 - BEYOND);
    // The first along a ray has an odd index.
    let ray = cone.div_ceil(2);
    let pair = if shared { [(2 * ray).saturating_sub(1), 2 * ray] } else { [cone; 2] };
    let [first, last] = pair.map(inside);
    let slope = 0.5 * (slope(level, first) + slope(level, last + 1));
    BorderView { slope, edges: [edges(level, first)[0], edges(level, last)[1]] }
}

/// The number of the side along the far end; the others are the first row and the last.
const FAR_END: usize = 2;

/// Returns the number of the other side from which a cone has light, by its slope.
fn side_of(slope: f32) -> usize {
    usize::from(slope > 0.0)
}

impl BorderPoints {
    /// The number of points along the first row and the last, and along the far end.
    fn counts(self) -> [usize; 2] {
        [2 * (self.depth + 2), self.rows + 2]
    }

    /// The points of a side.
    #[inline]
    fn side(self, side: usize) -> Range<usize> {
        let begin = side * (self.depth + 2);
        begin..begin + 2 + if side == FAR_END { self.rows } else { self.depth }
    }

    /// Returns the border cells at each point, `spacing` of them.
    fn cells(self, inflow: &Inflow, orientation: Orientation, spacing: usize) -> Vec<usize> {
        let cell = |side: usize, along: f32| {
            let place = match side {
                0 => [along, 0.0],
                1 => [along, self.rows as f32],
                _ => [self.depth as f32, along],
            };
            let place = orientation.on_grid(self.depth, place);
            inflow.nearest_cell(place.map(|v| v * spacing as f32))
        };
        let of_side = |side: usize| {
            let count = self.side(side).len() - 2;
            let cells = (0..count + 2).flat_map(move |point| {
                let first = (point.clamp(1, count) - 1) * spacing;
                first..first + spacing
            });
            cells.map(move |i| cell(side, (i as f32 + 0.5) / spacing as f32))
        };
        (0..=FAR_END).flat_map(of_side).collect()
    }
}

impl PointLights {
    /// Makes room for `count` lights at all points.
    fn resize(&mut self, count: usize, points: BorderPoints) {
        let [rows, end] = points.counts();
        self.rows.resize(count * rows, [0.0; 4]);
        self.end.resize(count * 3 * end, 0.0);
    }

    /// Returns the light of a number.
    #[inline]
    fn of(&self, number: usize, points: BorderPoints) -> PointLight<'_> {
        let [rows, end] = points.counts();
        PointLight {
            rows: &self.rows[number * rows..][..rows],
            end: &self.end[number * 3 * end..][..3 * end],
        }
    }

    /// Returns all lights, to be filled.
    fn all_mut(
        &mut self,
        points: BorderPoints,
    ) -> impl IndexedParallelIterator<Item = (&mut [[f32; 4]], &mut [f32])> {
        let [rows, end] = points.counts();
        self.rows.par_chunks_mut(rows).zip(self.end.par_chunks_mut(3 * end))
    }
}

/// The light at all points, as in [`PointLights`].
#[derive(Clone, Copy, Debug, Default)]
struct PointLight<'a> {
    rows: &'a [[f32; 4]],
    end: &'a [f32],
}

impl QuadrantColumns {
    fn new(all: usize, orientation: Orientation) -> Self {
        let quadrant = orientation.on_circle([-FRAC_PI_4, FRAC_PI_4]);
        // Rounding may put its edge into the column before.
        let [from, to] = quadrant.map(|angle| (column(all, angle) - 1e-6).floor() as i64);
        let count = all.min((to - from) as usize + MOST_COLUMNS);
        Self { all, first: from.rem_euclid(all as i64) as usize, count }
    }

    /// Returns the column of the inflow at a place among them.
    fn column(self, place: usize) -> usize {
        (self.first + place) % self.all
    }

    /// Returns the place of a column of the inflow.
    fn place(self, column: usize) -> usize {
        (column + self.all - self.first) % self.all
    }
}

impl BorderLight {
    /// Reads the inflow of a grid of `depth` × `rows` points `spacing` px apart, for cones of levels, by number, which may be
    /// half cones.
    pub fn read(
        &mut self,
        inflow: &Inflow,
        orientation: Orientation,
        grid: [usize; 3],
        levels: impl ExactSizeIterator<Item = (u32, bool)>,
    ) {
        let is_same = |(held, held_orientation, size): &(Inflow, Orientation, [usize; 3])| {
            held.is(inflow) && (*held_orientation, *size) == (orientation, grid)
        };
        if self.read.as_ref().is_some_and(is_same) {
            return;
        }
        self.read = Some((inflow.clone(), orientation, grid));
        let [depth, rows, spacing] = grid;
        self.points = BorderPoints { depth, rows };
        self.columns = QuadrantColumns::new(inflow.columns(), orientation);
        let cells = self.points.cells(inflow, orientation, spacing);
        self.read_columns(inflow, &cells, spacing);
        self.levels.resize_with(levels.len(), LevelLight::default);
        for (number, (level, halves)) in levels.enumerate() {
            self.read_level(number, orientation, level, halves);
        }
    }

    /// Reads the radiance of each column of the quadrant.
    fn read_columns(&mut self, inflow: &Inflow, cells: &[usize], spacing: usize) {
        let (points, columns) = (self.points, self.columns);
        let [in_rows, at_end] = points.counts();
        self.radiance.resize(columns.count, points);
        let of_columns = self.radiance.all_mut(points).enumerate();
        of_columns.for_each(|(place, (rows, end))| {
            let column = columns.column(place);
            let mean = |point: usize| {
                let cells = &cells[point * spacing..][..spacing];
                let sum = cells.iter().fold([0.0; 3], |sum: Rgb, &cell| {
                    let radiance = inflow.strip(cell)[column];
                    std::array::from_fn(|c| sum[c] + radiance[c])
                });
                sum.map(|v| v / spacing as f32)
            };
            for (point, light) in rows.iter_mut().enumerate() {
                let [r, g, b] = mean(point);
                *light = [r, g, b, 0.0];
            }
            for row in 0..at_end {
                let light = mean(in_rows + row);
                (0..3).for_each(|c| end[c * at_end + row] = light[c]);
            }
        });
    }

    /// Finds the light of the cones of a level, which may be half cones, from that of the columns.
    fn read_level(&mut self, number: usize, orientation: Orientation, level: u32, halves: bool) {
        let Self { points, columns, radiance, levels, .. } = self;
        let (count, columns) = (cones(level), *columns);
        let held = &mut levels[number];
        let shared = halves && is_shared(level, columns.all);
        let view = |cone| border_view(level, cone, shared);
        held.slopes.clear();
        held.slopes.extend((0..count).map(|cone| view(cone).slope as f32));
        let set = |weights: &mut ColumnWeights, cone| {
            let [from, to] = orientation.on_circle(view(cone).edges);
            weights.set(columns.all, from, to);
        };
        if shared {
            let mut weights = ColumnWeights::default();
            let narrow = (0..count).map(|cone| {
                set(&mut weights, cone);
                let (first, found) = weights.of_columns();
                let weight = |i| found.get(i).copied().unwrap_or(0.0);
                NarrowView {
                    first: columns.place(first),
                    count: found.len().min(MOST_COLUMNS),
                    weights: std::array::from_fn(weight),
                }
            });
            held.cones = ConesLight::Narrow(narrow.collect());
            return;
        }
        let mut wide = match std::mem::take(&mut held.cones) {
            ConesLight::Wide(light) => light,
            ConesLight::Narrow(_) => PointLights::default(),
        };
        let points = *points;
        wide.resize(count, points);
        let cones = wide.all_mut(points).zip(&held.slopes).enumerate();
        cones.for_each_init(ColumnWeights::default, |weights, (cone, (light, slope))| {
            set(weights, cone);
            let (first, weights) = weights.of_columns();
            let first = columns.place(first);
            let (rows, end) = light;
            let side = points.side(side_of(*slope));
            rows[side.clone()].fill([0.0; 4]);
            end.fill(0.0);
            for (i, &weight) in weights.iter().enumerate() {
                let column = radiance.of((first + i) % columns.count, points);
                for (light, radiance) in
                    rows[side.clone()].iter_mut().zip(&column.rows[side.clone()])
                {
                    (0..4).for_each(|c| light[c] += weight * radiance[c]);
                }
                for (light, radiance) in end.iter_mut().zip(column.end) {
                    *light += weight * radiance;
                }
            }
        });
        held.cones = ConesLight::Wide(wide);
    }

    /// Returns a cone of a level, by its index, at the plane in a slab.
    pub fn cone(&self, level: usize, cone: usize, slab: usize) -> BorderCone<'_> {
        let LevelLight { slopes, cones } = &self.levels[level];
        let BorderPoints { depth, rows } = self.points;
        let mut columns = [(PointLight::default(), 0.0); MOST_COLUMNS];
        let count = match cones {
            ConesLight::Wide(light) => {
                columns[0] = (light.of(cone, self.points), 1.0);
                1
            }
            ConesLight::Narrow(narrow) => {
                let NarrowView { first, count, weights } = narrow[cone];
                for i in 0..count {
                    let place = (first + i) % self.columns.count;
                    columns[i] = (self.radiance.of(place, self.points), weights[i]);
                }
                count
            }
        };
        let slope = slopes[cone];
        let x = slab as f32 + 0.5;
        let side = side_of(slope);
        let edge = if side == 1 { rows as f32 } else { 0.0 };
        let per_row = if slope == 0.0 { 0.0 } else { -1.0 / slope };
        BorderCone {
            columns,
            count,
            points: self.points,
            to_end: 0.5 + slope * (depth as f32 - x),
            side,
            to_side: x + (0.5 - edge) * per_row,
            per_row,
        }
    }

    /// Returns whether the two half cones along a ray of a level see the same.
    pub fn is_shared(&self, level: usize) -> bool {
        matches!(self.levels[level].cones, ConesLight::Narrow(_))
    }

    /// Returns the numbers of rows before the first and after the last one, no more than `most`, where light of a cone
    /// enters that reaches the grid within these lengths, slabs, along its middle or so many rows beside it.
    pub fn rows_beside(
        &self,
        level: usize,
        cone: usize,
        lengths: [usize; 2],
        beside: usize,
        most: usize,
    ) -> [usize; 2] {
        let slope = self.levels[level].slopes[cone];
        let [least, rise] = lengths.map(|length| slope * length as f32);
        [(-least).max(-rise), least.max(rise)]
            .map(|rise| most.min((rise + beside as f32).max(0.0) as usize))
    }
}

/// The mean radiance in a cone at the rows of a plane, where it comes from beyond the border.
#[derive(Clone, Copy, Debug)]
pub struct BorderCone<'a> {
    /// Radiance, and weights, of a number of columns.
    columns: [(PointLight<'a>, f32); MOST_COLUMNS],
    count: usize,
    points: BorderPoints,
    /// The place on the far end of what row 0 sees, in points; that of others lies as many points on.
    to_end: f32,
    /// The other side from which light comes, the place on it of what row 0 sees, and points along it per row: 0 for a cone
    /// straight ahead, which has no other side.
    side: usize,
    to_side: f32,
    per_row: f32,
}

impl BorderCone<'_> {
    /// Returns the light at sixteen rows from `row` on, by channel.
    #[inline(always)]
    pub fn load<S: Simd>(&self, simd: S, row: isize) -> [f32x16<S>; 3] {
        let place = row as f32 + self.to_end;
        if place < 0.0 || place + (LANES - 1) as f32 > self.points.rows as f32 {
            return self.lanes(row).map(|channel| f32x16::from_slice(simd, &channel));
        }
        // All from the far end, at the same fraction between two points.
        let BetweenPoints { before, past } = self.points.between(FAR_END, place);
        let mut light = [f32x16::splat(simd, 0.0); 3];
        for (radiance, weight) in &self.columns[..self.count] {
            let weights = [weight * (1.0 - past), weight * past];
            for (c, light) in light.iter_mut().enumerate() {
                let radiance = &radiance.end[c * (self.points.rows + 2) + before..][..LANES + 1];
                let one = f32x16::from_slice(simd, &radiance[..LANES]);
                let other = f32x16::from_slice(simd, &radiance[1..]);
                *light = other.mul_add(weights[1], one.mul_add(weights[0], *light));
            }
        }
        light
    }

    /// Like [`Self::load`], row by row.
    #[inline(never)]
    fn lanes(&self, row: isize) -> [[f32; LANES]; 3] {
        let mut light = [[0.0; LANES]; 3];
        self.each(row..row + LANES as isize, |lane, rgb| {
            (0..3).for_each(|c| light[c][lane] = rgb[c])
        });
        light
    }

    /// Stores the light of cones that see it, each over an angle, at some rows of a plane. A channel has `stride` rows, the
    /// grid's first at `pad`.
    pub fn store(
        &self,
        range: Range<isize>,
        to: &mut [f32],
        [stride, pad]: [usize; 2],
        angles: &[f32],
    ) {
        let first = pad.wrapping_add_signed(range.start);
        self.each(range, |i, radiance| {
            for (rows, angle) in to.chunks_exact_mut(3 * stride).zip(angles) {
                (0..3).for_each(|c| rows[c * stride + first + i] = angle * radiance[c]);
            }
        });
    }

    /// Calls `take` with the light at some rows.
    #[inline(always)]
    fn each(&self, rows: Range<isize>, mut take: impl FnMut(usize, [f32; 4])) {
        let rows = rows.enumerate();
        match self.count {
            1 => rows.for_each(|(i, row)| take(i, self.at::<1>(row))),
            2 => rows.for_each(|(i, row)| take(i, self.at::<2>(row))),
            3 => rows.for_each(|(i, row)| take(i, self.at::<3>(row))),
            _ => rows.for_each(|(i, row)| take(i, self.at::<MOST_COLUMNS>(row))),
        }
    }

    /// Returns the light at a row, of the first `N` columns.
    #[inline(always)]
    fn at<const N: usize>(&self, row: isize) -> [f32; 4] {
        let at_end = row as f32 + self.to_end;
        let is_at_end = self.per_row == 0.0 || (at_end >= 0.0 && at_end <= self.points.rows as f32);
        let mut light = [0.0; 4];
        if is_at_end {
            let BetweenPoints { before, past } = self.points.between(FAR_END, at_end);
            for (radiance, weight) in &self.columns[..N] {
                for (c, light) in light[..3].iter_mut().enumerate() {
                    let radiance = &radiance.end[c * (self.points.rows + 2) + before..][..2];
                    *light += weight * (radiance[0] + (radiance[1] - radiance[0]) * past);
                }
            }
        } else {
            let place = self.to_side + row as f32 * self.per_row;
            let BetweenPoints { before, past } = self.points.between(self.side, place);
            for (radiance, weight) in &self.columns[..N] {
                let [one, other] = [radiance.rows[before], radiance.rows[before + 1]];
                for c in 0..4 {
                    light[c] += weight * (one[c] + (other[c] - one[c]) * past);
                }
            }
        }
        light
    }
}

/// A place between two points.
struct BetweenPoints {
    /// The first of both, and the fraction of the way to the other.
    before: usize,
    past: f32,
}

impl BorderPoints {
    /// Returns the points around a place along a side, or around the nearest on it: by their numbers among those of the rows,
    /// or among those of the far end.
    #[inline(always)]
    fn between(self, side: usize, place: f32) -> BetweenPoints {
        let (start, length) =
            if side == FAR_END { (0, self.rows) } else { (side * (self.depth + 2), self.depth) };
        let at = place.clamp(0.0, length as f32) + 0.5;
        let before = at as usize;
        BetweenPoints { before: start + before, past: at - before as f32 }
    }
}

impl Orientation {
    /// Returns the angles of the grid, radians from +x towards +y, that two in the quadrant are.
    fn on_circle(self, angles: [f64; 2]) -> [f64; 2] {
        on_grid(self.along_x, self.reversed, angles)
    }

    /// Returns the place in the grid of one in its slabs, `depth` of them.
    fn on_grid(self, depth: usize, [slab, row]: [f32; 2]) -> [f32; 2] {
        let slab = if self.reversed { depth as f32 - slab } else { slab };
        if self.along_x { [slab, row] } else { [row, slab] }
    }
}
