//! Clear squares: how far a ray may leap at once, by cell and by the quadrant of its direction.
//!
//! For each cell and quadrant the side of the largest square of cells that has the cell in its
//! corner, extends that way and is the same throughout: all clear, or all the same matter. By the
//! maximal-square recurrence, `1 + min(beside, straight, diagonal)` where all three are like the
//! cell itself and 1 elsewhere: exact by construction. A ray leaves the square by one of its two far
//! edges, so it lands on a cell edge and no cell is ever stepped over. A square that opens with the
//! ray reaches past what lies beside and behind it, where a circle of the distance field shrinks:
//! rays take about a third of the leaps.
//!
//! Outside the grid all is clear.

use rayon::prelude::*;

/// What a cell is to light that comes along.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ground {
    /// Nothing there.
    #[default]
    Clear,
    /// Matter that light passes, such as fog.
    Matter,
    /// Light has to stop and look: a wall, or whatever else ends a leap.
    Closed,
}

/// The longest side that is stored.
pub const LONGEST: u8 = 127;
/// Added where the square holds matter: [`side`] takes it off.
pub const MATTER: u8 = 128;

/// The side of a square, px; 0 in a closed cell.
#[inline(always)]
pub fn side(square: u8) -> i32 {
    i32::from(square & LONGEST)
}

/// Quadrant of a direction, 0 to 3, in the order of the planes.
#[inline(always)]
pub fn quadrant(direction: [f32; 2]) -> usize {
    (direction[0] < 0.0) as usize + 2 * (direction[1] < 0.0) as usize
}

/// Fills `squares`: four planes, one a quadrant, each one byte a cell in row order: 0 in a closed
/// cell, else the side, plus [`MATTER`] where there is some. `alike(i, j)` says whether light passes
/// cells i and j, both of matter, in the same way.
pub fn clearance(
    width: u32,
    ground: &[Ground],
    alike: impl Fn(usize, usize) -> bool + Sync,
    squares: &mut Vec<u8>,
) {
    let w = width as usize;
    squares.resize(4 * ground.len(), 0);
    squares.par_chunks_mut(ground.len()).enumerate().for_each(|(quadrant, plane)| {
        let (left, up) = (quadrant & 1 == 1, quadrant & 2 == 2);
        let rows = ground.len() / w;
        for i in 0..rows {
            let y = if up { i } else { rows - 1 - i };
            let (before, rest) = plane.split_at_mut(y * w);
            let (row, after) = rest.split_at_mut(w);
            // The row that lies straight ahead, done already; none is outside the grid.
            let straight = if up { before.rchunks(w).next() } else { after.chunks(w).next() };
            let ahead = if up { (y * w).wrapping_sub(w) } else { y * w + w };
            let rows = Rows { ground, alike: &alike, here: y * w, ahead, straight };
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
    ground: &'a [Ground],
    alike: F,
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
            row[x] = match self.ground[self.here + x] {
                Ground::Closed => 0,
                // Squares of matter are larger than any clear one.
                Ground::Clear if beside.max(straight).max(diagonal) >= MATTER => 1,
                Ground::Clear => (smallest + 1).min(LONGEST),
                Ground::Matter => MATTER + self.matter(x, last, smallest),
            };
            (beside, diagonal, last) = (row[x], straight, Some(x));
        }
    }

    /// The side of a square of matter.
    #[inline(always)]
    fn matter(&self, x: usize, beside: Option<usize>, smallest: u8) -> u8 {
        let (Some(beside), Some(_)) = (beside, self.straight) else { return 1 };
        let neighbours = [self.here + beside, self.ahead + x, self.ahead + beside];
        let same = |j: usize| self.ground[j] == Ground::Matter && (self.alike)(self.here + x, j);
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
    fn squares_are_the_largest_of_one_kind() {
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
        let ground =
            |&m| [Ground::Clear, Ground::Matter, Ground::Matter, Ground::Closed][m as usize];
        let ground: Vec<Ground> = matter.iter().map(ground).collect();
        let mut squares = Vec::new();
        clearance(W as u32, &ground, |i, j| matter[i] == matter[j], &mut squares);
        for quadrant in 0..4 {
            for i in 0..W * H {
                let square = squares[quadrant * W * H + i];
                let largest = largest(&matter, i % W, i / W, quadrant);
                let closed = ground[i] == Ground::Closed;
                assert_eq!(square >= MATTER, ground[i] == Ground::Matter);
                assert_eq!(side(square), if closed { 0 } else { largest }, "{quadrant} {i}");
            }
        }
    }
}
