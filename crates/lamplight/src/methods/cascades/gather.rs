//! Where light is wanted: at the centres of cells and on the faces of walls.

use super::ladder::cosine;
use super::merge::{Caster, Points};
use crate::stages::bounce::{Faces, NORMALS, Surfaces};
use crate::stages::packet::LANES;
use crate::{Cells, Rgb};
use fearless_simd::{Level, dispatch, f32x16, prelude::*};
use rayon::prelude::*;

/// px before a face from which its rays start, so that they start in the open.
pub const BEFORE: f32 = 1.0 / 64.0;

/// Adds what arrives at every open cell in one cone of the nearest cascade to the mean over the
/// circle.
pub fn add_to_cells(level: Level, caster: &Caster, cells: &Cells, cone: u32, light: &mut [Rgb]) {
    let w = cells.width() as usize;
    let (ray, share) = ([caster.ray(cone)], 1.0 / caster.cascade.rays as f32);
    let in_row = caster.far.is_some_and(|far| far.cascade.lattice.spacing == 2.0);
    light.par_chunks_mut(w).enumerate().for_each(|(y, row)| {
        for (packet, row) in row.chunks_mut(LANES).enumerate() {
            let x = packet * LANES;
            if (0..row.len()).all(|l| cells.is_solid(y * w + x + l)) {
                continue;
            }
            dispatch!(level, simd => {
                let at = |l: usize| (x + l) as f32 + 0.5;
                let at = [f32x16::from_fn(simd, at), f32x16::splat(simd, y as f32 + 0.5)];
                add(caster.see(simd, Points { at, in_row, normal: None }, &ray), share, row);
            });
        }
    });
}

/// Adds what arrives at some cells in one cone, as [`add_to_cells`] does.
pub fn add_to_some(
    level: Level,
    caster: &Caster,
    cells: &Cells,
    some: &[u32],
    cone: u32,
    light: &mut [Rgb],
) {
    let (ray, share) = ([caster.ray(cone)], 1.0 / caster.cascade.rays as f32);
    light.par_chunks_mut(LANES).zip(some.par_chunks(LANES)).for_each(|(light, some)| {
        dispatch!(level, simd => {
            let place = |l: usize| some[l.min(some.len() - 1)];
            let at = [
                f32x16::from_fn(simd, |l| (place(l) % cells.width()) as f32 + 0.5),
                f32x16::from_fn(simd, |l| (place(l) / cells.width()) as f32 + 0.5),
            ];
            let points = Points { at, in_row: false, normal: None };
            add(caster.see(simd, points, &ray), share, light);
        });
    });
}

#[inline(always)]
fn add<S: Simd>(seen: [f32x16<S>; 3], weight: f32, light: &mut [Rgb]) {
    let seen = [seen[0] * weight, seen[1] * weight, seen[2] * weight];
    let seen = [seen[0].to_array(), seen[1].to_array(), seen[2].to_array()];
    for (l, light) in light.iter_mut().enumerate() {
        (0..3).for_each(|c| light[c] += seen[c][l]);
    }
}

/// The exposed faces of walls, side by side, and what they receive.
#[derive(Debug, Default)]
pub struct OnFaces {
    /// By the order of [`NORMALS`]: slot of the wall.
    slots: [Vec<u32>; 4],
    light: [Vec<Rgb>; 4],
    /// The same, wall by wall.
    pub walls: Vec<Faces>,
}

impl OnFaces {
    /// Finds the faces.
    pub fn collect(&mut self, surfaces: &Surfaces) {
        for (face, slots) in self.slots.iter_mut().enumerate() {
            slots.clear();
            let exposed = (0u32..).zip(&surfaces.walls).filter(|(_, wall)| wall.exposed[face]);
            slots.extend(exposed.map(|(slot, _)| slot));
        }
    }

    /// Forgets what they received.
    pub fn darken(&mut self) {
        for (slots, light) in self.slots.iter().zip(&mut self.light) {
            light.clear();
            light.resize(slots.len(), Rgb::default());
        }
    }

    /// Adds what arrives in one cone of the nearest cascade: `B = ½∫L cosθ dθ`, from the middle of
    /// each face.
    pub fn add(&mut self, level: Level, caster: &Caster, cells: &Cells, cone: u32) {
        let ray = [caster.ray(cone)];
        let walls = &caster.field.surfaces.walls;
        for (face, (slots, light)) in self.slots.iter().zip(&mut self.light).enumerate() {
            let weight = cosine(face, cone, caster.cascade.rays);
            if weight <= 0.0 {
                continue;
            }
            light.par_chunks_mut(LANES).zip(slots.par_chunks(LANES)).for_each(|(light, slots)| {
                let before = NORMALS[face].map(|n| 0.5 + n as f32 * (0.5 + BEFORE));
                dispatch!(level, simd => {
                    let cell = |l: usize| walls[slots[l.min(slots.len() - 1)] as usize].cell;
                    let at = [
                        f32x16::from_fn(simd, |l| (cell(l) % cells.width()) as f32 + before[0]),
                        f32x16::from_fn(simd, |l| (cell(l) / cells.width()) as f32 + before[1]),
                    ];
                    let normal = Some(NORMALS[face].map(|n| n as f32));
                    let points = Points { at, in_row: false, normal };
                    add(caster.see(simd, points, &ray), weight, light);
                });
            });
        }
    }

    /// Puts what the faces received wall by wall.
    pub fn sort(&mut self, surfaces: &Surfaces) {
        self.walls.clear();
        self.walls.resize(surfaces.walls.len(), Faces::default());
        for (face, (slots, light)) in self.slots.iter().zip(&self.light).enumerate() {
            for (&slot, &light) in slots.iter().zip(light) {
                self.walls[slot as usize][face] = light;
            }
        }
    }
}
