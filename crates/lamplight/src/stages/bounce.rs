//! Bounces: the surfaces that reflect or scatter light, faces of walls and media, and the loop over
//! them.
//!
//! A solid cell is a Lambertian surface on each face that touches a cell that is not solid: a face of
//! irradiance E reflects `L_o = albedo·E/2` (in two dimensions `E = ∫L cosθ dθ`, and a uniform L gives
//! 2L). The code keeps irradiance in the normalised form E/2 throughout. A cell of a medium of mean
//! radiance J scatters `albedo·J` by the fraction of light that it stops. Per bounce a method gathers
//! irradiance and mean radiance, turns them into reflected and scattered radiance
//! ([`Surfaces::reflect_and_scatter`]), and gathers again ([`solve_bounces`]).

use super::direct::DirectLight;
use super::faces::{Faces, NORMALS};
use crate::grid::class::is_occupied;
use crate::grid::medium_grid::MediumGrid;
use crate::settings::Bounces;
use crate::{Cells, Rgb};

/// The change of outgoing radiance, relative to the mean, at which bounces have converged.
pub const CONVERGED: f32 = 1e-3;

/// The bounces that a frame makes.
#[derive(Clone, Copy, Debug)]
pub struct FrameBounces<'a> {
    /// As the settings have them; none if what surfaces send on is known.
    pub bounces: Bounces,
    /// The place of the grid's first cell in the world, relative to that of the frame before.
    pub moved: [i32; 2],
    pub known: Option<KnownSurfaces<'a>>,
}

impl FrameBounces<'_> {
    /// Bounces on a grid that stays where it is.
    #[cfg(test)]
    pub fn here(bounces: Bounces) -> Self {
        Self { bounces, moved: [0; 2], known: None }
    }
}

/// A frame whose surfaces send light that is known, because the grid is a part of a world that is solved.
#[derive(Clone, Copy, Debug)]
pub struct KnownSurfaces<'a> {
    pub light: &'a SurfaceLight,
    /// True if only the light that surfaces send on one bounce later is wanted; otherwise that of cells is.
    pub bounce: bool,
}

/// The radiance that surfaces of a grid send on, by cell, in any order.
#[derive(Clone, Debug, Default)]
pub struct SurfaceLight {
    /// Radiance that walls reflect.
    pub walls: Vec<(u32, Faces)>,
    /// Radiance that media scatter.
    pub media: Vec<(u32, Rgb)>,
}

impl SurfaceLight {
    /// Returns whether no surface sends any on.
    pub fn is_empty(&self) -> bool {
        self.walls.is_empty() && self.media.is_empty()
    }
}

/// The slot of a cell that is no surface.
const NONE: u32 = u32::MAX;

/// A solid cell with at least one face that touches a cell that is not solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// Index of the cell.
    pub cell: u32,
    /// True for each face that is exposed, in the order of [`NORMALS`].
    pub exposed: [bool; 4],
    /// True if it reflects light.
    pub reflects: bool,
}

/// The surfaces of a grid and the light on them.
#[derive(Debug, Default)]
pub struct Surfaces {
    width: u32,
    slots: Vec<u32>,
    /// Solid cells with an exposed face.
    pub walls: Vec<Wall>,
    /// Indices of media that scatter.
    pub media: Vec<u32>,
    /// Radiance that each wall reflects.
    pub wall_reflected: Vec<Faces>,
    /// Radiance that each medium scatters.
    pub medium_scattered: Vec<Rgb>,
    /// True for each face of a wall that sees matter that changed since the frame before.
    pub wall_changed: Vec<[bool; 4]>,
}

