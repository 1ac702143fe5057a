//! Light from beyond the grid of a camera, for the coarser grid that is queried in its place.

use crate::components::WorldLamp;
use crate::placement::Placement;
use crate::surroundings::is_parted;
use bevy::math::{Rect, Vec2};
use lamplight::surroundings::{LampPart, part_lamp};
use lamplight::{Cells, Inflow, Lamp, Matter};
use std::f64::consts::TAU;

/// Directions of the light on the coarser grid.
const COLUMNS: usize = 64;

/// The light that enters the grid of a camera.
#[derive(Clone, Copy)]
pub struct EnteringLight<'a> {
    pub inflow: &'a Inflow,
    pub grid: &'a Placement,
    /// True if the camera's method draws all lamps as solid discs.
    pub all_solid: bool,
}

impl EnteringLight<'_> {
    /// Lets it enter cells of a grid that covers the camera's, with the place of its corner and the size of a cell in the
    /// world. The cells beyond the camera's grid are emptied: their light is part of what enters.
    pub fn enter(&self, cells: &mut Cells, corner: Vec2, cell: f32) -> lamplight::Result<()> {
        let place = |at: [f32; 2]| corner + cell * Vec2::new(at[0], -at[1]);
        let area = self.grid.area();
        for y in 0..cells.height() {
            for x in 0..cells.width() {
                if !area.contains(place([x as f32 + 0.5, y as f32 + 0.5])) {
                    cells.set(x, y, Matter::EMPTY);
                }
            }
        }
        let half = 0.5 * TAU / COLUMNS as f64;
        let size = [cells.width(), cells.height()];
        let inner = Rect { min: Vec2::ZERO, max: Vec2::from(self.inflow.size().map(|v| v as f32)) };
        let inflow = Inflow::new(size, COLUMNS, |border, angle| {
            let at = (place(border.at) - self.grid.corner()) / self.grid.cell;
            let way = Vec2::from_angle(angle as f32);
            let at = first_in(inner, Vec2::new(at.x, -at.y), -way);
            self.inflow.mean(at.to_array(), angle - half, angle + half)
        })?;
        cells.set_inflow(Some(inflow))
    }

    /// Returns a lamp on another grid, as far as it shines from within the camera's.
    pub fn inside(&self, lamp: &WorldLamp, grid: &Placement) -> Vec<Lamp> {
        let whole = lamp.on_grid(grid.corner(), grid.cell, false);
        if whole.is_exact() {
            return vec![whole];
        }
        let own = lamp.on_grid(self.grid.corner(), self.grid.cell, false);
        if !is_parted(&whole, self.all_solid) {
            let [width, height] = self.grid.placed.size.map(|v| v as f32);
            let near = Vec2::from(own.position).clamp(Vec2::ZERO, Vec2::new(width, height));
            let touches = near.distance(Vec2::from(own.position)) < own.size;
            return if touches { vec![whole] } else { Vec::new() };
        }
        let parts = part_lamp(&own, self.grid.placed.size);
        let inside = parts.filter(|(_, part)| *part == LampPart::Inside).map(|(part, _)| {
            let [x, y] = part.position;
            let world = self.grid.corner() + self.grid.cell * Vec2::new(x, -y);
            let at = (world - grid.corner()) / grid.cell;
            let intensity = whole.intensity * part.intensity / own.intensity;
            Lamp { position: [at.x, -at.y], intensity, ..whole.clone() }
        });
        inside.collect()
    }
}

/// The first place of a box along a way from a place outside of it, or the place nearest to it if the way leads past.
fn first_in(area: Rect, from: Vec2, way: Vec2) -> Vec2 {
    // A way along an axis is turned a little, for 0 ÷ 0 is no number.
    let way = Vec2::select(way.abs().cmplt(Vec2::splat(1e-6)), Vec2::splat(1e-6), way);
    let [one, other] = [area.min, area.max].map(|corner| (corner - from) / way);
    let enters = one.min(other).max_element().max(0.0);
    let leaves = one.max(other).min_element();
    let met = if enters <= leaves { from + enters * way } else { from };
    met.clamp(area.min, area.max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_meet_a_box_where_they_enter_it() {
        let area = Rect::new(0.0, 0.0, 10.0, 6.0);
        let met = |from: [f32; 2], way: [f32; 2]| {
            first_in(area, from.into(), Vec2::from(way).normalize()).to_array()
        };
        let near = |a: [f32; 2], b: [f32; 2]| {
            assert!(Vec2::from(a).distance(b.into()) < 1e-4, "{a:?}, not {b:?}");
        };
        near(met([14.0, 3.0], [-1.0, 0.0]), [10.0, 3.0]);
        near(met([14.0, 1.0], [-2.0, 1.0]), [10.0, 3.0]);
        near(met([12.0, -2.0], [-1.0, 2.0]), [10.0, 2.0]);
        // It is there already, and is on its edge.
        near(met([10.0, 3.0], [-1.0, 0.0]), [10.0, 3.0]);
        near(met([0.0, 0.0], [0.0, 1.0]), [0.0, 0.0]);
        // It leads past.
        near(met([14.0, 3.0], [0.0, 1.0]), [10.0, 3.0]);
        near(met([12.0, 9.0], [-1.0, 1.0]), [10.0, 6.0]);
    }
}
