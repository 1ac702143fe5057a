//! Lamps drawn into the matter as discs, for the methods that read only matter.
//!
//! A lamp of radiance L and radius R is a disc of emission coefficient `j = 2L/(πR)`. Far away it gives
//! the light of the ideal disc, `L·R/(π·d)` at distance d, because that of any glowing area A is
//! `j·A/(2π·d)`. It blocks nothing, and lamps that overlap add up. Cells take j by the covered fraction
//! of their area, so that neither the total `∑ j·area = 2·L·R` nor the centre of the disc depends on its
//! place between the cells.

use crate::scene::coverage::{self, Point, Window};
use crate::source_normalization::gain;
use crate::{Cells, Lamp, Matter, Rgb};
use std::borrow::Cow;
use std::f64::consts::PI;

/// The least radius at which a lamp that is not solid is drawn, px; a smaller one keeps its light. Methods
/// resolve no smaller disc, and its light would flicker as it glides from cell to cell.
pub const LEAST_RADIUS: f64 = 1.0;

impl Cells {
    /// Returns the grid with its lamps drawn as discs; borrowed if it has no lamps.
    pub fn drawn(&self) -> Cow<'_, Self> {
        if self.lamps().is_empty() {
            return Cow::Borrowed(self);
        }
        let mut drawn = self.clone();
        drawn.draw_lamps();
        Cow::Owned(drawn)
    }

    /// Draws lamps into the matter. Only those that are lit by a shadow map ([`Lamp::is_exact`]) stay lamps.
    pub fn draw_lamps(&mut self) {
        self.draw_each_lamp(Lamp::is_exact, |lamp, cells| {
            if lamp.solid {
                draw_solid(lamp, lamp.radiance(), cells);
            } else {
                draw_glow(lamp, cells);
            }
        });
    }

    /// Returns the grid with its lamps as the final picture shows them ([`show_lamps`]); borrowed if none
    /// is solid or visible.
    pub(crate) fn shown(&self) -> Cow<'_, Self> {
        if !self.lamps().iter().any(|lamp| lamp.solid || lamp.visible) {
            return Cow::Borrowed(self);
        }
        let mut shown = self.clone();
        show_lamps(&mut shown);
        Cow::Owned(shown)
    }

    /// Draws the lamps that are on, and takes all but those that `stay` off their list.
    fn draw_each_lamp(&mut self, stay: impl Fn(&Lamp) -> bool, draw: impl Fn(&Lamp, &mut Self)) {
        let mut lamps = std::mem::take(self.lamps_mut());
        lamps.retain(|lamp| {
            let stays = stay(lamp);
            if !stays && !lamp.is_off() {
                draw(lamp, self);
            }
            stays
        });
        // Keeps the allocation: a solver draws every frame into the same grid.
        *self.lamps_mut() = lamps;
    }
}

/// Draws lamps as the final picture shows them, and empties their list: the solid ones as they block light,
/// and the radiance of those that are visible, if they have any.
pub fn show_lamps(cells: &mut Cells) {
    cells.draw_each_lamp(
        |_| false,
        |lamp, cells| match (lamp.solid && !lamp.is_exact(), lamp.visible && !lamp.takes_light()) {
            (true, true) => draw_solid(lamp, lamp.radiance(), cells),
            (true, false) => draw_solid(lamp, [0.0; 3], cells),
            // The picture shows the glow of 1 px.
            (false, true) => add_glow(lamp, f64::from(lamp.size), lamp.radiance(), cells),
            (false, false) => {}
        },
    );
}

/// Draws a lamp as a glowing disc.
fn draw_glow(lamp: &Lamp, cells: &mut Cells) {
    let (radius, glow) = glow_of(lamp);
    add_glow(lamp, radius, glow, cells);
}

/// Returns the radius of the disc that a lamp is drawn as, and its emission coefficient.
pub fn glow_of(lamp: &Lamp) -> (f64, Rgb) {
    let size = f64::from(lamp.size);
    let radius = size.max(LEAST_RADIUS);
    let per_radiance = (2.0 * size / (PI * radius * radius)) as f32;
    (radius, lamp.radiance().map(|v| v * per_radiance))
}

/// Adds glow to the cells of a disc, by coverage.
fn add_glow(lamp: &Lamp, radius: f64, glow: Rgb, cells: &mut Cells) {
    let Some((center, grid)) = on_grid(lamp, radius, cells) else { return };
    let width = cells.width() as usize;
    let to = cells.glow_mut();
    coverage::disc_shares(center, radius, &grid, |x, y, share| {
        let to = &mut to[y as usize * width + x as usize];
        (0..3).for_each(|c| to[c] += share * glow[c]);
    });
}

/// Draws a lamp as a solid disc of this radiance, antialiased by coverage. A normalisation near 1
/// compensates for the grid ([`gain`]).
fn draw_solid(lamp: &Lamp, radiance: Rgb, cells: &mut Cells) {
    let radius = f64::from(lamp.size);
    let Some((center, grid)) = on_grid(lamp, radius, cells) else { return };
    let gain = gain(center, radius);
    let matter = Matter { emission: radiance.map(|v| v * gain), opacity: 1.0, ..Matter::EMPTY };
    coverage::disc_shares(center, radius, &grid, |x, y, coverage| {
        let i = cells.index(x as u32, y as u32);
        cells.set_matter(i, matter.over(cells.matter(i), coverage));
    });
}

/// Returns the centre of a lamp and the grid; `None` if the disc lies beyond its edge.
fn on_grid(lamp: &Lamp, radius: f64, cells: &Cells) -> Option<(Point, Window)> {
    let center = lamp.position.map(f64::from);
    let grid = Window::grid(cells.width(), cells.height());
    let disc = Window::around(center.map(|v| v - radius), center.map(|v| v + radius));
    let seen = disc.and(&grid);
    (!seen.x.is_empty() && !seen.y.is_empty()).then_some((center, grid))
}
