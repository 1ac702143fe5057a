//! Clear squares: how far a ray may leap and meet nothing, by cell and by the quadrant of its
//! direction.
//!
//! For each cell and quadrant the side of the largest square of clear cells that has the cell in
//! its corner and extends that way: 0 in a cell that is not clear, else
//! `1 + min(right, below, diagonal)`, the maximal-square recurrence, exact by construction. A ray
//! leaves the square by one of its two far edges, so it lands on a cell edge and no cell is ever
//! stepped over. A square that opens with the ray reaches past what lies beside and behind it,
//! where a circle of the distance field shrinks: rays take about a third of the leaps.
//!
//! Outside the grid all is clear.

use rayon::prelude::*;

/// The longest side that is stored.
pub const LONGEST: u8 = u8::MAX;

/// Quadrant of a direction, 0 to 3, in the order of the planes.
#[inline(always)]
pub fn quadrant(direction: [f32; 2]) -> usize {
    (direction[0] < 0.0) as usize + 2 * (direction[1] < 0.0) as usize
}

/// Fills `sides`: four planes, one a quadrant, each one byte a cell in row order.
pub fn clearance(width: u32, clear: &[bool], sides: &mut Vec<u8>) {
    let w = width as usize;
    sides.resize(4 * clear.len(), 0);
    sides.par_chunks_mut(clear.len()).enumerate().for_each(|(quadrant, plane)| {
        let (left, up) = (quadrant & 1 == 1, quadrant & 2 == 2);
        let rows = clear.len() / w;
        for i in 0..rows {
            let y = if up { i } else { rows - 1 - i };
            let (before, rest) = plane.split_at_mut(y * w);
            let (row, after) = rest.split_at_mut(w);
            // The row that lies ahead, done already; none is outside the grid.
            let ahead = if up { before.rchunks(w).next() } else { after.chunks(w).next() };
            let clear = &clear[y * w..][..w];
            if left {
                scan(clear, row, ahead, 0..w);
            } else {
                scan(clear, row, ahead, (0..w).rev());
            }
        }
    });
}

/// One row, against the direction of the rays.
#[inline(always)]
fn scan(
    clear: &[bool],
    row: &mut [u8],
    ahead: Option<&[u8]>,
    columns: impl Iterator<Item = usize>,
) {
    let (mut beside, mut diagonal) = (LONGEST, LONGEST);
    for x in columns {
        let straight = ahead.map_or(LONGEST, |row| row[x]);
        let side = beside.min(straight).min(diagonal).saturating_add(1);
        row[x] = if clear[x] { side } else { 0 };
        (beside, diagonal) = (row[x], straight);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition, square by square.
    fn side(w: usize, clear: &[bool], x: usize, y: usize, q: usize) -> u8 {
        let h = clear.len() / w;
        let step = [if q & 1 == 1 { -1i64 } else { 1 }, if q & 2 == 2 { -1 } else { 1 }];
        let is_clear = |x: i64, y: i64| {
            !(0..w as i64).contains(&x)
                || !(0..h as i64).contains(&y)
                || clear[y as usize * w + x as usize]
        };
        let fits = |k: i64| {
            (0..k).all(|j| (0..k).all(|i| is_clear(x as i64 + i * step[0], y as i64 + j * step[1])))
        };
        (0..=i64::from(LONGEST)).rev().find(|&k| fits(k)).unwrap_or(0) as u8
    }

    #[test]
    fn sides_are_those_of_the_largest_clear_squares() {
        let (w, h) = (13, 7);
        let mut clear = vec![true; w * h];
        for i in [3, 17, 40, 41, 66, 90] {
            clear[i] = false;
        }
        let mut sides = Vec::new();
        clearance(w as u32, &clear, &mut sides);
        for q in 0..4 {
            for i in 0..w * h {
                assert_eq!(sides[q * w * h + i], side(w, &clear, i % w, i / w, q), "{q} {i}");
            }
        }
    }
}