impl Surfaces {
    /// Finds the surfaces of a grid, without light on them. Media of an opacity up to `threshold` count
    /// as empty.
    pub fn collect(&mut self, cells: &Cells, threshold: f32) {
        self.width = cells.width();
        self.slots.clear();
        self.slots.resize(cells.len(), NONE);
        self.walls.clear();
        self.media.clear();
        let (w, h) = (cells.width() as i32, cells.height() as i32);
        cells.for_each_matter(|i| {
            let reflects = cells.albedo()[i] != [0.0; 3];
            if !cells.is_solid(i) {
                if reflects && is_occupied(cells, i, threshold) {
                    self.slots[i] = self.media.len() as u32;
                    self.media.push(i as u32);
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
        self.wall_reflected.clear();
        self.wall_reflected.resize(self.walls.len(), Faces::default());
        self.medium_scattered.clear();
        self.medium_scattered.resize(self.media.len(), Rgb::default());
        self.wall_changed.clear();
        self.wall_changed.resize(self.walls.len(), Default::default());
    }

    /// Becomes that of no grid.
    pub fn clear(&mut self) {
        self.slots.clear();
        self.walls.clear();
        self.media.clear();
        self.wall_reflected.clear();
        self.medium_scattered.clear();
        self.wall_changed.clear();
    }

    /// Returns whether these are surfaces of a grid of so many cells.
    pub fn are_of(&self, cells: &Cells) -> bool {
        self.slots.len() == cells.len()
    }

    /// Copies the reflected and scattered light of the frame `before`, when the grid was elsewhere in the world by
    /// `-moved`, for places that were surfaces then. Walls that no longer reflect get none, because no later gather would
    /// replace it.
    pub fn take_over(&mut self, before: &Self, moved: [i32; 2]) {
        let width = self.width;
        let walls = self.walls.iter().zip(&mut self.wall_reflected);
        for (wall, reflected) in walls.filter(|(wall, _)| wall.reflects) {
            let Some((cell, slot)) = before.slot_at(wall.cell, width, moved) else { continue };
            if before.walls.get(slot).is_some_and(|old| old.cell == cell) {
                for face in (0..4).filter(|&face| wall.exposed[face]) {
                    reflected[face] = before.wall_reflected[slot][face];
                }
            }
        }
        for (&cell, scattered) in self.media.iter().zip(&mut self.medium_scattered) {
            let Some((cell, slot)) = before.slot_at(cell, width, moved) else { continue };
            if before.media.get(slot) == Some(&cell) {
                *scattered = before.medium_scattered[slot];
            }
        }
    }

    /// Lets surfaces send this.
    pub fn send(&mut self, light: &SurfaceLight) {
        for &(cell, faces) in &light.walls {
            let slot = self.slot(cell as usize);
            if let Some(slot) =
                slot.filter(|&slot| self.walls.get(slot).is_some_and(|w| w.cell == cell))
            {
                self.wall_reflected[slot] = faces;
            }
        }
        for &(cell, light) in &light.media {
            let slot = self.slot(cell as usize);
            if let Some(slot) = slot.filter(|&slot| self.media.get(slot) == Some(&cell)) {
                self.medium_scattered[slot] = light;
            }
        }
    }

    /// Returns the cell of this grid where a cell of a later one lies, which is `width` cells wide and has `moved`, and
    /// its slot.
    fn slot_at(&self, cell: u32, width: u32, moved: [i32; 2]) -> Option<(u32, usize)> {
        let at = [cell % width, cell / width];
        let [x, y] = [0, 1].map(|a| u32::try_from(i64::from(at[a]) + i64::from(moved[a])).ok());
        let x = x.filter(|&x| x < self.width)?;
        let cell = u64::from(y?) * u64::from(self.width) + u64::from(x);
        let slot = *self.slots.get(usize::try_from(cell).ok()?)?;
        Some((cell as u32, slot as usize))
    }

    /// Returns the index of a cell in `walls` (solid cells) or `media` (others).
    #[inline]
    pub fn slot(&self, cell: usize) -> Option<usize> {
        let slot = self.slots[cell];
        (slot != NONE).then_some(slot as usize)
    }

    /// Turns the irradiance of walls into the radiance that they reflect, and the mean radiance in media
    /// into the radiance that they scatter, in the order of `walls` and `media`, together with `direct` light, if
    /// the sum is above 0.
    /// The irradiance of walls that do not reflect is not read. Returns the largest change relative to the mean.
    pub fn reflect_and_scatter<'a>(
        &mut self,
        cells: &Cells,
        direct: &DirectLight,
        walls: impl Iterator<Item = &'a Faces>,
        media: impl Iterator<Item = &'a Rgb>,
    ) -> f32 {
        let (mut largest, mut sum, mut count) = (0.0f32, 0.0f64, 0u32);
        let mut update = |old: &mut f32, new: f32| {
            largest = largest.max((new - *old).abs());
            sum += f64::from(new);
            count += 1;
            *old = new;
        };
        let lit = self.walls.iter().zip(walls).zip(&mut self.wall_reflected);
        for (slot, ((wall, faces), reflected)) in lit.enumerate() {
            if !wall.reflects {
                continue;
            }
            let albedo = cells.albedo()[wall.cell as usize];
            let direct = direct.on_faces(slot);
            for face in (0..4).filter(|&face| wall.exposed[face]) {
                let arrives = |c: usize| (faces[face][c] + direct[face][c]).max(0.0);
                (0..3).for_each(|c| update(&mut reflected[face][c], albedo[c] * arrives(c)));
            }
        }
        for ((&i, light), scattered) in self.media.iter().zip(media).zip(&mut self.medium_scattered)
        {
            let albedo = cells.albedo()[i as usize];
            let direct = direct.at(i as usize);
            let arrives = |c: usize| (light[c] + direct[c]).max(0.0);
            (0..3).for_each(|c| update(&mut scattered[c], albedo[c] * arrives(c)));
        }
        let mean = (sum / f64::from(count.max(1))) as f32;
        if largest == 0.0 { 0.0 } else { largest / mean }
    }

    /// Sets the source radiance of media that scatter: emitted, times `multiplier`, and scattered.
    /// Returns true if there are any; the empty space then has to be measured again.
    pub fn scatter_into(&self, cells: &Cells, multiplier: f32, grid: &mut MediumGrid) -> bool {
        for (&i, scattered) in self.media.iter().zip(&self.medium_scattered) {
            let i = i as usize;
            let emission = cells.emission()[i];
            grid.source[i] = std::array::from_fn(|c| emission[c] * multiplier + scattered[c]);
        }
        !self.media.is_empty()
    }

    /// Returns true if anything reflects or scatters.
    pub fn reflects_or_scatters(&self) -> bool {
        !self.media.is_empty() || self.walls.iter().any(|wall| wall.reflects)
    }
}

/// Runs bounces: calls `bounce` once per bounce, which gathers over the surfaces, updates their outgoing
/// light and returns its largest change relative to the mean. With [`Bounces::Converged`] it stops once
/// that change is under [`CONVERGED`]. [`Bounces::Feedback`] needs one: the light of the frame before has the others.
pub fn solve_bounces(bounces: Bounces, mut bounce: impl FnMut() -> f32) {
    let most = if bounces == Bounces::Feedback { 1 } else { bounces.limit() };
    for _ in 0..most {
        if bounce() < CONVERGED && bounces == Bounces::Converged {
            return;
        }
    }
}

/// Returns the mean light over the exposed faces of a wall, which is the light displayed for it.
pub fn mean_over_faces(wall: &Wall, faces: &Faces) -> Rgb {
    let count = wall.exposed.iter().filter(|&&e| e).count() as f32;
    std::array::from_fn(|c| {
        let lit = faces.iter().zip(wall.exposed).filter(|(_, exposed)| *exposed);
        lit.map(|(face, _)| face[c]).sum::<f32>() / count
    })
}
