//! The grid as the light of two opposite quadrants crosses it, slab by slab.
//!
//! A quadrant's light arrives within 45° of one axis. Along that axis the grid is cut into slabs
//! 1 px thin. The cells of a slab, its rows, are contiguous, so that sixteen rays of neighbouring rows
//! and one direction are one vector. The opposite quadrant reads the same slabs in reverse. Empty rows
//! and slabs around the grid make bounds checks along rays unnecessary.

use super::interval::LANES;
use super::lattice::Face;
use crate::Cells;
use crate::math::transmittance::extinction;
use crate::stages::bounce::Surfaces;
use crate::stages::faces::NORMALS;
use fearless_simd::{f32x16, prelude::*};

/// Empty rows on both sides of a slab: more than any ray of the final gather rises.
pub const MARGIN: usize = 64;

/// Bit of `Slabs::classes`: the cell holds matter.
pub const MATTER: u8 = 1;

/// Bit of `Slabs::classes`: the cell holds a participating medium.
pub const MEDIUM: u8 = 2;

/// Bit of `Slabs::classes`: the cell emits, reflects or scatters light.
pub const EMISSIVE: u8 = 4;

/// Bit of `Slabs::classes`: the cell is part of a source at most four points of the lattice wide and high. It is
/// [`EMISSIVE`], and none of the eight cells around it is solid. The emitting cells are counted along its row and its column,
/// and again across the middle of each of these runs, so that a disc is small as a whole or not at all.
pub const SMALL: u8 = 8;

/// Bit of `Slabs::classes`: the cell emits light of its own. What only reflects or scatters has no sharp bright edges,
/// so one ray a cone is enough for it.
pub const PRIMARY: u8 = 16;

/// Stands for the infinite extinction of a solid, 1/px.
pub const SOLID_EXTINCTION: f32 = 1e30;

/// The axis along which slabs follow one another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Slabs are columns of the grid.
    X,
    /// Slabs are rows of the grid.
    Y,
}

/// The properties of cells that rays read, row by row of each slab.
#[derive(Debug, Default)]
pub struct Slabs {
    /// Slabs from one edge of the grid to the other.
    pub depth: usize,
    /// Cells of a slab.
    pub rows: usize,
    /// Offset from one slab to the next, margins included.
    pub stride: usize,
    /// Empty slabs before the first and after the last.
    beyond: usize,
    /// True if slabs are read in reverse.
    pub reversed: bool,
    /// Channels of transmittance that differ: 1, or 3 if matter tints.
    pub channels: usize,
    /// True if the outgoing radiance of solids depends on the face.
    by_face: bool,
    /// True if there is a participating medium; if not, transmittance and extinction are not stored.
    media: bool,
    /// Transmittance of one px, by channel.
    pub transmittance: [Vec<f32>; 3],
    /// Extinction σ_t per px, by channel.
    pub extinction: [Vec<f32>; 3],
    /// Emitted radiance, in media with the scattered one, by channel; 0 in empty cells.
    source: [Vec<f32>; 3],
    /// Radiance that solids reflect, by face (front of this direction, of the other, low, high).
    reflected: [[Vec<f32>; 3]; 4],
    /// [`MATTER`], [`MEDIUM`], [`EMISSIVE`], [`SMALL`] and [`PRIMARY`].
    pub classes: Vec<u8>,
    /// The cells that hold matter, and their places here.
    matter: Vec<u32>,
    occupied: Vec<usize>,
}

