//! Light that enters a grid from the world around it.
//!
//! A [`Sky`](crate::Sky) looks the same from everywhere. The world around a grid that is cut out of it does not: a
//! lamp beyond the border is seen in another direction from every cell. So the radiance that enters is kept by place
//! and direction: for each cell along the border a strip of columns over the circle, as in a
//! [`Panorama`]. A ray that leaves the grid reads it where it crosses the border.

use crate::check::BRIGHT;
use crate::limits::MAX_SIDE;
use crate::panorama::{StripPart, column, mean_of_columns, radiance_of_columns, strip_parts};
use crate::{Error, Panorama, Result, Rgb};
use rayon::prelude::*;
use std::fmt::{self, Display, Formatter};
use std::ops::Range;
use std::sync::Arc;

/// Radiance that enters a grid, by place on its border and by direction.
///
/// The border cells go around: along the top from the left, along the right from the top, along the bottom from the
/// left, along the left from the top. Columns are angles, in the order of those of [`Panorama`]. Radiance is linear
/// between the middles of the cells of a side, and of columns.
///
/// More columns are sharper shadows of what lies beyond the border, and take memory: 12 bytes for each, times the
/// border cells. A clone shares them.
#[derive(Clone, Debug)]
pub struct Inflow {
    size: [u32; 2],
    columns: usize,
    radiance: Arc<Vec<Rgb>>,
}

/// A rectangle of cells of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GridWindow {
    /// Column and row of its first cell.
    pub first: [u32; 2],
    /// Columns and rows.
    pub size: [u32; 2],
}

impl GridWindow {
    /// Rejects a window that does not lie in a grid.
    pub(crate) fn check(self, grid: [u32; 2]) -> Result<()> {
        let Self { first, size } = self;
        let fits = |a: usize| {
            size[a] > 0 && u64::from(first[a]) + u64::from(size[a]) <= u64::from(grid[a])
        };
        if fits(0) && fits(1) {
            return Ok(());
        }
        let [w, h] = grid;
        Err(Error::value("window", self, format!("a part of a grid of {w}×{h} cells")))
    }

    /// Returns what two windows of the same world have in common.
    pub(crate) fn common(self, other: Self) -> Option<Self> {
        let end = |window: Self, a: usize| window.first[a] + window.size[a];
        let first = [0, 1].map(|a| self.first[a].max(other.first[a]));
        let size = [0, 1].map(|a| end(self, a).min(end(other, a)).saturating_sub(first[a]));
        size.iter().all(|&side| side > 0).then_some(Self { first, size })
    }

    /// Returns the same window, relative to one around it.
    pub(crate) fn within(self, around: Self) -> Self {
        Self { first: [0, 1].map(|a| self.first[a] - around.first[a]), ..self }
    }

    /// Returns the index in another window of the same world of the cell with this index in its own; none if it lies
    /// elsewhere.
    pub(crate) fn index_in(self, other: Self, cell: u32) -> Option<u32> {
        let at = [cell % self.size[0], cell / self.size[0]];
        let [x, y] = [0, 1].map(|a| (self.first[a] + at[a]).wrapping_sub(other.first[a]));
        (x < other.size[0] && y < other.size[1]).then(|| y * other.size[0] + x)
    }

    /// The indices of its cells in a grid of so many columns, row by row.
    pub(crate) fn rows(self, columns: u32) -> Vec<Range<usize>> {
        let Self { first: [x, y], size: [width, height] } = self;
        let start = |row: u32| (y + row) as usize * columns as usize + x as usize;
        (0..height).map(|row| start(row)..start(row) + width as usize).collect()
    }
}

impl Display for GridWindow {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}×{} cells from {:?} on", self.size[0], self.size[1], self.first)
    }
}

/// A place on the border of a grid, px.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BorderPlace {
    /// Columns of the grid from the left, rows from the top.
    pub at: [f32; 2],
    /// The unit vector out of the grid.
    pub outward: [f32; 2],
}

impl BorderPlace {
    /// The side that it lies on: top, right, bottom, left.
    pub(crate) fn side(self) -> usize {
        match self.outward {
            [_, y] if y < 0.0 => 0,
            [x, _] if x > 0.0 => 1,
            [_, y] if y > 0.0 => 2,
            _ => 3,
        }
    }
}

