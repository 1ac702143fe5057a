//! Empty-space skipping: the distance that a ray may skip at once, by cell and by the quadrant of
//! its direction.
//!
//! For each cell and quadrant: the side of the largest square of cells that has the cell in its
//! corner, extends that way and is the same throughout, all empty or all the same medium. By the
//! maximal-square recurrence, `1 + min(beside, straight, diagonal)` where all three are like the
//! cell itself and 1 elsewhere: exact by construction. A ray leaves the square by one of its two far
//! edges, so it lands on a cell edge and no cell is ever stepped over. A square that opens with the
//! ray reaches past what lies beside and behind it, where a circle of the distance field shrinks:
//! rays take about a third of the steps.
//!
//! Outside the grid all is empty.

use super::class::CellClass;
use rayon::prelude::*;

/// The longest side that is stored.
pub const LONGEST: u8 = 127;
/// Added where the square holds a medium: `side` takes it off.
pub const MATTER: u8 = 128;

/// Returns the side of a square, px; 0 in a solid cell.
#[inline(always)]
pub fn side(square: u8) -> i32 {
    i32::from(square & LONGEST)
}

/// Returns the quadrant of a direction, 0 to 3, in the order of the planes.
#[inline(always)]
pub fn quadrant(direction: [f32; 2]) -> usize {
    (direction[0] < 0.0) as usize + 2 * (direction[1] < 0.0) as usize
}

/// The squares of a grid, kept between frames.
#[derive(Debug, Default)]
pub struct EmptySpace {
    classes: Vec<CellClass>,
    /// Four planes, one per quadrant, each one byte per cell in row order.
    squares: Vec<u8>,
}

impl EmptySpace {
    /// Measures a grid of `width` columns; see [`empty_space`].
    pub fn measure(
        &mut self,
        width: u32,
        classes: impl Iterator<Item = CellClass>,
        same: impl Fn(usize, usize) -> bool + Sync,
    ) {
        self.classes.clear();
        self.classes.extend(classes);
        empty_space(width, &self.classes, same, &mut self.squares);
    }

    /// Returns all planes.
    #[inline(always)]
    pub fn squares(&self) -> &[u8] {
        &self.squares
    }

    /// Returns the squares that open in a quadrant.
    #[inline(always)]
    pub fn plane(&self, quadrant: usize) -> &[u8] {
        let n = self.classes.len();
        &self.squares[quadrant * n..][..n]
    }

    /// Returns whether a cell stops every ray.
    #[inline(always)]
    pub fn is_solid(&self, index: usize) -> bool {
        self.classes[index] == CellClass::Solid
    }
}

/// Fills `squares`: four planes, one per quadrant, each one byte per cell in row order: 0 in a solid
/// cell, else the side, plus [`MATTER`] in a medium. `same(i, j)` returns whether light passes the
/// media of cells i and j in the same way.
pub fn empty_space(
    width: u32,
    classes: &[CellClass],
    same: impl Fn(usize, usize) -> bool + Sync,
    squares: &mut Vec<u8>,
) {
    let w = width as usize;
    squares.resize(4 * classes.len(), 0);
    squares.par_chunks_mut(classes.len()).enumerate().for_each(|(quadrant, plane)| {
        let (left, up) = (quadrant & 1 == 1, quadrant & 2 == 2);
        let rows = classes.len() / w;
        for i in 0..rows {
            let y = if up { i } else { rows - 1 - i };
            let (before, rest) = plane.split_at_mut(y * w);
            let (row, after) = rest.split_at_mut(w);
            // The row that lies straight ahead, done already; none is outside the grid.
            let straight = if up { before.rchunks(w).next() } else { after.chunks(w).next() };
            let ahead = if up { (y * w).wrapping_sub(w) } else { y * w + w };
            let rows = Rows { classes, same: &same, here: y * w, ahead, straight };
            if left {
                rows.scan(row, 0..w);
            } else {
                rows.scan(row, (0..w).rev());
            }
        }
    });
}