impl Slabs {
    /// Reads the grid along an axis, with empty slabs for rays of up to `beyond` px past its edges, for a lattice
    /// whose points lie `spacing` px apart.
    /// `surfaces` add the radiance that they reflect or scatter.
    pub fn read(
        &mut self,
        cells: &Cells,
        axis: Axis,
        [beyond, spacing]: [usize; 2],
        surfaces: Option<&Surfaces>,
    ) {
        let (w, h) = (cells.width() as usize, cells.height() as usize);
        (self.depth, self.rows) = match axis {
            Axis::X => (w, h),
            Axis::Y => (h, w),
        };
        self.stride = self.rows.next_multiple_of(64) + 2 * MARGIN;
        self.beyond = beyond;
        self.reversed = false;
        let mut matter = std::mem::take(&mut self.matter);
        matter.clear();
        let (mut coloured, mut media) = (false, false);
        cells.for_each_matter(|i| {
            matter.push(i as u32);
            let [r, g, b] = cells.tint()[i];
            coloured |= r != g || g != b;
            media |= !cells.is_solid(i);
        });
        self.channels = if coloured { 3 } else { 1 };
        self.media = media;
        self.by_face = surfaces.is_some();
        self.clear();
        for i in matter.iter().map(|&i| i as usize) {
            let opacity = cells.opacity()[i];
            let (slab, row) = match axis {
                Axis::X => (i % w, i / w),
                Axis::Y => (i / w, i % w),
            };
            let at = self.start(slab) + row;
            self.occupied.push(at);
            let emission = cells.emission()[i];
            let solid = opacity >= 1.0;
            self.classes[at] = MATTER
                | if solid { 0 } else { MEDIUM }
                | if emission == [0.0; 3] { 0 } else { EMISSIVE | PRIMARY };
            for c in 0..3 {
                self.source[c][at] = emission[c];
            }
            if media {
                let tint = cells.tint()[i];
                let extinction =
                    if solid { [SOLID_EXTINCTION; 3] } else { extinction(opacity, tint) };
                for c in 0..self.channels {
                    self.transmittance[c][at] = (1.0 - opacity) * tint[c];
                    self.extinction[c][at] = extinction[c];
                }
            }
            if let Some((surfaces, slot)) = surfaces.and_then(|s| Some((s, s.slot(i)?)))
                && self.add_surface(surfaces, slot, at, solid, axis)
            {
                self.classes[at] |= EMISSIVE;
            }
        }
        for (&at, &i) in self.occupied.iter().zip(&matter) {
            let emits = |at: usize| self.classes.get(at).is_some_and(|class| class & EMISSIVE != 0);
            // At most this many cells in a row emit.
            let most = 4 * spacing;
            // The middle of those in a row with a cell.
            let middle = |at: usize, step: usize| {
                let before = (1..=most).take_while(|i| emits(at.wrapping_sub(i * step))).count();
                let after = (1..=most).take_while(|i| emits(at + i * step)).count();
                (before + after < most).then(|| at - before * step + (before + after) / 2 * step)
            };
            let is_thin = |step: usize, across: usize| {
                middle(at, step).is_some_and(|at| middle(at, across).is_some())
            };
            let stride = self.stride;
            let is_low_and_narrow = || is_thin(1, stride) && is_thin(stride, 1);
            if emits(at) && is_alone(cells, i as usize) && is_low_and_narrow() {
                self.classes[at] |= SMALL;
            }
        }
        self.matter = matter;
    }

    /// Empties all cells.
    fn clear(&mut self) {
        let size = (self.depth + 2 * self.beyond) * self.stride;
        let occupied = std::mem::take(&mut self.occupied);
        let clear = |to: &mut Vec<f32>, value: f32, used: bool| {
            if to.len() != if used { size } else { 0 } {
                to.clear();
                to.resize(if used { size } else { 0 }, value);
            } else if used {
                occupied.iter().for_each(|&at| to[at] = value);
            }
        };
        for c in 0..3 {
            clear(&mut self.source[c], 0.0, true);
            let media = self.media && c < self.channels;
            clear(&mut self.transmittance[c], 1.0, media);
            clear(&mut self.extinction[c], 0.0, media);
            for reflected in &mut self.reflected {
                clear(&mut reflected[c], 0.0, self.by_face);
            }
        }
        if self.classes.len() == size {
            occupied.iter().for_each(|&at| self.classes[at] = 0);
        } else {
            self.classes.clear();
            self.classes.resize(size, 0);
        }
        self.occupied = occupied;
        self.occupied.clear();
    }

