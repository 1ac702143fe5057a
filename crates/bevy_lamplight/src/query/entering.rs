//! Light from beyond the grid of a camera, for the coarser grid that is queried in its place.

use crate::components::WorldLamp;
use crate::placement::Placement;
use crate::surroundings::is_parted;
use bevy::math::Vec2;
use lamplight::surroundings::{LampPart, part_lamp};
use lamplight::{Cells, Inflow, Lamp, Matter};
use std::f64::consts::TAU;

/// The light that enters the grid of a camera.
#[derive(Clone, Copy)]
pub struct EnteringLight<'a> {
    pub inflow: &'a Inflow,
    pub grid: &'a Placement,
}

impl EnteringLight<'_> {
    /// Lets it enter cells of a grid that covers the camera's, with the place of its corner and the size of a cell in the
    /// world. What the cells have beyond the camera's grid is removed: its light is part of what enters.
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
        // Coarse cells see directions as coarsely.
        let columns = self.inflow.columns().div_ceil(2);
        let half = 0.5 * TAU / columns as f64;
        let size = [cells.width(), cells.height()];
        let inflow = Inflow::new(size, columns, |border, angle| {
            let at = (place(border.at) - self.grid.corner()) / self.grid.cell;
            self.inflow.mean([at.x, -at.y], angle - half, angle + half)
        })?;
        cells.set_inflow(Some(inflow))
    }

    /// Returns a lamp on another grid, as far as it shines from within the camera's.
    pub fn inside(&self, lamp: &WorldLamp, grid: &Placement, all_solid: bool) -> Vec<Lamp> {
        let whole = lamp.on_grid(grid.corner(), grid.cell, false);
        let own = lamp.on_grid(self.grid.corner(), self.grid.cell, false);
        if whole.is_exact() || !is_parted(&whole, all_solid) {
            return vec![whole];
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
