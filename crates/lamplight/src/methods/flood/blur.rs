//! The grid of energy, and how neighbours are mixed.

use crate::Rgb;
use crate::stages::ground::{Kind, LANES};
use fearless_simd::{Level, dispatch, f32x16, prelude::*};
use rayon::prelude::*;

/// What a cell holds: red, green, blue, energy.
type Cell = [f32; 4];
/// Cells that a thread takes at a time, about: small grids are not worth a second thread.
const TOGETHER: usize = 1 << 14;

fn is_open(kind: Kind) -> bool {
    matches!(kind, Kind::Clear | Kind::Medium)
}

/// Which neighbours pass light to each other.
#[derive(Debug, Default)]
pub struct Links {
    stride: usize,
    /// 1 where this cell and the one to the right, or below, are both open; once for each of what a
    /// cell holds, so that vectors need no shuffling.
    right: Vec<Cell>,
    below: Vec<Cell>,
}

impl Links {
    /// Reads a frame of cells.
    pub fn prepare(&mut self, kinds: &[Kind], stride: usize) {
        self.stride = stride;
        for (links, offset) in [(&mut self.right, 1), (&mut self.below, stride)] {
            links.resize(kinds.len(), [0.0; 4]);
            links.par_iter_mut().with_min_len(TOGETHER).enumerate().for_each(|(i, link)| {
                let after = kinds.get(i + offset).copied().unwrap_or(Kind::Outside);
                *link = [f32::from(is_open(kinds[i]) && is_open(after)); 4];
            });
        }
    }
}

/// The energy of every cell, laid out as the frame of the ground.
#[derive(Debug, Default)]
pub struct Energy(Vec<Cell>);

impl Energy {
    /// So many cells, all dark.
    pub fn clear(&mut self, cells: usize) {
        self.0.clear();
        self.0.resize(cells, [0.0; 4]);
    }

    /// Takes some light from every cell, and all of it from those that are no longer open.
    pub fn decay(&mut self, kinds: &[Kind], decay: f32) {
        self.0.par_iter_mut().with_min_len(TOGETHER).zip(kinds).for_each(|(cell, &kind)| {
            *cell = if is_open(kind) { cell.map(|v| (v - decay).max(0.0)) } else { [0.0; 4] };
        });
    }

    /// A ray leaves its mark: the brighter colour stays, energy becomes the mean of old and new.
    #[inline(always)]
    pub fn deposit(&mut self, cell: usize, color: Rgb, energy: f32) {
        let cell = &mut self.0[cell];
        for c in 0..3 {
            cell[c] = cell[c].max(color[c] * energy);
        }
        cell[3] = 0.5 * (cell[3] + energy);
    }

    /// Light of a cell.
    #[inline(always)]
    pub fn color(&self, cell: usize) -> Rgb {
        let [r, g, b, _] = self.0[cell];
        [r, g, b]
    }

    /// Energy of a cell.
    pub fn energy(&self, cell: usize) -> f32 {
        self.0[cell][3]
    }

    /// Becomes `from` with every cell moved towards its neighbours, the one before and the one after
    /// along an axis, by a share of the difference to each: `c + Σ share·(n − c)`. Walls neither give
    /// nor take.
    pub fn mix(
        &mut self,
        level: Level,
        from: &Self,
        links: &Links,
        vertical: bool,
        shares: [f32; 2],
    ) {
        let stride = links.stride;
        let (link, offset) = if vertical { (&links.below, stride) } else { (&links.right, 1) };
        let link = link.as_flattened();
        let kernel = Kernel {
            from: from.0.as_flattened(),
            link,
            offset: 4 * offset,
            stride: 4 * stride,
            shares,
        };
        let rows = (TOGETHER / stride).max(1);
        // The frame's own rows stay dark.
        let inner = stride..self.0.len() - stride;
        self.0[inner].par_chunks_mut(rows * stride).enumerate().for_each(|(band, to)| {
            let first = 1 + band * rows;
            dispatch!(level, simd => kernel.mix(simd, first, to.as_flattened_mut()));
        });
    }
}

/// One pass over some rows; everything in numbers, four a cell.
struct Kernel<'a> {
    from: &'a [f32],
    link: &'a [f32],
    offset: usize,
    stride: usize,
    shares: [f32; 2],
}

impl Kernel<'_> {
    #[inline(always)]
    fn mix<S: Simd>(&self, simd: S, first: usize, to: &mut [f32]) {
        for (row, to) in to.chunks_exact_mut(self.stride).enumerate() {
            // Within the frame's columns; what is over at the end of a row is dark and has no links.
            for x in (4..self.stride - 4).step_by(LANES) {
                let i = (first + row) * self.stride + x;
                let load = |plane: &[f32], i: usize| f32x16::from_slice(simd, &plane[i..i + LANES]);
                let own = load(self.from, i);
                let before = load(self.link, i - self.offset) * self.shares[0];
                let after = load(self.link, i) * self.shares[1];
                let to_before = before * (load(self.from, i - self.offset) - own);
                let to_after = after * (load(self.from, i + self.offset) - own);
                // The sum of the two first: mirrored scenes give the same bits.
                (own + (to_before + to_after)).store_slice(&mut to[x..x + LANES]);
            }
        }
    }
}
