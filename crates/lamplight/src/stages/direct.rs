//! The direct light of suns, and of lamps that are lit by a shadow map, in methods that find all other light
//! themselves.
//!
//! A lamp with a cone is no matter that could be drawn ([`crate::Lamp::is_exact`]), and a sun lies beyond the grid. So
//! their light is found as in [`polar`](crate::methods::polar), and added twice: to the light of every cell at the
//! end, and to what surfaces receive in every bounce, E/2 on faces and J in media. From there the method sends it
//! on, with all that was reflected before:
//!
//! `L_o = ρ·(E_gathered + E_direct)/2`
//!
//! Cost: per lamp of range R `2πR` rays and `πR²` lookups, per sun a ray per px of the grid's width across it and a
//! lookup per cell; nothing without them. Limit: a lamp inside a wall lights nothing.

use super::faces::Faces;
use crate::Rgb;

/// The light, with buffers that are kept between frames.
#[derive(Debug, Default)]
pub struct DirectLight {
    /// Mean radiance of open cells, in walls the mean over their faces; empty without such lamps.
    pub light: Vec<Rgb>,
    /// Irradiance ÷ 2 of the faces of walls, in the order of [`super::bounce::Surfaces::walls`].
    pub faces: Vec<Faces>,
}

impl DirectLight {
    /// Removes all light.
    pub fn clear(&mut self) {
        self.light.clear();
        self.faces.clear();
    }

    /// The light of a cell.
    pub fn at(&self, cell: usize) -> Rgb {
        self.light.get(cell).copied().unwrap_or_default()
    }

    /// Irradiance ÷ 2 of the faces of a wall, by its place among all walls.
    pub fn on_faces(&self, wall: usize) -> Faces {
        self.faces.get(wall).copied().unwrap_or_default()
    }

    /// Adds it to the light of all cells.
    pub fn add_to(&self, light: &mut [Rgb]) {
        for (sum, direct) in light.iter_mut().zip(&self.light) {
            (0..3).for_each(|c| sum[c] += direct[c]);
        }
    }
}
