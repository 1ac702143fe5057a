//! The published cascades as a method, with lit walls and bounces.
//!
//! [`Paper`] finds the mean radiance of open cells and nothing by direction. So the irradiance of a
//! face is taken to be the mean radiance in front of it, and a wall reflects the mean over its faces
//! to all sides.

use super::faces::cell_in_front;
use super::paper::Paper;
use crate::grid::class::is_occupied;
use crate::settings::Bounces;
use crate::stages::bounce::{Surfaces, solve_bounces};
use crate::stages::direct::DirectLight;
use crate::{Cells, Rgb};

/// The method with its buffers.
#[derive(Debug)]
pub struct Published {
    paper: Paper,
    surfaces: Surfaces,
    /// The grid with the radiance that its surfaces reflect or scatter added to their emission.
    lit: Option<Cells>,
}

impl Default for Published {
    fn default() -> Self {
        Self { paper: Paper::published(), surfaces: Surfaces::default(), lit: None }
    }
}

impl Published {
    /// Solves one frame into `light`.
    pub fn solve(
        &mut self,
        cells: &Cells,
        bounces: Bounces,
        direct: &DirectLight,
        light: &mut Vec<Rgb>,
    ) {
        self.surfaces.collect(cells, 0.0);
        self.find_light(cells, light);
        if bounces == Bounces::Count(0) || !self.surfaces.reflects_or_scatters() {
            return;
        }
        let mut lit = self.lit.take().unwrap_or_else(|| cells.clone());
        lit.clone_from(cells);
        solve_bounces(bounces, || {
            let mut largest = 0.0f32;
            let mut sum = 0.0;
            for (i, light) in light.iter().enumerate() {
                let mut matter = cells.matter(i);
                let scatters = matter.albedo != [0.0; 3] && is_occupied(cells, i, 0.0);
                if cells.is_solid(i) || scatters {
                    let (before, direct) = (lit.emission()[i], direct.at(i));
                    for c in 0..3 {
                        matter.emission[c] += matter.albedo[c] * (light[c] + direct[c]).max(0.0);
                        largest = largest.max((matter.emission[c] - before[c]).abs());
                        sum += matter.emission[c];
                    }
                    lit.set_matter(i, matter);
                }
            }
            self.find_light(&lit, light);
            let count = 3 * (self.surfaces.walls.len() + self.surfaces.media.len()).max(1);
            if largest == 0.0 { 0.0 } else { largest * count as f32 / sum }
        });
        self.lit = Some(lit);
    }

    /// Finds the mean radiance of open cells, and for walls its mean in front of their faces.
    fn find_light(&mut self, cells: &Cells, light: &mut Vec<Rgb>) {
        let mean_radiance = self.paper.solve(cells);
        light.clear();
        light.extend_from_slice(mean_radiance);
        for i in (0..cells.len()).filter(|&i| cells.is_solid(i)) {
            light[i] = [0.0; 3];
        }
        for wall in &self.surfaces.walls {
            let cell = wall.cell as usize;
            let faces = || (0..4).filter(|&face| wall.exposed[face]);
            let width = cells.width() as usize;
            let front = |face| mean_radiance[cell_in_front(cell, face, width)];
            light[cell] = std::array::from_fn(|c| {
                let sum: f32 = faces().map(|face| front(face)[c]).sum();
                sum / faces().count() as f32
            });
        }
    }
}
