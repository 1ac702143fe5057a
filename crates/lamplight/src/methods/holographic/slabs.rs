//! The grid as the light of two opposite quadrants crosses it: slab after slab.
//!
//! A quadrant's light arrives within 45° of one axis. Along that axis the grid is cut into slabs
//! one px thin; the cells of a slab, its rows, lie one after the other, so that sixteen rays of
//! neighbouring rows and one direction are one vector. The opposite quadrant takes the same slabs
//! in reverse. Empty rows and slabs round the grid spare rays every test for its edge.

use crate::Cells;
use crate::stages::bounce::{NORMALS, Surfaces};
use crate::stages::transmittance::log_transmittance;

/// Rows of empty space on both sides of a slab: more than any ray of a last hop strays, and a
/// whole word of [`Slabs::bits`].
pub const MARGIN: usize = 64;

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
    /// Rows from one slab to the next, margins and all: a multiple of 64.
    pub stride: usize,
    reversed: bool,
    /// Channels of transmittance that differ: 1, or 3 where matter tints.
    pub channels: usize,
    /// Whether walls send out different light by face.
    faces: bool,
    /// Share of light that crosses one px, by channel.
    pub pass: [Vec<f32>; 3],
    /// Its natural logarithm.
    pub log_pass: [Vec<f32>; 3],
    /// Radiance that matter gives off, by channel; 0 where there is no matter.
    pub source: [Vec<f32>; 3],
    /// Light that walls send on, by face (front of this direction, of the other, low, high).
    sent: [[Vec<f32>; 3]; 4],
    /// Bits of cells that hold matter, and of those that are not solid.
    matter: Vec<u64>,
    fraction: Vec<u64>,
}

impl Slabs {
    /// Reads the grid along an axis; `surfaces` add what they send on.
    pub fn read(&mut self, cells: &Cells, axis: Axis, surfaces: Option<&Surfaces>) {
        let (w, h) = (cells.width() as usize, cells.height() as usize);
        (self.depth, self.rows) = match axis {
            Axis::X => (w, h),
            Axis::Y => (h, w),
        };
        self.stride = self.rows.next_multiple_of(64) + 2 * MARGIN;
        self.reversed = false;
        let tints = |i: usize| {
            let [r, g, b] = cells.tint()[i];
            r != g || g != b
        };
        self.channels = if (0..cells.len()).any(tints) { 3 } else { 1 };
        self.faces = surfaces.is_some();
        // One slab more, all empty, stands for everything outside.
        let size = (self.depth + 1) * self.stride;
        let fill = |to: &mut Vec<f32>, value: f32| {
            to.clear();
            to.resize(size, value);
        };
        for c in 0..3 {
            fill(&mut self.source[c], 0.0);
            if c < self.channels {
                fill(&mut self.pass[c], 1.0);
                fill(&mut self.log_pass[c], 0.0);
            }
            if self.faces {
                (0..4).for_each(|face| fill(&mut self.sent[face][c], 0.0));
            }
        }
        for bits in [&mut self.matter, &mut self.fraction] {
            bits.clear();
            bits.resize(size / 64 + 1, 0);
        }
        for slab in 0..self.depth {
            for row in 0..self.rows {
                let i = match axis {
                    Axis::X => row * w + slab,
                    Axis::Y => slab * w + row,
                };
                let opacity = cells.opacity()[i];
                if opacity == 0.0 && cells.tint()[i] == [1.0; 3] {
                    continue;
                }
                let at = slab * self.stride + MARGIN + row;
                self.matter[at / 64] |= 1 << (at % 64);
                if opacity < 1.0 {
                    self.fraction[at / 64] |= 1 << (at % 64);
                }
                let tint = cells.tint()[i];
                let log = log_transmittance(opacity, tint);
                for c in 0..3 {
                    self.source[c][at] = cells.emission()[i][c];
                    if c < self.channels {
                        self.pass[c][at] = (1.0 - opacity) * tint[c];
                        self.log_pass[c][at] = log[c];
                    }
                }
                if let Some((surfaces, slot)) = surfaces.and_then(|s| Some((s, s.slot(i)?))) {
                    self.send(surfaces, slot, at, opacity >= 1.0, axis);
                }
            }
        }
    }

    /// Adds what a surface sends on.
    fn send(&mut self, surfaces: &Surfaces, slot: usize, at: usize, solid: bool, axis: Axis) {
        for c in 0..3 {
            if !solid {
                self.source[c][at] += surfaces.fog_sent[slot][c];
                continue;
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
                self.sent[to][c][at] = surfaces.wall_sent[slot][face][c];
            }
        }
    }

    /// Looks the other way from here on.
    pub fn reverse(&mut self) {
        self.reversed = !self.reversed;
    }

    /// Where the rows of a slab begin; slabs past the last are empty.
    #[inline(always)]
    pub fn start(&self, slab: usize) -> usize {
        let slab = match slab {
            s if s >= self.depth => self.depth,
            s if self.reversed => self.depth - 1 - s,
            s => s,
        };
        slab * self.stride + MARGIN
    }

    /// The cell of a row of a slab in a grid `width` cells wide.
    pub fn cell(&self, axis: Axis, slab: usize, row: usize, width: usize) -> usize {
        let slab = if self.reversed { self.depth - 1 - slab } else { slab };
        match axis {
            Axis::X => row * width + slab,
            Axis::Y => slab * width + row,
        }
    }

    /// Light that walls send on from the face that a ray meets; none if nothing bounces.
    #[inline(always)]
    pub fn sent(&self, face: Face) -> Option<&[Vec<f32>; 3]> {
        let side = match face {
            Face::Front => self.reversed as usize,
            Face::Low => 2,
            Face::High => 3,
        };
        if self.faces { Some(&self.sent[side]) } else { None }
    }

    /// Which of 64 rows from `row` on hold matter, and which of them matter that is not solid.
    #[inline(always)]
    pub fn bits(&self, row: usize) -> [u64; 2] {
        let (word, shift) = (row / 64, row % 64);
        [window(&self.matter, word, shift), window(&self.fraction, word, shift)]
    }
}

/// 64 bits from `shift` of a word on.
#[inline(always)]
fn window(bits: &[u64], word: usize, shift: usize) -> u64 {
    let pair = u128::from(bits[word]) | u128::from(bits[word + 1]) << 64;
    (pair >> shift) as u64
}
