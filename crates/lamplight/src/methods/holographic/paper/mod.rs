//! Holographic radiance cascades as published, written plainly (Freeman, Sannikov and Margel 2025,
//! arXiv 2505.02041; "paper variant").
//!
//! The reference of `holographic`, and the yardstick of `lamplight bench`: scalar f32 with rows
//! innermost, whole levels one after another, nothing blocked, packed or skipped. Direct light only.
//! Rows are looked up once per ray instead of once per cell, which is about 2.5 times as fast as the
//! formulas cell by cell: a yardstick that is easy to beat would flatter what it measures.
//!
//! Each quarter of the circle is a [`Quadrant`], the grid rotated so that light arrives from +x:
//!
//! 1. **Trace** `T_0` … `T_traced` from cell centre to cell centre, with exact path lengths.
//! 2. **Extend**: longer intervals from two shorter ones, straight or bent half way.
//! 3. **Merge** down: the light that arrives in a cone, from the far end of the grid to the cell.
//!
//! The mean radiance J is the sum over the quadrants of `R_0` ÷ 2π, optionally blurred by a cross that
//! removes the checkerboard. Sums are ordered so that rotating the grid by 90° or mirroring it rotates
//! and mirrors the light to the bit.
//!
//! - A **solid cell** adds its emitted radiance `L_e` and ends the ray as soon as the ray is in it. So
//!   a ray that starts in one is ⟨`L_e`, 0⟩, and the mean radiance found there is `L_e`: it is not the
//!   irradiance of the cell's faces.
//! - A ray through the **corner** of four cells passes the two beside it for a length of 0. It is
//!   stopped if both are solid (with the mean of their `L_e`), and passes a single one.
//! - `R_N` on the first plane is made from `T_N`, which reaches through the whole grid, and not
//!   taken for the sky: otherwise cells at the border would lack a fraction 1/2^N of their light.
//! - A bent path that leaves the grid is ⟨0, 1⟩ from there on. With `traced = 0` the interval (2, 0)
//!   has such a path in the first and last row, where part of the light leaks around walls that reach
//!   the border; with `traced` ≥ 1 there is none.

mod grid;
mod interval;
mod quadrant;

pub use grid::Piece;
pub use interval::{Interval, Transmittance};
pub use quadrant::{Quadrant, edges, paths, rays};

use crate::{Cells, Rgb};
use std::f32::consts::TAU;

/// The plain implementation and its buffers, which it keeps from one solve to the next: about
/// `2·W²·(log₂W + 2)` intervals of 16 B (24 B with tint) on a W×W grid, 100 MB at 512².
#[derive(Debug)]
pub struct Paper {
    /// Intervals are traced directly up to this level, at least level 0; longer ones are extended.
    pub traced: u32,
    /// True if the result is smoothed by the cross blur.
    pub blur: bool,
    grey: [Quadrant<f32>; 2],
    tinted: [Quadrant<Rgb>; 2],
    sums: [Vec<Rgb>; 2],
    light: Vec<Rgb>,
}

impl Paper {
    /// Creates the variant that methods are timed against: level 0 traced, no blur.
    pub fn yardstick() -> Self {
        Self::new(0, false)
    }

    /// Creates the paper's variant: levels 0 to 2 traced, then the cross blur.
    pub fn published() -> Self {
        Self::new(2, true)
    }

    /// Creates any variant.
    pub fn new(traced: u32, blur: bool) -> Self {
        Self {
            traced,
            blur,
            grey: Default::default(),
            tinted: Default::default(),
            sums: Default::default(),
            light: Vec::new(),
        }
    }

    /// Returns the mean radiance of every cell, in row order. Lamps are ignored: draw them in first
    /// ([`Cells::drawn`]).
    pub fn solve(&mut self, cells: &Cells) -> &[Rgb] {
        if has_tint(cells) {
            add_quadrants(&mut self.tinted, &mut self.sums, cells, self.traced);
        } else {
            add_quadrants(&mut self.grey, &mut self.sums, cells, self.traced);
        }
        let [a, b] = &self.sums;
        let mean = |(a, b): (&Rgb, &Rgb)| std::array::from_fn(|c| (a[c] + b[c]) / TAU);
        self.light.clear();
        self.light.extend(a.iter().zip(b).map(mean));
        if self.blur {
            let sharp = &mut self.sums[0];
            sharp.clone_from(&self.light);
            cross_blur(cells, sharp, &mut self.light);
        }
        &self.light
    }
}

/// Returns whether the transmittance of any cell differs by channel.
fn has_tint(cells: &Cells) -> bool {
    cells.tint().iter().any(|t| t[1] != t[0] || t[2] != t[0])
}

/// Solves the four quadrants, two at a time. Each of the two sums gets two opposite quadrants, so that
/// their order does not matter.
fn add_quadrants<T: Transmittance>(
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

/// Blurs with weight 4 for the cell and 1 for each of its four neighbours; those outside the grid or of
/// another opacity have none. (Published: 1, 4, 1 ÷ 8.)
fn cross_blur(cells: &Cells, sharp: &[Rgb], blurred: &mut [Rgb]) {
    let (w, h) = (cells.width() as usize, cells.height() as usize);
    for (i, blurred) in blurred.iter_mut().enumerate() {
        let (x, y) = (i % w, i / w);
        let alike = |inside: bool, j: usize| {
            if inside && cells.opacity()[j] == cells.opacity()[i] {
                (1.0, sharp[j])
            } else {
                (0.0, [0.0; 3])
            }
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
