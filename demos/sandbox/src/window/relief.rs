//! The switch of relief.

use anyhow::Result;
use lamplight::Cells;

/// Shows cells with their normals or without.
pub struct Relief {
    /// True if normals count.
    pub is_on: bool,
    /// The cells without their normals, while these do not count.
    flat: Cells,
}

impl Relief {
    pub fn new() -> Result<Self> {
        Ok(Self { is_on: true, flat: Cells::new(1, 1)? })
    }

    /// The cells as they are shown. The light alone has no relief.
    pub fn shown<'a>(&'a mut self, cells: &'a Cells, light_alone: bool) -> &'a Cells {
        if cells.normals().is_none() || self.is_on && !light_alone {
            return cells;
        }
        self.flat.clone_from(cells);
        self.flat.clear_normals();
        &self.flat
    }
}
