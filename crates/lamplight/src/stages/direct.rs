//! The direct light of suns, and of lamps that are lit by a shadow map, in methods that find all other light
//! themselves.
//!
//! A lamp with a cone is no matter that could be drawn ([`crate::Lamp::is_exact`]), and a sun lies beyond the grid. So
//! their light is found as in [`polar`](crate::methods::polar), and added twice: to the light of every cell at the
//! end, and to what surfaces receive in every bounce, E/2 on faces and J in media. From there the method sends it
//! on, with all that was reflected before:
//!
//! `L_o = ρ·max(0, E_gathered + E_direct)/2`
//!
//! A lamp of negative intensity has negative direct light. No more is taken than there is, per channel: on faces and in
//! media in every bounce, and in the sum of all light at the end.
//!
//! Cost: per lamp of range R `2πR` rays and `πR²` lookups, per sun a ray per px of the grid's width across it and a
//! lookup per cell; nothing without them. Limit: a lamp inside a wall lights nothing.

use super::faces::Faces;
use crate::moment;
use crate::{Lamp, Moment, Rgb};

/// The light, with buffers that are kept between frames.
#[derive(Debug, Default)]
pub struct DirectLight {
    /// The lamps whose light it is, beside that of all suns.
    pub lamps: Vec<Lamp>,
    /// Mean radiance of open cells, in walls the mean over their faces; empty without such lamps.
    pub light: Vec<Rgb>,
    /// First moment of the light; empty if it was not asked for.
    pub moment: Vec<Moment>,
    /// Irradiance ÷ 2 of the faces of walls, in the order of [`super::bounce::Surfaces::walls`].
    pub faces: Vec<Faces>,
}

impl DirectLight {
    /// Removes all lamps and light.
    pub fn clear(&mut self) {
        self.lamps.clear();
        self.light.clear();
        self.moment.clear();
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

    /// Adds its first moment to that of all cells.
    pub fn add_moment_to(&self, moments: &mut [Moment]) {
        for (sum, direct) in moments.iter_mut().zip(&self.moment) {
            moment::add(sum, direct);
        }
    }
}

/// Clamps light, of which lamps have taken some, at 0, and its first moment at `longest` times the light.
pub fn clamp(light: &mut [Rgb], moments: Option<&mut [Moment]>, longest: f32) {
    light.as_flattened_mut().iter_mut().for_each(|v| *v = v.max(0.0));
    for (moment, light) in moments.into_iter().flatten().zip(light) {
        moment::limit(moment, *light, longest);
    }
}
