//! The gather of the nearest cascade: at the centres of cells and on the faces of walls.

use super::ladder::cosine;
use super::merge::{LIGHT, ProbeTracer, ReceiverPoints, WITH_MOMENT};
use crate::grid::packet::LANES;
use crate::simd::dispatch;
use crate::stages::bounce::Surfaces;
use crate::stages::faces::{Faces, NORMALS};
use crate::{Cells, Light, Moment, Rgb, moment};
use fearless_simd::{Level, f32x16, prelude::*};
use rayon::prelude::*;

/// Distance from a face at which its rays start, px, so that they start in the open.
pub const BEFORE: f32 = 1.0 / 64.0;

/// Adds the light that arrives at every open cell in one cone of the nearest cascade to the mean over
/// the circle, and to its first moment if it is asked for.
pub fn add_to_cells(
    level: Level,
    tracer: &ProbeTracer,
    cells: &Cells,
    cone: u32,
    light: &mut Light,
) {
    let w = cells.width() as usize;
    let (ray, weight) = ([tracer.ray(cone)], 1.0 / tracer.cascade.rays as f32);
    let in_row = tracer.farther.is_some_and(|farther| farther.cascade.lattice.spacing == 2.0);
    let rows = light.rgb.par_chunks_mut(w).zip(moment::chunks(light.moment.as_deref_mut(), w));
    rows.enumerate().for_each(|(y, (row, mut moments))| {
        for (packet, row) in row.chunks_mut(LANES).enumerate() {
            let x = packet * LANES;
            if (0..row.len()).all(|l| cells.is_solid(y * w + x + l)) {
                continue;
            }
            dispatch!(level, simd => {
                let at = |l: usize| (x + l) as f32 + 0.5;
                let at = [f32x16::from_fn(simd, at), f32x16::splat(simd, y as f32 + 0.5)];
                let points = ReceiverPoints { at, in_row, normal: None };
                match &mut moments {
                    None => add(tracer.radiance::<_, LIGHT>(simd, points, &ray), weight, row),
                    Some(moments) => {
                        let found = tracer.radiance::<_, WITH_MOMENT>(simd, points, &ray);
                        add([found[0], found[1], found[2]], weight, row);
                        add_moments(found, weight, &mut moments[x..][..row.len()]);
                    }
                }
            });
        }
    });
}

/// Adds the light that arrives at the cells of `selected` in one cone, like [`add_to_cells`].
pub fn add_to_selected(
    level: Level,
    tracer: &ProbeTracer,
    cells: &Cells,
    selected: &[u32],
    cone: u32,
    light: &mut [Rgb],
) {
    let (ray, weight) = ([tracer.ray(cone)], 1.0 / tracer.cascade.rays as f32);
    light.par_chunks_mut(LANES).zip(selected.par_chunks(LANES)).for_each(|(light, selected)| {
        dispatch!(level, simd => {
            let cell = |l: usize| selected[l.min(selected.len() - 1)];
            let at = [
                f32x16::from_fn(simd, |l| (cell(l) % cells.width()) as f32 + 0.5),
                f32x16::from_fn(simd, |l| (cell(l) / cells.width()) as f32 + 0.5),
            ];
            let points = ReceiverPoints { at, in_row: false, normal: None };
            add(tracer.radiance::<_, LIGHT>(simd, points, &ray), weight, light);
        });
    });
}

#[inline(always)]
fn add<S: Simd>(radiance: [f32x16<S>; 3], weight: f32, light: &mut [Rgb]) {
    let radiance = [radiance[0] * weight, radiance[1] * weight, radiance[2] * weight];
    let radiance = [radiance[0].to_array(), radiance[1].to_array(), radiance[2].to_array()];
    for (l, light) in light.iter_mut().enumerate() {
        (0..3).for_each(|c| light[c] += radiance[c][l]);
    }
}

#[inline(always)]
fn add_moments<S: Simd>(found: [f32x16<S>; WITH_MOMENT], weight: f32, moments: &mut [Moment]) {
    for (value, found) in found.into_iter().skip(LIGHT).enumerate() {
        let found = (found * weight).to_array();
        for (moment, found) in moments.iter_mut().zip(found) {
            moment[value / LIGHT][value % LIGHT] += found;
        }
    }
}

/// The exposed faces of walls, grouped by normal, and their irradiance.
#[derive(Debug, Default)]
pub struct FaceGather {
    /// By the order of [`NORMALS`]: slots of the walls.
    slots: [Vec<u32>; 4],
    light: [Vec<Rgb>; 4],
    /// The irradiance wall by wall.
    pub walls: Vec<Faces>,
}

impl FaceGather {
    /// Finds the exposed faces.
    pub fn collect(&mut self, surfaces: &Surfaces) {
        for (face, slots) in self.slots.iter_mut().enumerate() {
            slots.clear();
            let exposed = (0u32..).zip(&surfaces.walls).filter(|(_, wall)| wall.exposed[face]);
            slots.extend(exposed.map(|(slot, _)| slot));
        }
    }

    /// Resets the irradiance to 0.
    pub fn clear(&mut self) {
        for (slots, light) in self.slots.iter().zip(&mut self.light) {
            light.clear();
            light.resize(slots.len(), Rgb::default());
        }
    }

    /// Adds the light that arrives in one cone of the nearest cascade, `½∫L cosθ dθ` (half of the
    /// irradiance), from the middle of each face.
    pub fn add(&mut self, level: Level, tracer: &ProbeTracer, cells: &Cells, cone: u32) {
        let ray = [tracer.ray(cone)];
        let walls = &tracer.scene.surfaces.walls;
        for (face, (slots, light)) in self.slots.iter().zip(&mut self.light).enumerate() {
            let weight = cosine(face, cone, tracer.cascade.rays);
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
                    let points = ReceiverPoints { at, in_row: false, normal };
                    add(tracer.radiance::<_, LIGHT>(simd, points, &ray), weight, light);
                });
            });
        }
    }

    /// Sorts the irradiance by wall.
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
