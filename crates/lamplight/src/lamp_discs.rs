//! Lamps drawn into the matter as glowing discs, for the methods that read only matter.
//!
//! A disc of radius R and radiance L gives about `L·R/(π·d)` of light at distance d in the open. The disc
//! that the grid can hold is a little wider than the ideal one: [`crate::source_normalization`] makes up
//! for that.

use crate::scene::coverage::{self, Window};
use crate::source_normalization::gain;
use crate::{Cells, Lamp, Matter};
use std::borrow::Cow;

impl Cells {
    /// Returns the grid with its lamps drawn as glowing discs; borrowed if it has no lamps.
    pub fn drawn(&self) -> Cow<'_, Self> {
        if self.lamps().is_empty() {
            return Cow::Borrowed(self);
        }
        let mut drawn = self.clone();
        drawn.draw_lamps();
        Cow::Owned(drawn)
    }

    /// Draws the lamps into the matter and empties their list.
    pub fn draw_lamps(&mut self) {
        let mut lamps = std::mem::take(self.lamps_mut());
        for lamp in &lamps {
            draw(lamp, self);
        }
        lamps.clear();
        // Keeps the allocation: a solver draws every frame into the same grid.
        *self.lamps_mut() = lamps;
    }
}

/// Draws a lamp into the matter: a solid disc of radius `size`, antialiased by coverage, with
/// emission `color·intensity` times a normalisation near 1 that compensates for the grid
/// ([`gain`]). A lamp that is off draws nothing.
fn draw(lamp: &Lamp, cells: &mut Cells) {
    let center = lamp.position.map(f64::from);
    let radius = f64::from(lamp.size);
    let grid = Window::grid(cells.width(), cells.height());
    let disc = Window::around(center.map(|v| v - radius), center.map(|v| v + radius));
    let seen = disc.and(&grid);
    if lamp.is_off() || seen.x.is_empty() || seen.y.is_empty() {
        return;
    }
    let strength = lamp.intensity * gain(center, radius);
    let matter =
        Matter { emission: lamp.color.map(|c| c * strength), opacity: 1.0, ..Matter::EMPTY };
    coverage::disc_shares(center, radius, &grid, |x, y, coverage| {
        let i = cells.index(x as u32, y as u32);
        cells.set_matter(i, matter.over(cells.matter(i), coverage));
    });
}
