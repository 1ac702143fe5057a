//! The rotated grid, and rays through it from cell centre to cell centre.

use super::interval::{Interval, Transmittance};
pub use crate::grid::center_line::Piece;
use crate::grid::center_line::center_line;
use crate::grid::class::CellClass;
use crate::math::transmittance::extinction;
use crate::{Cells, Rgb};

/// The properties of a cell that rays read.
#[derive(Clone, Copy, Debug)]
struct RayCell {
    class: CellClass,
    extinction: Rgb,
    emission: Rgb,
}

/// The grid, rotated so that light arrives from +x; column by column, rows innermost.
#[derive(Debug, Default)]
pub(super) struct RotatedGrid {
    pub width: usize,
    pub height: usize,
    turn: u32,
    cells: Vec<RayCell>,
}

impl RotatedGrid {
    /// Reads the cells, rotated by `turn` quarters.
    pub fn read(&mut self, cells: &Cells, turn: u32) {
        let (w, h) = (cells.width() as usize, cells.height() as usize);
        self.turn = turn;
        (self.width, self.height) = if turn.is_multiple_of(2) { (w, h) } else { (h, w) };
        self.cells.clear();
        for x in 0..self.width {
            for y in 0..self.height {
                self.cells.push(ray_cell(cells, self.cell(x, y)));
            }
        }
    }

    /// Returns the index in the original grid of the cell at (x, y): +x here is the direction `turn`
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

    fn at(&self, x: usize, y: usize, [dx, dy]: [i32; 2]) -> Option<RayCell> {
        let (x, y) = (x.checked_add_signed(dx as isize)?, y.checked_add_signed(dy as isize)?);
        (x < self.width && y < self.height).then(|| self.cells[x * self.height + y])
    }

    /// Returns the interval of a ray from the centre of (x, y).
    pub fn trace<T: Transmittance>(&self, x: usize, y: usize, pieces: &[Piece]) -> Interval<T> {
        let mut met = Interval::<T>::EMPTY;
        let solid = |emission| Interval { light: emission, transmittance: T::NONE };
        for piece in pieces {
            match *piece {
                Piece::Cross { at, length } => match self.at(x, y, at) {
                    // A straight ray that has left the grid does not come back.
                    None => return met,
                    Some(RayCell { class: CellClass::Solid, emission, .. }) => {
                        return met.then(solid(emission));
                    }
                    Some(RayCell { class: CellClass::Medium, extinction, emission }) => {
                        let t = extinction.map(|extinction| (-extinction * length).exp());
                        let absorbed =
                            extinction.map(|extinction| -(-extinction * length).exp_m1());
                        let light = std::array::from_fn(|c| absorbed[c] * emission[c]);
                        met = met.then(Interval { light, transmittance: T::from_rgb(t) });
                    }
                    Some(_) => {}
                },
                Piece::Corner(beside) => {
                    if let [Some(a), Some(b)] = beside.map(|at| self.at(x, y, at))
                        && [a.class, b.class] == [CellClass::Solid; 2]
                    {
                        let mean = |c| 0.5 * a.emission[c] + 0.5 * b.emission[c];
                        return met.then(solid(std::array::from_fn(mean)));
                    }
                }
            }
        }
        met
    }
}

fn ray_cell(cells: &Cells, i: usize) -> RayCell {
    RayCell {
        class: CellClass::of(cells, i, 0.0),
        extinction: extinction(cells.opacity()[i], cells.tint()[i]),
        emission: cells.emission()[i],
    }
}

/// Returns the line from a cell's center to the center `offset` cells on, the same from every cell.
pub(super) fn pieces(offset: [i32; 2]) -> Vec<Piece> {
    center_line(offset).collect()
}