    /// Adds the radiance that a surface reflects or scatters; returns whether there is any.
    fn add_surface(
        &mut self,
        surfaces: &Surfaces,
        slot: usize,
        at: usize,
        solid: bool,
        axis: Axis,
    ) -> bool {
        if !solid {
            let scattered = surfaces.medium_scattered[slot];
            (0..3).for_each(|c| self.source[c][at] += scattered[c]);
            return scattered != [0.0; 3];
        }
        for (face, normal) in NORMALS.into_iter().enumerate() {
            let [along, across] = match axis {
                Axis::X => normal,
                Axis::Y => [normal[1], normal[0]],
            };
            let to = match (along, across) {
                (-1, _) => 0,
                (1, _) => 1,
                (_, -1) => 2,
                _ => 3,
            };
            let reflected = surfaces.wall_reflected[slot][face];
            (0..3).for_each(|c| self.reflected[to][c][at] = reflected[c]);
        }
        surfaces.wall_reflected[slot] != [[0.0; 3]; 4]
    }

    /// Reverses the order in which slabs are read.
    pub fn reverse(&mut self) {
        self.reversed = !self.reversed;
    }

    /// Returns the place of a slab's first row.
    #[inline(always)]
    pub fn start(&self, slab: usize) -> usize {
        (self.beyond + self.column(slab)) * self.stride + MARGIN
    }

    /// Returns the classes of the cells of a slab, which may lie behind the grid, where all are empty.
    #[inline(always)]
    pub fn classes_in(&self, slab: usize) -> &[u8] {
        let start = self.start(0).wrapping_add_signed(slab as isize * self.step());
        &self.classes[start..][..self.rows]
    }

    /// Returns the offset from a slab to the next one ahead.
    #[inline(always)]
    pub fn step(&self) -> isize {
        if self.reversed { -(self.stride as isize) } else { self.stride as isize }
    }

    /// Returns the column of the grid (its row, along [`Axis::Y`]) that a slab is.
    #[inline(always)]
    pub fn column(&self, slab: usize) -> usize {
        if self.reversed { self.depth - 1 - slab } else { slab }
    }

    /// Returns the index of the cell in a row of a slab, for a grid `width` cells wide.
    pub fn cell(&self, axis: Axis, slab: usize, row: usize, width: usize) -> usize {
        let column = self.column(slab);
        match axis {
            Axis::X => row * width + column,
            Axis::Y => column * width + row,
        }
    }

    /// Returns the outgoing radiance of the cells of sixteen rows, at the face that a ray enters by.
    #[inline(always)]
    pub fn outgoing<S: Simd>(&self, simd: S, at: usize, face: Face, channel: usize) -> f32x16<S> {
        let source = f32x16::from_slice(simd, &self.source[channel][at..at + LANES]);
        if !self.by_face {
            return source;
        }
        let side = match face {
            Face::Front => self.reversed as usize,
            Face::Low => 2,
            Face::High => 3,
        };
        source + f32x16::from_slice(simd, &self.reflected[side][channel][at..at + LANES])
    }
}

/// Returns whether a cell of these classes is not solid.
#[inline(always)]
pub fn is_open(class: u8) -> bool {
    class & (MATTER | MEDIUM) != MATTER
}

/// Returns whether none of the eight cells around this one is solid.
fn is_alone(cells: &Cells, cell: usize) -> bool {
    let (w, h) = (cells.width() as usize, cells.height() as usize);
    let (x, y) = (cell % w, cell / w);
    let rows = y.saturating_sub(1)..h.min(y + 2);
    let around = rows.flat_map(|y| (x.saturating_sub(1)..w.min(x + 2)).map(move |x| y * w + x));
    around.filter(|&at| at != cell).all(|at| !cells.is_solid(at))
}
