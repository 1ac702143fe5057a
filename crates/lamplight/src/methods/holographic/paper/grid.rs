//! The grid turned by quarters, and rays through it from cell centre to cell centre.

use super::interval::{Interval, Through};
use crate::{Cells, Rgb};

/// What a cell is to a ray.
#[derive(Clone, Copy, Debug)]
enum Site {
    Clear,
    /// With the logarithm of the transmittance of one px.
    Medium {
        emission: Rgb,
        log: Rgb,
    },
    Solid {
        emission: Rgb,
    },
}

/// The grid turned so that light arrives from +x; column by column, rows innermost.
#[derive(Debug, Default)]
pub(super) struct Grid {
    pub width: usize,
    pub height: usize,
    turn: u32,
    sites: Vec<Site>,
}

impl Grid {
    /// Reads the cells, turned by `turn` quarters.
    pub fn read(&mut self, cells: &Cells, turn: u32) {
        let (w, h) = (cells.width() as usize, cells.height() as usize);
        self.turn = turn;
        (self.width, self.height) = if turn.is_multiple_of(2) { (w, h) } else { (h, w) };
        self.sites.clear();
        for x in 0..self.width {
            for y in 0..self.height {
                self.sites.push(site(cells, self.cell(x, y)));
            }
        }
    }

    /// Index in the grid as it was of the cell at (x, y): +x here is the direction of `turn`
    /// quarters from +x towards +y there.
    pub fn cell(&self, x: usize, y: usize) -> usize {
        let (w, h) = (self.width, self.height);
        match self.turn {
            0 => y * w + x,
            1 => x * h + (h - 1 - y),
            2 => (h - 1 - y) * w + (w - 1 - x),
            _ => (w - 1 - x) * h + y,
        }
    }

    fn site(&self, x: usize, y: usize, [dx, dy]: [i32; 2]) -> Option<Site> {
        let (x, y) = (x.checked_add_signed(dx as isize)?, y.checked_add_signed(dy as isize)?);
        (x < self.width && y < self.height).then(|| self.sites[x * self.height + y])
    }

    /// The interval that a ray from the centre of (x, y) meets.
    pub fn trace<T: Through>(&self, x: usize, y: usize, pieces: &[Piece]) -> Interval<T> {
        let mut met = Interval::<T>::EMPTY;
        let wall = |emission| Interval { light: emission, through: T::NONE };
        for piece in pieces {
            match *piece {
                Piece::Cross { at, length } => match self.site(x, y, at) {
                    // A straight ray that has left the grid does not come back.
                    None => return met,
                    Some(Site::Clear) => {}
                    Some(Site::Medium { emission, log }) => {
                        let through = log.map(|log| (log * length).exp());
                        let light = std::array::from_fn(|c| (1.0 - through[c]) * emission[c]);
                        met = met.then(Interval { light, through: T::from_rgb(through) });
                    }
                    Some(Site::Solid { emission }) => return met.then(wall(emission)),
                },
                Piece::Corner(beside) => {
                    if let [Some(Site::Solid { emission: a }), Some(Site::Solid { emission: b })] =
                        beside.map(|at| self.site(x, y, at))
                    {
                        return met.then(wall(std::array::from_fn(|c| 0.5 * a[c] + 0.5 * b[c])));
                    }
                }
            }
        }
        met
    }
}

fn site(cells: &Cells, i: usize) -> Site {
    let (opacity, tint, emission) = (cells.opacity()[i], cells.tint()[i], cells.emission()[i]);
    if cells.is_solid(i) {
        Site::Solid { emission }
    } else if opacity == 0.0 && tint == [1.0; 3] {
        Site::Clear
    } else {
        Site::Medium { emission, log: tint.map(|t| ((1.0 - opacity) * t).ln()) }
    }
}

/// What a ray meets on its way, at offsets from the cell it starts in.
#[derive(Clone, Copy, Debug)]
pub enum Piece {
    /// So many px through a cell.
    Cross {
        /// The cell, by columns and rows.
        at: [i32; 2],
        /// px.
        length: f32,
    },
    /// The corner between two cells that it does not enter: that of the next column, that of the next
    /// row.
    Corner([[i32; 2]; 2]),
}

/// The way from a cell's centre to the centre `(dx, dy)` cells on, dx ≥ 1: the same from every
/// cell. Edges are put in order by whole numbers, so that corners are met exactly.
pub(super) fn pieces([dx, dy]: [i32; 2]) -> Vec<Piece> {
    let (steep, down) = (dy.abs(), dy.signum());
    let px = f64::from(dx).hypot(f64::from(dy));
    let mut pieces = Vec::new();
    // Columns and rows crossed; the next edges are at (2·crossed + 1)/(2·all) of the way.
    let (mut columns, mut rows) = (0, 0);
    let mut share = 0.0;
    while columns < dx || rows < steep {
        let order = ((2 * columns + 1) * steep).cmp(&((2 * rows + 1) * dx));
        let (along, across) = (order.is_le(), order.is_ge());
        let next = if along {
            f64::from(2 * columns + 1) / f64::from(2 * dx)
        } else {
            f64::from(2 * rows + 1) / f64::from(2 * steep)
        };
        let at = [columns, down * rows];
        pieces.push(Piece::Cross { at, length: ((next - share) * px) as f32 });
        if along && across {
            pieces.push(Piece::Corner([[columns + 1, at[1]], [columns, at[1] + down]]));
        }
        columns += i32::from(along);
        rows += i32::from(across);
        share = next;
    }
    pieces.push(Piece::Cross { at: [dx, dy], length: ((1.0 - share) * px) as f32 });
    pieces
}
