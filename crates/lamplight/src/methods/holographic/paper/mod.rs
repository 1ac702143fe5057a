//! Holographic radiance cascades as published, written plainly (Freeman, Sannikov and Margel 2025,
//! arXiv 2505.02041; "paper variant").
//!
//! Gold for the engine's `holographic`, and the yardstick of `lamplight bench`: scalar f32 with rows
//! innermost, whole levels one after another, nothing blocked, packed or skipped. Direct light only.
//! Rows are looked up once a ray and not once a cell, which makes it about 2.5 times as fast as the
//! formulas typed out cell by cell: a yardstick that is easy to beat would flatter what it measures.
//!
//! Each quarter of the circle is a [`Quadrant`], the grid turned so that light arrives from +x:
//!
//! 1. **Trace** `T_0` … `T_traced` from cell centre to cell centre, with exact path lengths.
//! 2. **Extend**: longer intervals from two shorter ones, straight or bent half way.
//! 3. **Merge** down: what arrives in a cone, from the far end of everything to the cell.
//!
//! φ is the sum over the quadrants of `R_0` ÷ 2π, optionally blurred by a cross that removes the
//! checkerboard. Sums are ordered so that turning the grid by 90° or mirroring it turns and mirrors
//! the light to the bit.
//!
//! - A **solid cell** adds its E and ends the ray as soon as the ray is in it. So a ray that starts
//!   in one is ⟨E, 0⟩, and the fluence found there is E: no answer to what its faces receive.
//! - A ray through the **corner** of four cells passes the two beside it for a length of 0. It is
//!   stopped where both are solid (and sees the mean of their E), and grazes a single one.
//! - `R_N` on the first plane is made from `T_N`, which reaches through the whole grid, and not
//!   taken for the sky: else cells at the border would miss a share of 1/2^N of their light.
//! - A bend that leaves the grid is ⟨0, 1⟩ from there on. With `traced = 0` the interval (2, 0) has
//!   such a bend in the first and last row, where a share of light so gets round walls that reach
//!   the border; with `traced` ≥ 1 there is none.

mod grid;
mod interval;
mod quadrant;

pub use grid::Piece;
pub use interval::{Interval, Through};
pub use quadrant::{Quadrant, cone, rays, ways};

use crate::{Cells, Rgb};
use std::f32::consts::TAU;

/// The plain implementation and its buffers, which it keeps from one solve to the next: about
/// `2·W²·(log₂W + 2)` intervals of 16 B (24 B with tint) on a W×W grid, 100 MB at 512².
#[derive(Debug)]
pub struct Paper {
    /// Intervals are traced directly up to this level, at least level 0; longer ones are extended.
    pub traced: u32,
    /// Whether the cross blur smooths the result.
    pub blur: bool,
    grey: [Quadrant<f32>; 2],
    tinted: [Quadrant<Rgb>; 2],
    sums: [Vec<Rgb>; 2],
    fluence: Vec<Rgb>,
}

impl Paper {
    /// The variant that methods are timed against: level 0 traced, no blur.
    pub fn yardstick() -> Self {
        Self::new(0, false)
    }

    /// The paper's: levels 0 to 2 traced, then the cross blur.
    pub fn published() -> Self {
        Self::new(2, true)
    }

    /// Any variant.
    pub fn new(traced: u32, blur: bool) -> Self {
        Self {
            traced,
            blur,
            grey: Default::default(),
            tinted: Default::default(),
            sums: Default::default(),
            fluence: Vec::new(),
        }
    }

    /// The fluence of every cell, in row order. Lamps are not seen: draw them in first
    /// ([`Cells::drawn`]).
    pub fn solve(&mut self, cells: &Cells) -> &[Rgb] {
        if has_tint(cells) {
            add_quadrants(&mut self.tinted, &mut self.sums, cells, self.traced);
        } else {
            add_quadrants(&mut self.grey, &mut self.sums, cells, self.traced);
        }
        let [a, b] = &self.sums;
        let mean = |(a, b): (&Rgb, &Rgb)| std::array::from_fn(|c| (a[c] + b[c]) / TAU);
        self.fluence.clear();
        self.fluence.extend(a.iter().zip(b).map(mean));
        if self.blur {
            let sharp = &mut self.sums[0];
            sharp.clone_from(&self.fluence);
            cross_blur(cells, sharp, &mut self.fluence);
        }
        &self.fluence
    }
}

/// Whether any cell lets the channels through differently.
fn has_tint(cells: &Cells) -> bool {
    cells.tint().iter().any(|t| t[1] != t[0] || t[2] != t[0])
}

/// Solves the four quadrants, two at a time; each of the two sums gets two that face each other, so
/// that their order does not matter.
fn add_quadrants<T: Through>(
    quadrants: &mut [Quadrant<T>; 2],
    sums: &mut [Vec<Rgb>; 2],
    cells: &Cells,
    traced: u32,
) {
    let pair = |quadrant: &mut Quadrant<T>, sum: &mut Vec<Rgb>, turns: [u32; 2]| {
        sum.clear();
        sum.resize(cells.len(), [0.0; 3]);
        for turn in turns {
            quadrant.prepare(cells, turn, traced);
            quadrant.add_light(sum);
        }
    };
    let ([qa, qb], [sa, sb]) = (quadrants, sums);
    rayon::join(|| pair(qa, sa, [0, 2]), || pair(qb, sb, [1, 3]));
}

/// The cell counts 4, its neighbours by a side 1 each; those outside the grid or of another opacity
/// do not count. The published 1, 4, 1 ÷ 8.
fn cross_blur(cells: &Cells, sharp: &[Rgb], blurred: &mut [Rgb]) {
    let (w, h) = (cells.width() as usize, cells.height() as usize);
    for (i, blurred) in blurred.iter_mut().enumerate() {
        let (x, y) = (i % w, i / w);
        let alike = |inside: bool, j: usize| match inside {
            true if cells.opacity()[j] == cells.opacity()[i] => (1.0, sharp[j]),
            _ => (0.0, [0.0; 3]),
        };
        let left = alike(x > 0, i.wrapping_sub(1));
        let right = alike(x + 1 < w, i + 1);
        let up = alike(y > 0, i.wrapping_sub(w));
        let down = alike(y + 1 < h, i + w);
        let weight = 4.0 + left.0 + right.0 + up.0 + down.0;
        *blurred = std::array::from_fn(|c| {
            (4.0 * sharp[i][c] + ((left.1[c] + right.1[c]) + (up.1[c] + down.1[c]))) / weight
        });
    }
}
