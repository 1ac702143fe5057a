//! The prepared grid: class, extinction and emitted radiance per cell, as every method reads it.

use super::class::CellClass;
use super::empty_space::EmptySpace;
use crate::math::transmittance::extinction;
use crate::{Cells, Inflow, Rgb, Sky, inflow};
use rayon::prelude::*;

/// The rules by which cells are classed.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// Opacity up to which a cell counts as empty.
    pub threshold: f32,
    /// If false, media count as solid.
    pub translucent: bool,
}

impl Default for Reading {
    fn default() -> Self {
        Self { threshold: 0.0, translucent: true }
    }
}

/// The grid as rays read it, in row order.
#[derive(Debug, Default)]
pub struct MediumGrid {
    /// Columns and rows.
    pub size: [i32; 2],
    pub classes: Vec<CellClass>,
    /// Extinction σ_t of media, per px; empty without media, unspecified in other cells.
    pub extinction: Vec<Rgb>,
    /// True if the extinction of any medium differs by channel.
    pub tints: bool,
    /// Source radiance: emitted, and scattered by media. Filled by [`Self::read_emission`].
    pub source: Vec<Rgb>,
    /// Filled by [`Self::measure_empty_space`].
    pub empty_space: EmptySpace,
    sky: Sky,
    /// In place of the sky, if there is one.
    inflow: Option<Inflow>,
}

impl MediumGrid {
    /// Reads classes, extinction and the sky.
    pub fn read(&mut self, cells: &Cells, reading: Reading) {
        let w = cells.width() as usize;
        self.size = [cells.width() as i32, cells.height() as i32];
        self.sky.clone_from(cells.sky());
        self.inflow = cells.inflow().cloned();
        self.classes.resize(cells.len(), CellClass::Empty);
        let rows = self.classes.par_chunks_mut(w).enumerate().map(|(y, classes)| {
            for (x, class) in classes.iter_mut().enumerate() {
                *class = CellClass::of(cells, y * w + x, reading.threshold);
                if *class == CellClass::Medium && !reading.translucent {
                    *class = CellClass::Solid;
                }
            }
            classes.contains(&CellClass::Medium)
        });
        let media = rows.reduce(|| false, |a, b| a | b);
        self.extinction.resize(if media { cells.len() } else { 0 }, Rgb::default());
        let rows = self.extinction.par_chunks_mut(w).zip(self.classes.par_chunks(w)).enumerate();
        let tints = rows.map(|(y, (row, classes))| {
            let mut tints = false;
            for x in (0..w).filter(|&x| classes[x] == CellClass::Medium) {
                let i = y * w + x;
                row[x] = extinction(cells.opacity()[i], cells.tint()[i]);
                tints |= row[x] != [row[x][0]; 3];
            }
            tints
        });
        self.tints = tints.reduce(|| false, |a, b| a | b);
    }

    /// Reads emitted radiance, times `multiplier`.
    pub fn read_emission(&mut self, cells: &Cells, multiplier: f32) {
        let w = cells.width() as usize;
        self.source.resize(cells.len(), Rgb::default());
        let rows = self.source.par_chunks_mut(w).zip(cells.emission().par_chunks(w));
        rows.for_each(|(source, emission)| {
            for (source, emission) in source.iter_mut().zip(emission) {
                *source = emission.map(|e| e * multiplier);
            }
        });
    }

    /// Measures the empty space between cells that stop packets: solid ones, and those for which
    /// `stops` holds.
    pub fn measure_empty_space(&mut self, stops: impl Fn(usize, CellClass) -> bool) {
        let Self { size, classes, extinction, source, empty_space, .. } = self;
        let class = |i: usize| if stops(i, classes[i]) { CellClass::Solid } else { classes[i] };
        let same = |i: usize, j: usize| source[i] == source[j] && extinction[i] == extinction[j];
        empty_space.measure(size[0] as u32, (0..classes.len()).map(class), same);
    }

    /// Returns the radiance that enters along a ray, which leaves the grid and passes `at`.
    #[inline]
    pub fn entering(&self, at: [f32; 2], direction: [f32; 2]) -> Rgb {
        match &self.inflow {
            None => self.sky.radiance(direction),
            Some(inflow) => inflow.radiance(self.exit(at, direction), direction),
        }
    }

    /// Returns the mean radiance of the sky between two angles; 0 if there is an inflow in place of it.
    pub fn sky_mean(&self, [from, to]: [f64; 2]) -> Rgb {
        if self.inflow.is_some() { Rgb::default() } else { self.sky.mean(from, to) }
    }

    /// Returns the light that enters, if it is not that of the sky.
    #[inline]
    pub fn inflow(&self) -> Option<&Inflow> {
        self.inflow.as_ref()
    }

    /// Returns where a straight line that passes `at` leaves the grid for good.
    pub fn exit(&self, at: [f32; 2], direction: [f32; 2]) -> [f32; 2] {
        inflow::exit(self.size.map(|side| side as f32), at, direction)
    }

    /// Returns whether there are media.
    pub fn has_media(&self) -> bool {
        !self.extinction.is_empty()
    }

    /// Returns the row-order index of a cell of the grid.
    #[inline(always)]
    pub fn index(&self, [x, y]: [i32; 2]) -> usize {
        (y * self.size[0] + x) as usize
    }

    /// Returns the cell at a row-order index.
    pub fn cell(&self, index: usize) -> [i32; 2] {
        let index = index as i32;
        [index % self.size[0], index / self.size[0]]
    }

    /// Returns whether a cell lies in the grid.
    #[inline(always)]
    pub fn holds(&self, [x, y]: [i32; 2]) -> bool {
        (x as u32) < self.size[0] as u32 && (y as u32) < self.size[1] as u32
    }

    /// Returns the class of any cell, [`CellClass::Outside`] beyond the edge.
    #[inline(always)]
    pub fn class(&self, cell: [i32; 2]) -> CellClass {
        if self.holds(cell) { self.classes[self.index(cell)] } else { CellClass::Outside }
    }

    /// Returns whether a point lies in the grid.
    pub fn contains(&self, at: [f32; 2]) -> bool {
        (0..2).all(|a| (0.0..self.size[a] as f32).contains(&at[a]))
    }

    /// Returns whether two cells, by index, touch by a side or a corner or are the same; false for
    /// `u32::MAX`.
    pub fn touch(&self, a: u32, b: u32) -> bool {
        if a == u32::MAX || b == u32::MAX {
            return false;
        }
        let ([ax, ay], [bx, by]) = (self.cell(a as usize), self.cell(b as usize));
        ax.abs_diff(bx) <= 1 && ay.abs_diff(by) <= 1
    }
}
