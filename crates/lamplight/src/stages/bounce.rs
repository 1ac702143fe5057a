//! The surfaces that send light on: faces of walls, and fog.
//!
//! A solid cell is a Lambertian surface on each of its faces that touch a cell that is not solid;
//! a face that receives B sends out `albedo·B`. A cell of fog that receives φ sends out
//! `albedo·φ` for the share of light that it stops. A method gathers what they receive, turns it
//! into what they send out, and gathers again: once a bounce.

use super::seed::is_occupied;
use crate::{Cells, Rgb};

/// Unit normals of a cell's faces: left, right, top, bottom.
pub const NORMALS: [[i32; 2]; 4] = [[-1, 0], [1, 0], [0, -1], [0, 1]];

/// Change of what surfaces receive, relative to the mean, at which bounces have converged.
pub const CONVERGED: f32 = 1e-3;

/// No surface: what [`Surfaces::slot`] holds for most cells.
const NONE: u32 = u32::MAX;

/// Light that a surface receives, or sends out, by channel on each of the four faces.
pub type Faces = [Rgb; 4];

/// A solid cell with at least one face that touches a cell that is not solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// Index of the cell.
    pub cell: u32,
    /// Whether each face is exposed, in the order of [`NORMALS`].
    pub exposed: [bool; 4],
    /// Whether it sends light on.
    pub reflects: bool,
}

/// The surfaces of a grid and the light on them.
#[derive(Debug, Default)]
pub struct Surfaces {
    width: u32,
    slots: Vec<u32>,
    /// Solid cells that can be seen.
    pub walls: Vec<Wall>,
    /// Indices of cells of fog that send light on.
    pub fog: Vec<u32>,
    /// What each wall sends out beyond its emission.
    pub wall_sent: Vec<Faces>,
    /// What each cell of fog sends out beyond its emission.
    pub fog_sent: Vec<Rgb>,
    /// Whether each face of a wall sees matter that changed since the frame before.
    pub wall_changed: Vec<[bool; 4]>,
}

impl Surfaces {
    /// Finds the surfaces of a grid; none sends anything on yet. Cells of fog of an opacity up to
    /// `threshold` count as empty.
    pub fn collect(&mut self, cells: &Cells, threshold: f32) {
        self.width = cells.width();
        self.slots.clear();
        self.slots.resize(cells.len(), NONE);
        self.walls.clear();
        self.fog.clear();
        let (w, h) = (cells.width() as i32, cells.height() as i32);
        cells.for_each_matter(|i| {
            let reflects = cells.albedo()[i] != [0.0; 3];
            if !cells.is_solid(i) {
                if reflects && is_occupied(cells, i, threshold) {
                    self.slots[i] = self.fog.len() as u32;
                    self.fog.push(i as u32);
                }
                return;
            }
            let (x, y) = (i as i32 % w, i as i32 / w);
            let exposed = NORMALS.map(|[nx, ny]| {
                let (x, y) = (x + nx, y + ny);
                let inside = (0..w).contains(&x) && (0..h).contains(&y);
                inside && !cells.is_solid((y * w + x) as usize)
            });
            if exposed.contains(&true) {
                self.slots[i] = self.walls.len() as u32;
                self.walls.push(Wall { cell: i as u32, exposed, reflects });
            }
        });
        self.wall_sent.clear();
        self.wall_sent.resize(self.walls.len(), Faces::default());
        self.fog_sent.clear();
        self.fog_sent.resize(self.fog.len(), Rgb::default());
        self.wall_changed.clear();
        self.wall_changed.resize(self.walls.len(), Default::default());
    }

    /// Takes what surfaces sent in the frame `before`, where the same cell was a surface then. Faces
    /// that send nothing on now keep nothing: no gather would ever take it from them again.
    pub fn take_over(&mut self, before: &Self) {
        if (before.width, before.slots.len()) != (self.width, self.slots.len()) {
            return;
        }
        let walls = self.walls.iter().zip(&mut self.wall_sent);
        for (wall, sent) in walls.filter(|(wall, _)| wall.reflects) {
            let slot = before.slots[wall.cell as usize] as usize;
            if before.walls.get(slot).is_some_and(|old| old.cell == wall.cell) {
                for face in (0..4).filter(|&face| wall.exposed[face]) {
                    sent[face] = before.wall_sent[slot][face];
                }
            }
        }
        for (&cell, sent) in self.fog.iter().zip(&mut self.fog_sent) {
            let slot = before.slots[cell as usize] as usize;
            if before.fog.get(slot) == Some(&cell) {
                *sent = before.fog_sent[slot];
            }
        }
    }

    /// Index of a cell in `walls` (solid cells) or `fog` (others).
    #[inline]
    pub fn slot(&self, cell: usize) -> Option<usize> {
        let slot = self.slots[cell];
        (slot != NONE).then_some(slot as usize)
    }

    /// Turns what the surfaces received into what they send out, in the order of `walls` and `fog`;
    /// what walls that do not reflect received is not read. Returns the largest change relative to
    /// the mean.
    pub fn send_on<'a>(
        &mut self,
        cells: &Cells,
        walls: impl Iterator<Item = &'a Faces>,
        fog: impl Iterator<Item = &'a Rgb>,
    ) -> f32 {
        let (mut largest, mut sum, mut count) = (0.0f32, 0.0f64, 0u32);
        let mut update = |old: &mut f32, new: f32| {
            largest = largest.max((new - *old).abs());
            sum += f64::from(new);
            count += 1;
            *old = new;
        };
        for ((wall, faces), sent) in self.walls.iter().zip(walls).zip(&mut self.wall_sent) {
            if !wall.reflects {
                continue;
            }
            let albedo = cells.albedo()[wall.cell as usize];
            for (face, sent) in
                faces.iter().zip(sent).zip(wall.exposed).filter(|f| f.1).map(|f| f.0)
            {
                (0..3).for_each(|c| update(&mut sent[c], albedo[c] * face[c]));
            }
        }
        for ((&i, light), sent) in self.fog.iter().zip(fog).zip(&mut self.fog_sent) {
            let albedo = cells.albedo()[i as usize];
            (0..3).for_each(|c| update(&mut sent[c], albedo[c] * light[c]));
        }
        let mean = (sum / f64::from(count.max(1))) as f32;
        if largest == 0.0 { 0.0 } else { largest / mean }
    }

    /// Whether anything sends light on.
    pub fn reflect(&self) -> bool {
        !self.fog.is_empty() || self.walls.iter().any(|wall| wall.reflects)
    }
}

/// Mean light over the exposed faces of a wall: what is shown of it.
pub fn mean_over_faces(wall: &Wall, faces: &Faces) -> Rgb {
    let count = wall.exposed.iter().filter(|&&e| e).count() as f32;
    std::array::from_fn(|c| {
        let lit = faces.iter().zip(wall.exposed).filter(|(_, exposed)| *exposed);
        lit.map(|(face, _)| face[c]).sum::<f32>() / count
    })
}
