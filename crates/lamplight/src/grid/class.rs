//! The classes of cells.

use crate::Cells;

/// The class of a cell, as rays meet it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum CellClass {
    /// Lets all light pass.
    #[default]
    Empty,
    /// A participating medium, such as fog or glass: absorbs, tints and scatters along the way.
    Medium,
    /// Ends every ray.
    Solid,
    /// Beyond the edge of the grid.
    Outside,
}

impl CellClass {
    /// Returns the class of a cell of the grid; matter of an opacity up to `threshold` that does
    /// not tint counts as empty.
    #[inline]
    pub fn of(cells: &Cells, index: usize, threshold: f32) -> Self {
        if cells.is_solid(index) {
            Self::Solid
        } else if is_occupied(cells, index, threshold) {
            Self::Medium
        } else {
            Self::Empty
        }
    }

    /// Returns whether light can be inside the cell.
    #[inline]
    pub fn is_open(self) -> bool {
        matches!(self, Self::Empty | Self::Medium)
    }
}

/// Returns whether the cell interacts with light: its opacity is above `threshold`, or it tints.
#[inline]
pub fn is_occupied(cells: &Cells, index: usize, threshold: f32) -> bool {
    cells.opacity()[index] > threshold || cells.tint()[index] != [1.0; 3]
}