/// A row to fill and what lies ahead of it.
struct Rows<'a, F> {
    classes: &'a [CellClass],
    same: F,
    /// Indices of the first cell of the row and of the one ahead.
    here: usize,
    ahead: usize,
    straight: Option<&'a [u8]>,
}

impl<F: Fn(usize, usize) -> bool> Rows<'_, F> {
    /// Fills the row against the direction of the rays.
    #[inline(always)]
    fn scan(&self, row: &mut [u8], columns: impl Iterator<Item = usize>) {
        // Squares of the neighbours, and the column of the one beside; none outside the grid.
        let (mut beside, mut diagonal, mut last) = (LONGEST, LONGEST, None);
        for x in columns {
            let straight = self.straight.map_or(LONGEST, |row| row[x]);
            let smallest = beside.min(straight).min(diagonal);
            row[x] = match self.classes[self.here + x] {
                CellClass::Solid | CellClass::Outside => 0,
                // Squares of media are larger than any empty one.
                CellClass::Empty if beside.max(straight).max(diagonal) >= MATTER => 1,
                CellClass::Empty => (smallest + 1).min(LONGEST),
                CellClass::Medium => MATTER + self.medium(x, last, smallest),
            };
            (beside, diagonal, last) = (row[x], straight, Some(x));
        }
    }

    /// Returns the side of a square of a medium.
    #[inline(always)]
    fn medium(&self, x: usize, beside: Option<usize>, smallest: u8) -> u8 {
        let (Some(beside), Some(_)) = (beside, self.straight) else { return 1 };
        let neighbours = [self.here + beside, self.ahead + x, self.ahead + beside];
        let same = |j: usize| self.classes[j] == CellClass::Medium && (self.same)(self.here + x, j);
        if neighbours.into_iter().all(same) { ((smallest & LONGEST) + 1).min(LONGEST) } else { 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const W: usize = 13;
    const H: usize = 7;

    /// The definition, square by square.
    fn largest(matter: &[u8], x: usize, y: usize, quadrant: usize) -> i32 {
        let step = [if quadrant & 1 == 1 { -1 } else { 1 }, if quadrant & 2 == 2 { -1 } else { 1 }];
        let at = |x: i32, y: i32| {
            let inside = (0..W as i32).contains(&x) && (0..H as i32).contains(&y);
            if inside { matter[y as usize * W + x as usize] } else { 0 }
        };
        let own = matter[y * W + x];
        let fits = |k: i32| {
            (0..k)
                .all(|j| (0..k).all(|i| at(x as i32 + i * step[0], y as i32 + j * step[1]) == own))
        };
        (1..=i32::from(LONGEST)).rev().find(|&k| fits(k)).unwrap_or(1)
    }

    #[test]
    fn squares_are_the_largest_of_one_class() {
        let mut matter = vec![0; W * H];
        for i in [3, 17, 40, 66, 90] {
            matter[i] = 1;
        }
        for i in (0..W * H).filter(|i| i % W > 8) {
            matter[i] = 2;
        }
        for i in [24, 25, 58] {
            matter[i] = 3;
        }
        let class = |&m| {
            [CellClass::Empty, CellClass::Medium, CellClass::Medium, CellClass::Solid][m as usize]
        };
        let classes: Vec<CellClass> = matter.iter().map(class).collect();
        let mut squares = Vec::new();
        empty_space(W as u32, &classes, |i, j| matter[i] == matter[j], &mut squares);
        for quadrant in 0..4 {
            for i in 0..W * H {
                let square = squares[quadrant * W * H + i];
                let largest = largest(&matter, i % W, i / W, quadrant);
                let closed = classes[i] == CellClass::Solid;
                assert_eq!(square >= MATTER, classes[i] == CellClass::Medium);
                assert_eq!(side(square), if closed { 0 } else { largest }, "{quadrant} {i}");
            }
        }
    }
}