impl Inflow {
    /// Creates the inflow of a grid from the radiance of each border cell in each of `columns` directions.
    ///
    /// # Errors
    /// Fails if the grid has no valid size, there is no column or there are more than [`Panorama::MAX_COLUMNS`], or
    /// a radiance is not from 0 to 1e12.
    pub fn new(
        size: [u32; 2],
        columns: usize,
        radiance: impl Fn(BorderPlace, f64) -> Rgb + Sync,
    ) -> Result<Self> {
        Self::up_to(BRIGHT, size, columns, |place, strip| {
            for (column, rgb) in strip.iter_mut().enumerate() {
                *rgb = radiance(place, Panorama::angle(columns, column));
            }
        })
    }

    /// Like [`Self::new`], for all columns of a border cell at once, and of any radiance: sums over the matter of a grid and
    /// bright lamps may be brighter than what is given.
    pub(crate) fn of_strips(
        size: [u32; 2],
        columns: usize,
        fill: impl Fn(BorderPlace, &mut [Rgb]) + Sync,
    ) -> Result<Self> {
        Self::up_to(f32::MAX, size, columns, fill)
    }

    fn up_to(
        brightest: f32,
        size: [u32; 2],
        columns: usize,
        fill: impl Fn(BorderPlace, &mut [Rgb]) + Sync,
    ) -> Result<Self> {
        if !size.iter().all(|side| (1..=MAX_SIDE).contains(side)) {
            let [width, height] = size.map(u64::from);
            return Err(Error::Size { width, height });
        }
        check_columns(columns)?;
        let mut radiance = vec![[0.0; 3]; border_cells(size) * columns];
        let strips = radiance.par_chunks_mut(columns).enumerate();
        // Each is checked while it is in the cache.
        let invalid = strips.find_map_first(|(cell, strip)| {
            fill(border_place(size, cell), strip);
            let values = strip.as_flattened();
            let valid = |v: &f32| (0.0..=brightest).contains(v);
            // Without a way out, several at a time.
            let all = values.iter().fold(true, |all, v| all & valid(v));
            if all { None } else { values.iter().copied().find(|v| !valid(v)) }
        });
        match invalid {
            Some(v) => {
                Err(Error::value("inflow", v, format!("a radiance from 0 to {brightest:e}")))
            }
            None => Ok(Self { size, columns, radiance: radiance.into() }),
        }
    }

    /// Creates the inflow of a grid from strips that are `spacing` px apart along each side (top, right, bottom, left), the
    /// first half as far from its beginning. Between them radiance is linear.
    pub(crate) fn of_sparse_strips(
        size: [u32; 2],
        columns: usize,
        spacing: u32,
        strips: &[Vec<Vec<Rgb>>; 4],
    ) -> Result<Self> {
        Self::of_strips(size, columns, |place, strip| {
            let side = place.side();
            let strips = &strips[side];
            let last = (strips.len() - 1) as f32;
            let at = (place.at[side % 2] / spacing as f32 - 0.5).clamp(0.0, last);
            let before = at as usize;
            let (one, other) = (&strips[before], &strips[(before + 1).min(strips.len() - 1)]);
            let past = at - before as f32;
            for (rgb, (one, other)) in strip.iter_mut().zip(one.iter().zip(other)) {
                *rgb = std::array::from_fn(|c| one[c] + (other[c] - one[c]) * past);
            }
        })
    }

    /// Rejects the inflow of a grid of another size.
    ///
    /// # Errors
    /// Fails if it is one.
    pub fn check(&self, grid: [u32; 2]) -> Result<()> {
        if self.size == grid {
            return Ok(());
        }
        let [found, expected] = [self.size, grid].map(|[w, h]| format!("that of {w}×{h} cells"));
        Err(Error::value("inflow", found, expected))
    }

    /// Columns and rows of the grid.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The number of directions.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The columns of a border cell, by its number on the way around.
    ///
    /// # Panics
    /// If there is no such cell.
    pub fn strip(&self, cell: usize) -> &[Rgb] {
        &self.radiance[cell * self.columns..][..self.columns]
    }

    /// The radiance along a ray that leaves the grid at a place on its border, in this direction.
    pub fn radiance(&self, place: [f32; 2], [x, y]: [f32; 2]) -> Rgb {
        let at = column(self.columns, f64::from(y.atan2(x)));
        self.between(place, |columns| radiance_of_columns(columns, at))
    }

