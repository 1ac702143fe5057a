//! Irradiance of the faces of walls.
//!
//! On a face it is `½ ∫ L cosθ dω` (normalised: half of the irradiance E). Pixels find L at the centre
//! of the cell in front, half a px away. That is accurate in the open but not beside a step of the
//! wall, which shades the face more than the cell's centre: the stairs of a slanted wall would receive
//! light that in truth passes over them at a grazing angle. Of a bundle that descends s px along the
//! face for each px that it comes nearer, a step that begins k px beside the cell in front stops
//! the fraction
//!
//! `f = clamp(s − k, 0, 1)`
//!
//! exactly, over the whole px of the face. So L has the weight 1 − f, and the outgoing radiance of the
//! step the weight f.

use super::gather::FinalGather;
use super::interval::LANES;
use super::lattice::Face;
use super::row_bits::TILE;
use super::slabs::{Axis, MATTER, MEDIUM, Slabs};
use crate::Cells;
use crate::stages::bounce::Surfaces;
use crate::stages::faces::NORMALS;
use fearless_simd::{f32x16, mask32x16, prelude::*, u8x16};

/// ∫ L cosθ dω on the faces that look ahead, to higher rows and to lower rows, by channel, in sixteen
/// rows.
pub type FaceSums = [[[f32; LANES]; 3]; 3];

/// Cells beside the one in front that are searched for a step.
pub const REACH: usize = 3;
/// Distance to the step if there is none, px: farther than any bundle descends.
const NO_STEP: f32 = 1e9;
/// No face of a wall touches the cell.
const NO_FACE: u32 = u32::MAX;

/// Steps of walls beside the cells in front of sixteen faces, on one side.
struct WallSteps<S: Simd> {
    /// Px from each cell to its step.
    distance: f32x16<S>,
    /// Outgoing radiance of the step.
    light: [f32x16<S>; 3],
}

impl<S: Simd> WallSteps<S> {
    /// Finds the nearest solid cell among `reach` cells, `next` from one to the other, that rays enter
    /// by `face`.
    #[inline(always)]
    fn find(simd: S, slabs: &Slabs, start: usize, next: isize, reach: usize, face: Face) -> Self {
        let mut steps =
            Self { distance: f32x16::splat(simd, NO_STEP), light: [f32x16::splat(simd, 0.0); 3] };
        for distance in (0..reach).rev() {
            let at = start.wrapping_add_signed(next * (distance as isize + 1));
            let classes = u8x16::from_slice(simd, &slabs.classes[at..at + LANES]);
            let solid = (classes & (MATTER | MEDIUM)).simd_eq(MATTER).to_bitmask();
            if solid == 0 {
                continue;
            }
            let solid = mask32x16::from_bitmask(simd, solid);
            steps.distance = solid.select(f32x16::splat(simd, distance as f32), steps.distance);
            for c in 0..3 {
                let light = slabs.outgoing(simd, at, face, c);
                steps.light[c] = solid.select(light, steps.light[c]);
            }
        }
        steps
    }

    /// Returns the light through a cone of which a fraction meets the steps.
    #[inline(always)]
    fn shade(&self, light: [f32x16<S>; 3], angle: f32, slope: f32) -> [f32x16<S>; 3] {
        let fraction = (-self.distance + slope).max(0.0).min(1.0);
        let mut shaded = light;
        for c in 0..3 {
            shaded[c] = fraction.mul_add(self.light[c] * angle - light[c], light[c]);
        }
        shaded
    }
}

/// Returns ∫ L cosθ dω on the faces of sixteen rows of the tile that `gather` lit last.
#[inline(always)]
pub fn face_sums<S: Simd>(
    simd: S,
    slabs: &Slabs,
    gather: &FinalGather,
    slab: usize,
    row: usize,
) -> FaceSums {
    let zero = f32x16::splat(simd, 0.0);
    let start = slabs.start(slab) + row;
    let ahead = WallSteps::find(simd, slabs, start, slabs.step(), REACH, Face::Front);
    let high = WallSteps::find(simd, slabs, start, 1, 1, Face::Low);
    let low = WallSteps::find(simd, slabs, start, -1, 1, Face::High);
    let (mut faces, mut before) = ([[zero; 3]; 3], [zero; 3]);
    for (cone, sums) in gather.sums() {
        let mut light = [zero; 3];
        for c in 0..3 {
            let sum = f32x16::from_slice(simd, &sums[c][row % TILE..][..LANES]);
            light[c] = sum - before[c];
            before[c] = sum;
        }
        let [along, across] = cone.cosines;
        let (side, beside) = if across > 0.0 { (1, &high) } else { (2, &low) };
        let across = across.abs();
        let to_side = ahead.shade(light, cone.angle, along / across);
        let to_front = beside.shade(light, cone.angle, across / along);
        for c in 0..3 {
            faces[0][c] = to_front[c].mul_add(along, faces[0][c]);
            faces[side][c] = to_side[c].mul_add(across, faces[side][c]);
        }
    }
    let mut stored = [[[0.0; LANES]; 3]; 3];
    for side in 0..3 {
        for c in 0..3 {
            faces[side][c].store_slice(&mut stored[side][c]);
        }
    }
    stored
}

