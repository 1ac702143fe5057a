//! What a ray meets, cell by cell: the grid of matter made ready for marching.

use super::bounce::Surfaces;
use super::clearance::{Ground, clearance};
use super::seed::is_occupied;
use super::transmittance::log_transmittance;
use crate::{Cells, Rgb, Sky};
use rayon::prelude::*;

/// What a cell is to a ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// Nothing in the way.
    #[default]
    Clear,
    /// Fog, smoke, glass.
    Medium,
    /// A wall.
    Solid,
}

/// One cell's part in the march.
#[derive(Clone, Copy, Debug, Default)]
pub struct Site {
    /// What the cell is.
    pub kind: Kind,
    /// Whether its matter changed since the frame before, or, in fog, what it sees.
    pub changed: bool,
}

/// How the grid is read.
#[derive(Clone, Copy, Debug)]
pub struct Reading {
    /// Opacity up to which a cell counts as empty.
    pub threshold: f32,
    /// Multiplies all emission.
    pub multiplier: f32,
    /// Whether emission fades with distance, which is worked out ray by ray.
    pub fades: bool,
}

impl Default for Reading {
    fn default() -> Self {
        Self { threshold: 0.0, multiplier: 1.0, fades: false }
    }
}

/// The grid as rays see it.
#[derive(Debug, Default)]
pub struct Optics {
    pub width: i32,
    pub height: i32,
    pub sites: Vec<Site>,
    pub ground: Vec<Ground>,
    /// Squares of the same matter ([`clearance`]).
    pub squares: Vec<u8>,
    /// Emission, and what fog sends on.
    pub source: Vec<Rgb>,
    /// Natural logarithm of the transmittance of one px.
    pub log_transmittance: Vec<Rgb>,
    /// Whether any matter tints.
    pub tints: bool,
    pub sky: Sky,
}

impl Optics {
    /// Reads the grid; `changed` is empty or marks the cells that changed since the last frame.
    pub fn prepare(&mut self, cells: &Cells, reading: Reading, changed: &[bool]) {
        self.width = cells.width() as i32;
        self.height = cells.height() as i32;
        self.sky = cells.sky();
        let (n, w) = (cells.len(), cells.width() as usize);
        self.sites.resize(n, Site::default());
        self.ground.resize(n, Ground::default());
        self.source.resize(n, Rgb::default());
        self.log_transmittance.resize(n, Rgb::default());
        self.sites
            .par_chunks_mut(w)
            .zip(self.ground.par_chunks_mut(w))
            .zip(self.source.par_chunks_mut(w))
            .zip(self.log_transmittance.par_chunks_mut(w))
            .enumerate()
            .for_each(|(y, (((sites, ground), sources), logs))| {
                for x in 0..w {
                    let i = y * w + x;
                    let kind = match () {
                        () if cells.is_solid(i) => Kind::Solid,
                        () if is_occupied(cells, i, reading.threshold) => Kind::Medium,
                        () => Kind::Clear,
                    };
                    let changed = changed.get(i).copied().unwrap_or(false);
                    sites[x] = Site { kind, changed };
                    ground[x] = match kind {
                        _ if changed => Ground::Closed,
                        Kind::Solid => Ground::Closed,
                        Kind::Medium if reading.fades => Ground::Closed,
                        Kind::Medium => Ground::Matter,
                        Kind::Clear => Ground::Clear,
                    };
                    sources[x] = cells.emission()[i].map(|e| e * reading.multiplier);
                    if kind == Kind::Medium {
                        logs[x] = log_transmittance(cells.opacity()[i], cells.tint()[i]);
                    }
                }
            });
        self.tints = cells.tint().iter().any(|t| t[1] != t[0] || t[2] != t[0]);
        self.find_squares();
    }

    fn find_squares(&mut self) {
        let Self { ground, squares, source, log_transmittance, .. } = self;
        let alike = |i: usize, j: usize| {
            source[i] == source[j] && log_transmittance[i] == log_transmittance[j]
        };
        clearance(self.width as u32, ground, alike, squares);
    }

    /// Has rays look at a cell of fog that sees a change; [`Self::light_fog`] has to follow.
    pub fn mark_changed(&mut self, fog: usize) {
        self.sites[fog].changed = true;
        self.ground[fog] = Ground::Closed;
    }

    /// Sets what fog sends out: emission and what it sends on.
    pub fn light_fog(&mut self, cells: &Cells, reading: Reading, surfaces: &Surfaces) {
        for (&i, sent) in surfaces.fog.iter().zip(&surfaces.fog_sent) {
            let (i, m) = (i as usize, reading.multiplier);
            self.source[i] = std::array::from_fn(|c| cells.emission()[i][c] * m + sent[c]);
        }
        if !surfaces.fog.is_empty() {
            self.find_squares();
        }
    }
}