    /// The mean radiance that enters at a place on the border between two angles, radians from +x towards +y, the
    /// first below the second.
    pub fn mean(&self, place: [f32; 2], from: f64, to: f64) -> Rgb {
        let [from, to] = [from, to].map(|angle| column(self.columns, angle));
        self.between(place, |columns| mean_of_columns(columns, from, to))
    }

    /// The number of the border cell whose outer edge is nearest to a place on the border.
    /// One beyond counts as on the border: a lattice may end there.
    pub(crate) fn nearest_cell(&self, [x, y]: [f32; 2]) -> usize {
        let [w, h] = self.size.map(|side| side as f32);
        let Side { first, count, along } = self.side([x.min(w), y.min(h)]);
        first + (along.max(0.0) as usize).min(count - 1)
    }

    /// The side that is nearest to a place on the border, which may be rounded.
    fn side(&self, [x, y]: [f32; 2]) -> Side {
        let [w, h] = self.size.map(|side| side as f32);
        let distances = [y.abs(), (w - x).abs(), (h - y).abs(), x.abs()];
        let side = (1..4).fold(0, |best, s| if distances[s] < distances[best] { s } else { best });
        let [columns, rows] = self.size.map(|side| side as usize);
        let first = [0, columns, columns + rows, 2 * columns + rows][side];
        let (along, count) = if side % 2 == 0 { (x, columns) } else { (y, rows) };
        Side { first, count, along }
    }

    /// Interpolates between two border cells.
    fn between(&self, place: [f32; 2], of: impl Fn(&[Rgb]) -> [f64; 3]) -> Rgb {
        let Side { first, count, along } = self.side(place);
        let at = (along - 0.5).clamp(0.0, (count - 1) as f32);
        let before = (at as usize).min(count.saturating_sub(2));
        let past = f64::from(at - before as f32);
        let one = of(self.strip(first + before));
        if past == 0.0 {
            return one.map(|v| v as f32);
        }
        let other = of(self.strip(first + before + 1));
        std::array::from_fn(|c| (one[c] + (other[c] - one[c]) * past) as f32)
    }
}

/// A side of the grid, with a place on it.
struct Side {
    /// The number of its first border cell, and the count of them.
    first: usize,
    count: usize,
    /// The place, px from the side's beginning.
    along: f32,
}

/// The weights of neighbouring columns in their mean between two angles, the same for all border cells.
#[derive(Debug, Default)]
pub struct ColumnWeights {
    first: usize,
    weights: Vec<f32>,
}

impl ColumnWeights {
    /// Becomes that of strips of `count` columns between two angles, radians, the first below the second.
    pub fn set(&mut self, count: usize, from: f64, to: f64) {
        let [from, to] = [from, to].map(|angle| column(count, angle));
        self.first = (from.floor() as i64).rem_euclid(count as i64) as usize;
        self.weights.clear();
        self.weights.push(0.0);
        for (i, StripPart { length, past, .. }) in strip_parts(from, to).enumerate() {
            let share = length / (to - from);
            self.weights[i] += (share * (1.0 - past)) as f32;
            self.weights.push((share * past) as f32);
        }
    }

    /// The first column, and the weights of it and of those that follow.
    pub fn of_columns(&self) -> (usize, &[f32]) {
        (self.first, &self.weights)
    }
}

impl Inflow {
    /// Returns whether both share their values.
    pub(crate) fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.radiance, &other.radiance)
    }
}

impl PartialEq for Inflow {
    fn eq(&self, other: &Self) -> bool {
        let same = self.is(other) || self.radiance == other.radiance;
        same && (self.size, self.columns) == (other.size, other.columns)
    }
}

/// Rejects a number of directions of which there is no inflow.
pub(crate) fn check_columns(columns: usize) -> Result<()> {
    if (1..=Panorama::MAX_COLUMNS).contains(&columns) {
        return Ok(());
    }
    Err(Error::value("inflow.columns", columns, "1 to 8192"))
}

/// The number of cells along a border; those in the corners count for both sides.
pub fn border_cells([width, height]: [u32; 2]) -> usize {
    2 * (width as usize + height as usize)
}

/// Returns the border place on a side (top, right, bottom, left), px from its beginning.
pub(crate) fn place_on_side(size: [u32; 2], side: usize, along: f32) -> BorderPlace {
    let [w, h] = size.map(|v| v as f32);
    let (at, outward) = [
        ([along, 0.0], [0.0, -1.0]),
        ([w, along], [1.0, 0.0]),
        ([along, h], [0.0, 1.0]),
        ([0.0, along], [-1.0, 0.0]),
    ][side];
    BorderPlace { at, outward }
}

