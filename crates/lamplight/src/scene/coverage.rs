//! The cells that a figure covers, and the covered fractions of their areas.
//!
//! Everything is computed in double precision and visited row by row; only the part inside a
//! [`Window`] is visited, so that the cost never depends on how far a figure reaches outside.

use crate::Rgb;
use std::ops::Range;

/// A point in px.
pub(crate) type Point = [f64; 2];

/// Shares nearer than this to 0 or 1 are rounding: walls have to be exactly solid.
pub(super) const ROUNDING: f64 = 1e-7;

/// The columns and rows that are visited.
#[derive(Clone, Debug)]
pub(crate) struct Window {
    pub x: Range<i64>,
    pub y: Range<i64>,
}

impl Window {
    /// A whole grid.
    pub fn grid(width: u32, height: u32) -> Self {
        Self { x: 0..i64::from(width), y: 0..i64::from(height) }
    }

    /// The cells that touch a box.
    pub fn around(min: Point, max: Point) -> Self {
        let cells = |i: usize| min[i].floor() as i64..max[i].ceil() as i64;
        Self { x: cells(0), y: cells(1) }
    }

    /// The cells that lie in both.
    pub fn and(&self, other: &Self) -> Self {
        let both =
            |a: &Range<i64>, b: &Range<i64>| a.start.max(b.start)..a.end.min(b.end).max(a.start);
        Self { x: both(&self.x, &other.x), y: both(&self.y, &other.y) }
    }
}

/// Visits each cell whose centre lies in a disc.
pub(crate) fn disc_centres(
    center: Point,
    radius: f64,
    window: &Window,
    mut visit: impl FnMut(i64, i64),
) {
    let [cx, cy] = center;
    let window =
        window.and(&Window::around([cx - radius, cy - radius], [cx + radius, cy + radius]));
    for y in window.y {
        let dy = y as f64 + 0.5 - cy;
        let half = (radius * radius - dy * dy).max(0.0).sqrt();
        let from = ((cx - half).floor() as i64).max(window.x.start);
        let to = ((cx + half).ceil() as i64).min(window.x.end);
        for x in from..to {
            let dx = x as f64 + 0.5 - cx;
            if dx * dx + dy * dy <= radius * radius {
                visit(x, y);
            }
        }
    }
}

/// Visits each cell that a disc touches, with the exact fraction of its area that is covered.
///
/// The coverage of a box is the signed sum of four corner integrals `F(x, y)`, the disc's area
/// left of x and above y. With `A(t) = ∫₀ᵗ √(r² − s²) ds`: for a corner inside the disc
/// `F = πr²/4 + x·y + A(x) + A(y)`; outside it, F is made of whole caps.
pub(crate) fn disc_shares(
    center: Point,
    radius: f64,
    window: &Window,
    mut visit: impl FnMut(i64, i64, f32),
) {
    let [cx, cy] = center;
    let disc = Disc { radius };
    let window =
        window.and(&Window::around([cx - radius, cy - radius], [cx + radius, cy + radius]));
    for y in window.y {
        let (top, bottom) = (disc.chord(y as f64 - cy), disc.chord((y + 1) as f64 - cy));
        let near = if top.at * bottom.at <= 0.0 { 0.0 } else { top.at.abs().min(bottom.at.abs()) };
        let far = top.at.abs().max(bottom.at.abs());
        let half = (radius * radius - near * near).max(0.0).sqrt();
        let from = ((cx - half).floor() as i64).max(window.x.start);
        let to = ((cx + half).ceil() as i64).min(window.x.end);
        // Columns of the row that lie wholly inside need no integral.
        let inner = (radius * radius - far * far).max(0.0).sqrt();
        let (full_from, full_to) = ((cx - inner).ceil() as i64, (cx + inner).floor() as i64);
        let mut x = from;
        while x < to {
            if (full_from..full_to).contains(&x) {
                (x..full_to.min(to)).for_each(|x| visit(x, y, 1.0));
                x = full_to;
                continue;
            }
            let (left, right) = (disc.chord(x as f64 - cx), disc.chord((x + 1) as f64 - cx));
            let area =
                disc.corner(right, bottom) - disc.corner(left, bottom) - disc.corner(right, top)
                    + disc.corner(left, top);
            share(area).into_iter().for_each(|share| visit(x, y, share));
            x += 1;
        }
    }
}

struct Disc {
    radius: f64,
}

/// A chord of a disc along a grid line: its signed distance from the centre, clamped to the radius, and
/// its `A`.
#[derive(Clone, Copy)]
struct Chord {
    at: f64,
    integral: f64,
}

impl Disc {
    fn chord(&self, at: f64) -> Chord {
        let r = self.radius;
        let at = at.clamp(-r, r);
        let integral = 0.5 * (at * (r * r - at * at).max(0.0).sqrt() + r * r * (at / r).asin());
        Chord { at, integral }
    }

    fn corner(&self, x: Chord, y: Chord) -> f64 {
        let r2 = self.radius * self.radius;
        let quarter = std::f64::consts::FRAC_PI_4 * r2;
        if x.at * x.at + y.at * y.at < r2 {
            return quarter + x.at * y.at + x.integral + y.integral;
        }
        match (x.at >= 0.0, y.at >= 0.0) {
            (true, true) => 2.0 * (x.integral + y.integral),
            (false, true) => 2.0 * (quarter + x.integral),
            (true, false) => 2.0 * (quarter + y.integral),
            (false, false) => 0.0,
        }
    }
}