/// A bit per cell of the grid, 64 to a word, along both axes.
#[derive(Debug, Default)]
struct CellMask {
    /// Words of a slab, by axis.
    words: [usize; 2],
    bits: [Vec<u64>; 2],
}

impl CellMask {
    /// Sets no cells, or all.
    fn fill(&mut self, [width, height]: [usize; 2], all: bool) {
        self.words = [height.div_ceil(64), width.div_ceil(64)];
        for (axis, [slabs, rows]) in [[width, height], [height, width]].into_iter().enumerate() {
            let (words, bits) = (self.words[axis], &mut self.bits[axis]);
            bits.clear();
            bits.resize(slabs * words, if all { u64::MAX } else { 0 });
            if all && rows % 64 != 0 {
                bits.chunks_exact_mut(words).for_each(|slab| slab[words - 1] >>= 64 - rows % 64);
            }
        }
    }

    fn unset(&mut self, x: usize, y: usize) {
        self.bits[0][x * self.words[0] + y / 64] &= !(1 << (y % 64));
        self.bits[1][y * self.words[1] + x / 64] &= !(1 << (x % 64));
    }

    fn set(&mut self, x: usize, y: usize) {
        self.bits[0][x * self.words[0] + y / 64] |= 1 << (y % 64);
        self.bits[1][y * self.words[1] + x / 64] |= 1 << (x % 64);
    }

    #[inline(always)]
    fn word(&self, axis: Axis, column: usize, word: usize) -> u64 {
        self.bits[axis as usize][column * self.words[axis as usize] + word]
    }
}

/// Bit masks of 64 rows of a slab.
#[derive(Clone, Copy)]
pub struct ReceiverBits {
    /// Cells that are not solid.
    pub open: u64,
    /// Open cells that touch a face of a wall.
    pub faces: u64,
    /// Open cells whose light surfaces need: in front of faces, and of media that scatter.
    pub surfaces: u64,
}

/// The cells that light is gathered at.
#[derive(Debug, Default)]
pub struct Receivers {
    slots: Vec<u32>,
    count: usize,
    open: CellMask,
    faces: CellMask,
    surfaces: CellMask,
}

impl Receivers {
    /// Replaces the receivers with the cells that are open.
    pub fn read_open(&mut self, cells: &Cells) {
        let (w, h) = (cells.width() as usize, cells.height() as usize);
        self.slots.clear();
        self.slots.resize(cells.len(), NO_FACE);
        self.count = 0;
        self.faces.fill([w, h], false);
        self.surfaces.fill([w, h], false);
        self.open.fill([w, h], true);
        cells.for_each_solid(|i| self.open.unset(i % w, i / w));
    }

    /// Adds the cells in front of the faces of walls, and the media that scatter.
    pub fn add_surfaces(&mut self, cells: &Cells, surfaces: &Surfaces) {
        let w = cells.width() as usize;
        for wall in &surfaces.walls {
            for face in (0..4).filter(|&face| wall.exposed[face]) {
                let front = cell_in_front(wall.cell as usize, face, w);
                if self.slots[front] == NO_FACE {
                    self.slots[front] = self.count as u32;
                    self.count += 1;
                    self.faces.set(front % w, front / w);
                    self.surfaces.set(front % w, front / w);
                }
            }
        }
        for &i in &surfaces.media {
            self.surfaces.set(i as usize % w, i as usize / w);
        }
    }

    /// Returns the number of cells in front of faces.
    pub fn face_cells(&self) -> usize {
        self.count
    }

    /// Returns the number of a cell in front of a face.
    #[inline(always)]
    pub fn slot(&self, cell: usize) -> usize {
        self.slots[cell] as usize
    }

    /// Returns the bits of 64 rows, `word` · 64 and on, of a column of the grid (a row, along
    /// [`Axis::Y`]).
    #[inline(always)]
    pub fn bits(&self, axis: Axis, column: usize, word: usize) -> ReceiverBits {
        ReceiverBits {
            open: self.open.word(axis, column, word),
            faces: self.faces.word(axis, column, word),
            surfaces: self.surfaces.word(axis, column, word),
        }
    }
}

/// Returns the cell in front of a face of a wall.
pub fn cell_in_front(wall: usize, face: usize, width: usize) -> usize {
    let [x, y] = NORMALS[face];
    wall.wrapping_add_signed(y as isize * width as isize + x as isize)
}