/// Returns the middle of a border cell's outer edge.
fn border_place([width, height]: [u32; 2], cell: usize) -> BorderPlace {
    let [columns, rows] = [width as usize, height as usize];
    let firsts = [0, columns, columns + rows, 2 * columns + rows];
    let side = (1..4).fold(0, |side, s| if cell >= firsts[s] { s } else { side });
    place_on_side([width, height], side, (cell - firsts[side]) as f32 + 0.5)
}

/// Returns where a straight line leaves a grid for good, going in a direction from any point; the nearest place of
/// the grid if it passes beside it.
pub fn exit([width, height]: [f32; 2], from: [f32; 2], direction: [f32; 2]) -> [f32; 2] {
    let size = [width, height];
    let leaves = |a: usize| match direction[a] {
        0.0 => f32::INFINITY,
        d if d > 0.0 => (size[a] - from[a]) / d,
        d => -from[a] / d,
    };
    let length = leaves(0).min(leaves(1));
    std::array::from_fn(|a| (from[a] + direction[a] * length).clamp(0.0, size[a]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::TAU;

    const SIZE: [u32; 2] = [5, 3];

    #[test]
    fn inflow_is_read_where_and_whence_it_was_written() {
        let value = |at: [f32; 2], angle: f64| [at[0] + 1.0, at[1], angle.cos() as f32 + 1.0];
        let inflow = Inflow::new(SIZE, 512, |place, angle| value(place.at, angle)).unwrap();
        let mut weights = ColumnWeights::default();
        for step in 0..100 {
            let angle = TAU * step as f32 / 100.0;
            for place in [[0.5, 0.0], [2.2, 0.0], [5.0, 1.7], [3.3, 3.0], [0.0, 2.5]] {
                let found = inflow.radiance(place, [angle.cos(), angle.sin()]);
                let expected = value(place, angle.into());
                let error = (0..3).map(|c| (found[c] - expected[c]).abs()).fold(0.0, f32::max);
                assert!(error < 1e-3, "{place:?}, {angle}: {found:?}, not {expected:?}");
                let [from, to] = [angle - 0.01, angle + 0.01].map(f64::from);
                let mean = inflow.mean(place, from, to);
                assert!((0..3).all(|c| (mean[c] - found[c]).abs() < 1e-3), "{mean:?}, {found:?}");
                // Of a wide angle, and of a cell's own strip.
                let [from, to] = [angle - 0.4, angle + 0.9].map(f64::from);
                let cell = inflow.nearest_cell(place);
                let middle = border_place(SIZE, cell).at;
                weights.set(512, from, to);
                let (first, weights) = weights.of_columns();
                let fast = weights.iter().enumerate().fold([0.0; 3], |sum: Rgb, (i, weight)| {
                    let column = inflow.strip(cell)[(first + i) % 512];
                    std::array::from_fn(|c| sum[c] + weight * column[c])
                });
                let exact = inflow.mean(middle, from, to);
                assert!((0..3).all(|c| (fast[c] - exact[c]).abs() < 1e-5), "{fast:?}, {exact:?}");
            }
        }
    }

    #[test]
    fn wrong_inflow_is_refused() {
        assert!(Inflow::new([0, 3], 8, |_, _| [0.0; 3]).is_err());
        assert!(Inflow::new(SIZE, 0, |_, _| [0.0; 3]).is_err());
        assert!(Inflow::new(SIZE, 8, |_, _| [f32::NAN, 0.0, 0.0]).is_err());
    }

    #[test]
    fn lines_leave_through_the_border() {
        let size = [5.0, 3.0];
        for (from, direction, place) in [
            ([2.0, 1.0], [1.0, 0.0], [5.0, 1.0]),
            ([2.0, 1.0], [-0.6, 0.8], [0.5, 3.0]),
            // Beyond the border already.
            ([7.0, 2.0], [1.0, 0.5], [5.0, 1.0]),
            ([2.0, -4.0], [0.0, -1.0], [2.0, 0.0]),
        ] {
            let found = exit(size, from, direction);
            assert!((0..2).all(|a| (found[a] - place[a]).abs() < 1e-5), "{from:?}: {found:?}");
        }
    }
}
