//! Two opposite quadrants: the light that arrives along one axis of the grid.

use super::cones::Cones;
use super::fronts::Fronts;
use super::hop::Hop;
use super::interval::LANES;
use super::march::{TILE, VECTORS, of_vector};
use super::onto;
use super::pyramid::{Pyramid, planes};
use super::slabs::{Axis, Slabs};
use super::ways::Look;
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
        let look = Look::new(settings);
        let beyond = look.most().max(onto::REACH);
        self.slabs.read(scene.cells, self.axis, beyond, scene.surfaces);
        self.pyramid.prepare(&self.slabs, settings.hop);
        let Slabs { depth, rows, .. } = self.slabs;
        self.cones.prepare(depth, rows, &self.pyramid, look.most());
        // Not a power of two: else cells of neighbouring slabs would compete for places in caches.
        self.stride = rows.next_multiple_of(TILE) + LANES;
        for fluence in &mut self.fluence {
            fluence.resize(depth * self.stride, 0.0);
        }
        self.onto.clear();
        self.onto.resize(scene.fronts.len(), [[0.0; 3]; 4]);
        self.pyramid.aim(&self.slabs, settings.beams);
        self.hop.aim(&self.slabs, look);
        for reversed in [false, true] {
            match self.slabs.channels {
                1 => dispatch!(level, simd => self.quadrant::<_, 1>(simd, scene, look, reversed)),
                _ => dispatch!(level, simd => self.quadrant::<_, 3>(simd, scene, look, reversed)),
            }
            self.slabs.reverse();
        }
    }

    /// Light that arrives from ahead.
    #[inline(always)]
    fn quadrant<S: Simd, const K: usize>(
        &mut self,
        simd: S,
        scene: Scene,
        look: Look,
        reversed: bool,
    ) {
        let sky = scene.cells.sky();
        self.cones.begin(|angle| {
            let ahead = if reversed { -angle.cos() } else { angle.cos() };
            sky.radiance(match self.axis {
                Axis::X => angle.sin() as f32,
                Axis::Y => ahead as f32,
            })
        });
        for plane in (1..=look.last(self.slabs.depth)).rev() {
            if plane < planes(self.slabs.depth, look.level) {
                self.pyramid.make::<S, K>(simd, &self.slabs, plane);
            }
            self.cones.descend::<S, K>(simd, &self.pyramid, plane);
            // Tile by tile: the light of 64 rows of the plane stays close while all slabs look at it.
            for row in (0..self.slabs.rows).step_by(TILE) {
                for slab in look.slabs(plane, self.slabs.depth) {
                    self.light::<S, K>(simd, scene, [slab, plane], row, reversed);
                }
            }
        }
    }

    /// Lights 64 pixels of a slab that look to a plane.
    #[inline(always)]
    fn light<S: Simd, const K: usize>(
        &mut self,
        simd: S,
        scene: Scene,
        [slab, plane]: [usize; 2],
        row: usize,
        reversed: bool,
    ) {
        let place = if reversed { self.slabs.depth - 1 - slab } else { slab };
        let [open, faces, surfaces] = scene.fronts.bits(self.axis, place, row / TILE);
        let lit = if scene.all { open } else { surfaces };
        if lit == 0 {
            return;
        }
        let (slabs, cones) = (&self.slabs, &self.cones);
        let light = self.hop.light::<S, K>(simd, slabs, cones, [slab, plane], row, [lit, faces]);
        for (c, fluence) in self.fluence.iter_mut().enumerate() {
            let to = &mut fluence[place * self.stride + row..][..TILE];
            for v in 0..VECTORS {
                let to = &mut to[v * LANES..][..LANES];
                let mut light = light[c][v];
                if reversed {
                    light += f32x16::from_slice(simd, to);
                }
                light.store_slice(to);
            }
        }
        let width = scene.cells.width() as usize;
        let normals = normals(self.axis, reversed);
        for v in (0..VECTORS).filter(|v| of_vector(faces, v * LANES)) {
            let onto = onto::onto(simd, slabs, &self.hop, [slab, row + v * LANES]);
            let mut left = faces >> (v * LANES) & 0xffff;
            while left != 0 {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                let row = row + v * LANES + lane;
                let front = scene.fronts.slot(self.slabs.cell(self.axis, slab, row, width));
                for (side, normal) in onto.iter().zip(normals) {
                    for c in 0..3 {
                        self.onto[front][normal][c] += side[c][lane];
                    }
                }
            }
        }
    }

    /// ∫ L dω of a channel at the rows of a slab.
    #[inline(always)]
    pub fn slab(&self, channel: usize, slab: usize) -> &[f32] {
        &self.fluence[channel][slab * self.stride..][..self.stride]
    }

    /// ∫ L dω at a cell.
    #[inline(always)]
    pub fn fluence(&self, x: usize, y: usize) -> Rgb {
        let at = match self.axis {
            Axis::X => x * self.stride + y,
            Axis::Y => y * self.stride + x,
        };
        [self.fluence[0][at], self.fluence[1][at], self.fluence[2][at]]
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
