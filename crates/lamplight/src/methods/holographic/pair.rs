//! Two opposite quadrants: the light that arrives along one axis of the grid.

use super::cones::Cones;
use super::fronts::Fronts;
use super::hop::{Hop, TILE};
use super::interval::LANES;
use super::pyramid::{Pyramid, planes};
use super::slabs::{Axis, Slabs};
use crate::settings::Holographic;
use crate::stages::bounce::Surfaces;
use crate::{Cells, Rgb};
use fearless_simd::{Level, dispatch, f32x16, prelude::*};

/// The buffers of a pair of quadrants.
#[derive(Debug)]
pub struct Pair {
    axis: Axis,
    slabs: Slabs,
    pyramid: Pyramid,
    cones: Cones,
    hop: Hop,
    /// ∫ L dω over both quadrants, by channel, slab by slab.
    fluence: [Vec<f32>; 3],
    /// Rows from one slab to the next in `fluence`.
    stride: usize,
    /// ∫ L cosθ dω onto faces by normal, for every open cell in front of one.
    onto: Vec<[Rgb; 4]>,
}

/// What to light.
#[derive(Clone, Copy)]
pub struct Scene<'a> {
    pub cells: &'a Cells,
    /// Surfaces that send light on; none for direct light.
    pub surfaces: Option<&'a Surfaces>,
    pub fronts: &'a Fronts,
    /// Whether every pixel is lit, or surfaces only.
    pub all: bool,
    pub settings: &'a Holographic,
}

impl Pair {
    /// The quadrants along an axis.
    pub fn new(axis: Axis) -> Self {
        Self {
            axis,
            slabs: Slabs::default(),
            pyramid: Pyramid::default(),
            cones: Cones::default(),
            hop: Hop::default(),
            fluence: Default::default(),
            stride: 0,
            onto: Vec::new(),
        }
    }

    /// Lights the grid from both sides.
    pub fn solve(&mut self, level: Level, scene: Scene) {
        let settings = scene.settings;
        self.slabs.read(scene.cells, self.axis, scene.surfaces);
        self.pyramid.prepare(&self.slabs, settings.hop, settings.beams);
        let Slabs { depth, rows, .. } = self.slabs;
        self.cones.prepare(depth, rows, &self.pyramid, Hop::reach(settings.hop));
        self.hop.prepare(settings.hop, settings.rays);
        self.stride = rows.next_multiple_of(TILE);
        for fluence in &mut self.fluence {
            fluence.clear();
            fluence.resize(depth * self.stride, 0.0);
        }
        self.onto.clear();
        self.onto.resize(scene.fronts.len(), [[0.0; 3]; 4]);
        for reversed in [false, true] {
            match self.slabs.channels {
                1 => dispatch!(level, simd => self.quadrant::<_, 1>(simd, scene, reversed)),
                _ => dispatch!(level, simd => self.quadrant::<_, 3>(simd, scene, reversed)),
            }
            self.slabs.reverse();
        }
    }

    /// Light that arrives from ahead.
    #[inline(always)]
    fn quadrant<S: Simd, const K: usize>(&mut self, simd: S, scene: Scene, reversed: bool) {
        self.pyramid.build::<S, K>(simd, &self.slabs);
        let sky = scene.cells.sky();
        self.cones.begin(|angle| {
            let ahead = if reversed { -angle.cos() } else { angle.cos() };
            sky.radiance(match self.axis {
                Axis::X => angle.sin() as f32,
                Axis::Y => ahead as f32,
            })
        });
        let length = 1 << scene.settings.hop;
        for plane in (1..=planes(self.slabs.depth, scene.settings.hop)).rev() {
            self.cones.descend::<S, K>(simd, &self.pyramid, plane);
            for slab in (plane - 1) * length..(plane * length).min(self.slabs.depth) {
                self.light::<S, K>(simd, scene, [slab, plane], reversed);
            }
        }
    }

    /// Lights the pixels of a slab that looks to a plane.
    #[inline(always)]
    fn light<S: Simd, const K: usize>(
        &mut self,
        simd: S,
        scene: Scene,
        [slab, plane]: [usize; 2],
        reversed: bool,
    ) {
        let width = scene.cells.width() as usize;
        let place = if reversed { self.slabs.depth - 1 - slab } else { slab };
        let normals = normals(self.axis, reversed);
        for row in (0..self.slabs.rows).step_by(TILE) {
            let [open, faces] = scene.fronts.bits(self.axis, place, row / TILE);
            let [lit, faces] = match scene.all {
                true => [open, faces],
                false => [scene.fronts.surfaces(self.axis, place, row / TILE), faces],
            };
            if lit == 0 {
                continue;
            }
            let (slabs, cones) = (&self.slabs, &self.cones);
            let tile = self.hop.light::<S, K>(simd, slabs, cones, [slab, plane], row, [lit, faces]);
            for (c, fluence) in self.fluence.iter_mut().enumerate() {
                let to = &mut fluence[place * self.stride + row..][..TILE];
                for v in 0..TILE / LANES {
                    let to = &mut to[v * LANES..][..LANES];
                    (tile[0][c][v] + f32x16::from_slice(simd, to)).store_slice(to);
                }
            }
            let mut left = faces;
            if left == 0 {
                continue;
            }
            let mut values = [[[[0.0; LANES]; TILE / LANES]; 3]; 3];
            for (side, values) in values.iter_mut().enumerate() {
                for c in 0..3 {
                    for v in 0..TILE / LANES {
                        tile[1 + side][c][v].store_slice(&mut values[c][v]);
                    }
                }
            }
            while left != 0 {
                let bit = left.trailing_zeros() as usize;
                left &= left - 1;
                let front = scene.fronts.slot(self.slabs.cell(self.axis, slab, row + bit, width));
                let onto = &mut self.onto[front];
                for (side, normal) in values.iter().zip(normals) {
                    for c in 0..3 {
                        onto[normal][c] += side[c][bit / LANES][bit % LANES];
                    }
                }
            }
        }
    }

    /// ∫ L dω at a cell.
    #[inline]
    pub fn fluence(&self, x: usize, y: usize) -> Rgb {
        let at = match self.axis {
            Axis::X => x * self.stride + y,
            Axis::Y => y * self.stride + x,
        };
        std::array::from_fn(|c| self.fluence[c][at])
    }

    /// ∫ L cosθ dω onto a face with a normal (by index) in front of which a cell lies.
    pub fn onto(&self, front: usize, normal: usize) -> Rgb {
        self.onto[front][normal]
    }
}

/// Which normals (by index in [`crate::stages::bounce::NORMALS`]) face light from ahead, from
/// higher rows and from lower ones.
fn normals(axis: Axis, reversed: bool) -> [usize; 3] {
    match (axis, reversed) {
        (Axis::X, false) => [1, 3, 2],
        (Axis::X, true) => [0, 3, 2],
        (Axis::Y, false) => [3, 1, 0],
        (Axis::Y, true) => [2, 1, 0],
    }
}
