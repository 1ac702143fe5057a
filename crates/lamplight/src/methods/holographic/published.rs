//! The published cascades as a method: with walls that are lit, and bounces.
//!
//! [`Paper`] gives the fluence of open cells and nothing by direction, so a face is taken to
//! receive the fluence in front of it, and a wall sends the mean over its faces to all sides.

use super::fronts::front;
use super::paper::Paper;
use crate::settings::Bounces;
use crate::stages::bounce::{CONVERGED, Surfaces};
use crate::{Cells, Rgb};

/// The method with its buffers.
#[derive(Debug)]
pub struct Published {
    paper: Paper,
    surfaces: Surfaces,
    /// The grid with what its surfaces send on as emission.
    lit: Option<Cells>,
}

impl Default for Published {
    fn default() -> Self {
        Self { paper: Paper::published(), surfaces: Surfaces::default(), lit: None }
    }
}

impl Published {
    /// Solves one frame into `light`.
    pub fn solve(&mut self, cells: &Cells, bounces: Bounces, light: &mut Vec<Rgb>) {
        self.surfaces.collect(cells, 0.0);
        self.fluence(cells, light);
        if bounces == Bounces::Count(0) || !self.surfaces.reflect() {
            return;
        }
        let mut lit = self.lit.take().unwrap_or_else(|| cells.clone());
        lit.clone_from(cells);
        for _ in 0..bounces.limit() {
            let mut largest = 0.0f32;
            let mut sum = 0.0;
            for (i, received) in light.iter().enumerate() {
                let mut matter = cells.matter(i);
                if matter.opacity > 0.0 || matter.tint != [1.0; 3] {
                    let before = lit.emission()[i];
                    for c in 0..3 {
                        matter.emission[c] += matter.albedo[c] * received[c];
                        largest = largest.max((matter.emission[c] - before[c]).abs());
                        sum += matter.emission[c];
                    }
                    lit.set_matter(i, matter);
                }
            }
            self.fluence(&lit, light);
            let count = 3 * (self.surfaces.walls.len() + self.surfaces.fog.len()).max(1);
            if bounces == Bounces::Converged && largest <= CONVERGED * sum / count as f32 {
                break;
            }
        }
        self.lit = Some(lit);
    }

    /// Fluence of open cells; of walls, its mean in front of their faces.
    fn fluence(&mut self, cells: &Cells, light: &mut Vec<Rgb>) {
        let fluence = self.paper.solve(cells);
        light.clear();
        light.extend_from_slice(fluence);
        for i in (0..cells.len()).filter(|&i| cells.is_solid(i)) {
            light[i] = [0.0; 3];
        }
        for wall in &self.surfaces.walls {
            let cell = wall.cell as usize;
            let faces = || (0..4).filter(|&face| wall.exposed[face]);
            let width = cells.width() as usize;
            light[cell] = std::array::from_fn(|c| {
                let sum: f32 = faces().map(|face| fluence[front(cell, face, width)][c]).sum();
                sum / faces().count() as f32
            });
        }
    }
}
