//! The grid of energy, and the mixing of neighbours.

use crate::Rgb;
use crate::grid::cast::LANES;
use crate::grid::medium_grid::MediumGrid;
use crate::simd::dispatch;
use fearless_simd::{Level, f32x16, prelude::*};
use rayon::prelude::*;

/// The contents of a cell: red, green, blue, energy.
type Cell = [f32; 4];
/// About the number of cells that a thread takes at a time: small grids are not worth a second
/// thread.
const TOGETHER: usize = 1 << 14;

/// The layout of cells in memory: a dark cell round the grid on all sides, and rows of whole vectors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EnergyLayout {
    width: usize,
    height: usize,
    stride: usize,
}

impl EnergyLayout {
    /// Lays out a grid.
    pub fn new(grid: &MediumGrid) -> Self {
        let [width, height] = grid.size.map(|side| side as usize);
        Self { width, height, stride: width.next_multiple_of(LANES) + 2 }
    }

    /// Returns the number of cells, with those round the grid.
    pub fn cells(&self) -> usize {
        self.stride * (self.height + 2)
    }

    /// Returns the index of a cell.
    #[inline(always)]
    pub fn index(&self, [x, y]: [i32; 2]) -> usize {
        (y + 1) as usize * self.stride + (x + 1) as usize
    }
}

/// The pairs of neighbours that exchange light.
#[derive(Debug, Default)]
pub struct Links {
    frame: EnergyLayout,
    /// 1 if this cell and the one to the right, or below, are both open; repeated for each number of
    /// a cell, so that vectors need no shuffling.
    right: Vec<Cell>,
    below: Vec<Cell>,
}

impl Links {
    /// Reads the grid.
    pub fn prepare(&mut self, grid: &MediumGrid) {
        self.frame = EnergyLayout::new(grid);
        let Self { frame, right, below } = self;
        for (links, [dx, dy]) in [(right, [1, 0]), (below, [0, 1])] {
            links.resize(frame.cells(), [0.0; 4]);
            let rows = links.par_chunks_mut(frame.stride).with_min_len(TOGETHER / frame.stride + 1);
            rows.enumerate().for_each(|(row, links)| {
                for (column, link) in links.iter_mut().enumerate() {
                    let [x, y] = [column as i32 - 1, row as i32 - 1];
                    let is_open = |cell| grid.class(cell).is_open();
                    *link = [f32::from(is_open([x, y]) && is_open([x + dx, y + dy])); 4];
                }
            });
        }
    }

    /// Returns the layout.
    pub fn frame(&self) -> EnergyLayout {
        self.frame
    }
}

/// The energy of every cell.
#[derive(Debug, Default)]
pub struct Energy(Vec<Cell>);

impl Energy {
    /// Sets a number of cells to dark.
    pub fn clear(&mut self, cells: usize) {
        self.0.clear();
        self.0.resize(cells, [0.0; 4]);
    }

    /// Becomes `from` in a grid that has moved by so many cells, to the right and down; cells that come in are dark.
    pub fn shift(&mut self, from: &Self, frame: EnergyLayout, moved: [i32; 2]) {
        self.0.fill([0.0; 4]);
        let [columns, rows] =
            [(frame.width, moved[0]), (frame.height, moved[1])].map(|(side, by)| {
                let side = side as i32;
                by.saturating_neg().clamp(0, side)..side.saturating_sub(by).clamp(0, side)
            });
        if columns.is_empty() {
            return;
        }
        for y in rows {
            let to = frame.index([columns.start, y]);
            let start = frame.index([columns.start + moved[0], y + moved[1]]);
            self.0[to..][..columns.len()].copy_from_slice(&from.0[start..][..columns.len()]);
        }
    }

    /// Takes some light from every cell, and all light from cells that are no longer open.
    pub fn decay(&mut self, grid: &MediumGrid, frame: EnergyLayout, decay: f32) {
        let rows = self.0.par_chunks_mut(frame.stride).with_min_len(TOGETHER / frame.stride + 1);
        rows.enumerate().for_each(|(row, cells)| {
            for (column, cell) in cells.iter_mut().enumerate() {
                let is_open = grid.class([column as i32 - 1, row as i32 - 1]).is_open();
                *cell = if is_open { cell.map(|v| (v - decay).max(0.0)) } else { [0.0; 4] };
            }
        });
    }

    /// Adds a ray to a cell: the brighter colour stays, energy becomes the mean of old and new.
    #[inline(always)]
    pub fn deposit(&mut self, cell: usize, color: Rgb, energy: f32) {
        let cell = &mut self.0[cell];
        for c in 0..3 {
            cell[c] = cell[c].max(color[c] * energy);
        }
        cell[3] = 0.5 * (cell[3] + energy);
    }

    /// Returns the light of a cell.
    #[inline(always)]
    pub fn color(&self, cell: usize) -> Rgb {
        let [r, g, b, _] = self.0[cell];
        [r, g, b]
    }

    /// Returns the energy of a cell.
    pub fn energy(&self, cell: usize) -> f32 {
        self.0[cell][3]
    }

    /// Becomes `from` with every cell moved towards its neighbours, the one before and the one after
    /// along an axis, by a fraction of the difference to each: `c + Σ w·(n − c)`. Walls exchange
    /// nothing.
    pub fn mix(
        &mut self,
        level: Level,
        from: &Self,
        links: &Links,
        vertical: bool,
        weights: [f32; 2],
    ) {
        let stride = links.frame.stride;
        let (link, offset) = if vertical { (&links.below, stride) } else { (&links.right, 1) };
        let link = link.as_flattened();
        let kernel = Kernel {
            from: from.0.as_flattened(),
            link,
            offset: 4 * offset,
            stride: 4 * stride,
            weights,
        };
        let rows = (TOGETHER / stride).max(1);
        // The rows round the grid stay dark.
        let inner = stride..self.0.len() - stride;
        self.0[inner].par_chunks_mut(rows * stride).enumerate().for_each(|(band, to)| {
            let first = 1 + band * rows;
            dispatch!(level, simd => kernel.mix(simd, first, to.as_flattened_mut()));
        });
    }
}

/// One pass over some rows, on numbers: four per cell.
struct Kernel<'a> {
    from: &'a [f32],
    link: &'a [f32],
    offset: usize,
    stride: usize,
    weights: [f32; 2],
}

impl Kernel<'_> {
    #[inline(always)]
    fn mix<S: Simd>(&self, simd: S, first: usize, to: &mut [f32]) {
        for (row, to) in to.chunks_exact_mut(self.stride).enumerate() {
            // Within the columns round the grid; the end of a row is dark and has no links.
            for x in (4..self.stride - 4).step_by(LANES) {
                let i = (first + row) * self.stride + x;
                let load = |plane: &[f32], i: usize| f32x16::from_slice(simd, &plane[i..i + LANES]);
                let own = load(self.from, i);
                let before = load(self.link, i - self.offset) * self.weights[0];
                let after = load(self.link, i) * self.weights[1];
                let to_before = before * (load(self.from, i - self.offset) - own);
                let to_after = after * (load(self.from, i + self.offset) - own);
                // The sum of the two first: mirrored scenes give the same bits.
                (own + (to_before + to_after)).store_slice(&mut to[x..x + LANES]);
            }
        }
    }
}