/// Visits each cell whose centre lies in a polygon (non-zero winding; of two polygons that share
/// an edge, one has the centres on it).
pub(crate) fn polygon_centres(points: &[Point], window: &Window, mut visit: impl FnMut(i64, i64)) {
    let window = window.and(&bounds(points));
    let mut crossings: Vec<(f64, i32)> = Vec::new();
    for y in window.y {
        let level = y as f64 + 0.5;
        crossings.clear();
        for (a, b) in edges(points) {
            if (a[1] <= level) != (b[1] <= level) {
                let x = a[0] + (b[0] - a[0]) * (level - a[1]) / (b[1] - a[1]);
                crossings.push((x, if a[1] < b[1] { 1 } else { -1 }));
            }
        }
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut winding = 0;
        for pair in crossings.windows(2) {
            winding += pair[0].1;
            if winding != 0 {
                let cell = |x: f64| (x - 0.5).ceil() as i64;
                let from = cell(pair[0].0).max(window.x.start);
                let to = cell(pair[1].0).min(window.x.end);
                (from..to).for_each(|x| visit(x, y));
            }
        }
    }
}

/// Visits each cell that a polygon touches, with the fraction of its area that is covered: exact for
/// polygons that do not cross themselves; where one does, the few cells at the crossing are not.
///
/// Each edge adds the signed area to its right, cell by cell (the accumulation buffer of font
/// rasterisers, Levien 2016); the running sum along a row is the coverage.
pub(crate) fn polygon_shares(
    points: &[Point],
    window: &Window,
    mut visit: impl FnMut(i64, i64, f32),
) {
    let window = window.and(&bounds(points));
    if window.x.is_empty() {
        return;
    }
    let mut row = Row { sums: vec![0.0; (window.x.end - window.x.start) as usize + 1] };
    for y in window.y {
        row.sums.fill(0.0);
        let (top, bottom) = (y as f64, (y + 1) as f64);
        for (a, b) in edges(points) {
            let (low, high) = (a[1].min(b[1]).max(top), a[1].max(b[1]).min(bottom));
            if low >= high {
                continue;
            }
            let x = |level: f64| {
                a[0] + (b[0] - a[0]) * (level - a[1]) / (b[1] - a[1]) - window.x.start as f64
            };
            row.add(x(low), x(high), if a[1] < b[1] { high - low } else { low - high });
        }
        let mut sum = 0.0;
        for (x, part) in window.x.clone().zip(&row.sums) {
            sum += part;
            share(sum.abs()).into_iter().for_each(|share| visit(x, y, share));
        }
    }
}

struct Row {
    sums: Vec<f64>,
}

impl Row {
    /// Adds a piece of an edge within the row, from column position `a` to `b`, that spans the
    /// signed height `rise`.
    fn add(&mut self, a: f64, b: f64, rise: f64) {
        let columns = (self.sums.len() - 1) as f64;
        let (low, high) = (a.min(b), a.max(b));
        if high <= 0.0 {
            self.sums[0] += rise;
            return;
        }
        if high - low < ROUNDING {
            return self.add_within(low.max(0.0), high, rise);
        }
        let rise_per_px = rise / (high - low);
        self.sums[0] += rise_per_px * (-low).max(0.0);
        let mut x = low.max(0.0);
        let end = high.min(columns);
        while x < end {
            let next = (x.floor() + 1.0).min(end);
            self.add_within(x, next, rise_per_px * (next - x));
            x = next;
        }
    }

    /// Adds a piece of an edge that stays in one column.
    fn add_within(&mut self, a: f64, b: f64, rise: f64) {
        let column = a.floor() as usize;
        if column + 1 < self.sums.len() {
            let left = ((a + b) / 2.0 - column as f64).min(1.0);
            self.sums[column] += rise * (1.0 - left);
            self.sums[column + 1] += rise * left;
        }
    }
}

/// The samples of a cell along each axis, for pictures.
const SAMPLES: u32 = 4;

/// The mean colour of a cell, weighted by alpha, and its mean alpha, of a picture given by its colour at points of the
/// cell's unit square.
///
/// The points are a grid that is sheared along both axes, so that no two of the sixteen share a column or a row, and a
/// straight edge of the picture that moves by a sixteenth of a px covers one point more.
pub(crate) fn mean_color(texel: impl Fn(Point) -> (Rgb, f32)) -> (Rgb, f32) {
    let n = f64::from(SAMPLES);
    // In double precision, where the mean of sixteen like colours is that colour.
    let (mut sum, mut alpha) = ([0.0; 3], 0.0);
    for [i, j] in (0..SAMPLES * SAMPLES).map(|k| [k % SAMPLES, k / SAMPLES].map(f64::from)) {
        let (rgb, share) = texel([i + (j + 0.5) / n, j + (i + 0.5) / n].map(|v| v / n));
        alpha += f64::from(share);
        (0..3).for_each(|c| sum[c] += f64::from(share) * f64::from(rgb[c]));
    }
    if alpha == 0.0 {
        return ([0.0; 3], 0.0);
    }
    (sum.map(|v| (v / alpha) as f32), (alpha / (n * n)) as f32)
}

/// A covered area as a fraction of a cell; `None` if nothing is covered.
fn share(area: f64) -> Option<f32> {
    match area {
        a if a < ROUNDING => None,
        a if a > 1.0 - ROUNDING => Some(1.0),
        a => Some(a as f32),
    }
}

fn edges(points: &[Point]) -> impl Iterator<Item = (Point, Point)> + '_ {
    points.iter().copied().zip(points.iter().copied().cycle().skip(1))
}

fn bounds(points: &[Point]) -> Window {
    let end = |i: usize, pick: fn(f64, f64) -> f64| points.iter().map(|p| p[i]).reduce(pick);
    match (end(0, f64::min), end(1, f64::min), end(0, f64::max), end(1, f64::max)) {
        (Some(x0), Some(y0), Some(x1), Some(y1)) => Window::around([x0, y0], [x1, y1]),
        _ => Window { x: 0..0, y: 0..0 },
    }
}
