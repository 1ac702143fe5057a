//! The grid as the light of two opposite quadrants crosses it: slab after slab.
//!
//! A quadrant's light arrives within 45° of one axis. Along that axis the grid is cut into slabs
//! one px thin; the cells of a slab, its rows, lie one after the other, so that sixteen rays of
//! neighbouring rows and one direction are one vector. The opposite quadrant takes the same slabs
//! in reverse. Empty rows and slabs round the grid spare rays every test for its edge.

use super::interval::LANES;
use crate::Cells;
use crate::stages::bounce::{NORMALS, Surfaces};
use crate::stages::transmittance::log_transmittance;
use fearless_simd::{f32x16, prelude::*};

/// Rows of empty space on both sides of a slab: more than any ray of a last hop strays.
pub const MARGIN: usize = 64;

/// Bit of [`Slabs::kinds`]: the cell holds matter.
pub const MATTER: u8 = 1;

/// Bit of [`Slabs::kinds`]: the cell holds matter that is not solid.
pub const FRACTION: u8 = 2;

/// Bit of [`Slabs::kinds`]: the cell gives off light, or sends it on.
pub const GLOWING: u8 = 4;

/// Stands for the logarithm of what a px of wall lets through.
pub const LOG_OF_SOLID: f32 = -1e30;

/// The axis that a pair of quadrants looks along.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Slabs are columns.
    X,
    /// Slabs are rows of the grid.
    Y,
}

/// A face of a cell as a ray of the quadrant meets it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Face {
    /// Entered from the slab before.
    Front,
    /// Entered from the row before, going to higher rows.
    Low,
    /// Entered from the row after, going to lower rows.
    High,
}

/// What the cells are to rays, row by row of each slab.
#[derive(Debug, Default)]
pub struct Slabs {
    /// Slabs from one edge of the grid to the other.
    pub depth: usize,
    /// Cells of a slab.
    pub rows: usize,
    /// Rows from one slab to the next, margins and all.
    pub stride: usize,
    /// Empty slabs before the first and after the last.
    beyond: usize,
    /// Whether it looks the other way.
    pub reversed: bool,
    /// Channels of transmittance that differ: 1, or 3 where matter tints.
    pub channels: usize,
    /// Whether walls send out different light by face.
    faces: bool,
    /// Whether there is matter that is not solid: the shares that pass are held only then.
    fraction: bool,
    /// Share of light that crosses one px, by channel.
    pub pass: [Vec<f32>; 3],
    /// Its natural logarithm.
    pub log_pass: [Vec<f32>; 3],
    /// Radiance that matter gives off, by channel; 0 where there is no matter.
    source: [Vec<f32>; 3],
    /// Light that walls send on, by face (front of this direction, of the other, low, high).
    sent: [[Vec<f32>; 3]; 4],
    /// [`MATTER`], [`FRACTION`] and [`GLOWING`].
    pub kinds: Vec<u8>,
    /// The cells that hold matter, and where they are here.
    matter: Vec<u32>,
    occupied: Vec<usize>,
}

impl Slabs {
    /// Reads the grid along an axis, with empty slabs for rays of up to `beyond` px past its edges;
    /// `surfaces` add what they send on.
    pub fn read(&mut self, cells: &Cells, axis: Axis, beyond: usize, surfaces: Option<&Surfaces>) {
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
        let (mut coloured, mut fraction) = (false, false);
        cells.for_each_matter(|i| {
            matter.push(i as u32);
            let [r, g, b] = cells.tint()[i];
            coloured |= r != g || g != b;
            fraction |= !cells.is_solid(i);
        });
        self.channels = if coloured { 3 } else { 1 };
        self.fraction = fraction;
        self.faces = surfaces.is_some();
        self.empty();
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
            self.kinds[at] = MATTER
                | if solid { 0 } else { FRACTION }
                | if emission == [0.0; 3] { 0 } else { GLOWING };
            for c in 0..3 {
                self.source[c][at] = emission[c];
            }
            if fraction {
                let tint = cells.tint()[i];
                let log = if solid { [LOG_OF_SOLID; 3] } else { log_transmittance(opacity, tint) };
                for c in 0..self.channels {
                    self.pass[c][at] = (1.0 - opacity) * tint[c];
                    self.log_pass[c][at] = log[c];
                }
            }
            if let Some((surfaces, slot)) = surfaces.and_then(|s| Some((s, s.slot(i)?)))
                && self.send(surfaces, slot, at, solid, axis)
            {
                self.kinds[at] |= GLOWING;
            }
        }
        self.matter = matter;
    }

    /// Takes all matter out.
    fn empty(&mut self) {
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
            let passes = self.fraction && c < self.channels;
            clear(&mut self.pass[c], 1.0, passes);
            clear(&mut self.log_pass[c], 0.0, passes);
            for sent in &mut self.sent {
                clear(&mut sent[c], 0.0, self.faces);
            }
        }
        if self.kinds.len() == size {
            occupied.iter().for_each(|&at| self.kinds[at] = 0);
        } else {
            self.kinds.clear();
            self.kinds.resize(size, 0);
        }
        self.occupied = occupied;
        self.occupied.clear();
    }

    /// Adds what a surface sends on; returns whether that is any light.
    fn send(
        &mut self,
        surfaces: &Surfaces,
        slot: usize,
        at: usize,
        solid: bool,
        axis: Axis,
    ) -> bool {
        if !solid {
            let sent = surfaces.fog_sent[slot];
            (0..3).for_each(|c| self.source[c][at] += sent[c]);
            return sent != [0.0; 3];
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
            let sent = surfaces.wall_sent[slot][face];
            (0..3).for_each(|c| self.sent[to][c][at] = sent[c]);
        }
        surfaces.wall_sent[slot] != [[0.0; 3]; 4]
    }

    /// Looks the other way from here on.
    pub fn reverse(&mut self) {
        self.reversed = !self.reversed;
    }

    /// Where the rows of a slab begin.
    #[inline(always)]
    pub fn start(&self, slab: usize) -> usize {
        let slab = if self.reversed { self.depth - 1 - slab } else { slab };
        (self.beyond + slab) * self.stride + MARGIN
    }

    /// From the cells of a slab to those of the next one ahead.
    #[inline(always)]
    pub fn step(&self) -> isize {
        if self.reversed { -(self.stride as isize) } else { self.stride as isize }
    }

    /// The cell of a row of a slab in a grid `width` cells wide.
    pub fn cell(&self, axis: Axis, slab: usize, row: usize, width: usize) -> usize {
        let slab = if self.reversed { self.depth - 1 - slab } else { slab };
        match axis {
            Axis::X => row * width + slab,
            Axis::Y => slab * width + row,
        }
    }

    /// What the cells of sixteen rows send out from the face that a ray meets.
    #[inline(always)]
    pub fn sends<S: Simd>(&self, simd: S, at: usize, face: Face, channel: usize) -> f32x16<S> {
        let source = f32x16::from_slice(simd, &self.source[channel][at..at + LANES]);
        if !self.faces {
            return source;
        }
        let side = match face {
            Face::Front => self.reversed as usize,
            Face::Low => 2,
            Face::High => 3,
        };
        source + f32x16::from_slice(simd, &self.sent[side][channel][at..at + LANES])
    }
}
