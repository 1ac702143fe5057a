//! What a ray meets, cell by cell: the grid of matter made ready for marching.

use crate::settings::Raymarch;
use crate::stages::bounce::Surfaces;
use crate::stages::distance::MARGIN;
use crate::stages::seed::is_occupied;
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
    /// px that a ray anywhere in the cell may leap in any direction and meet nothing; 0 where a
    /// ray has to go cell by cell.
    pub clearance: f32,
    /// What the cell is.
    pub kind: Kind,
    /// Whether its matter changed since the frame before.
    pub changed: bool,
}

/// The grid as rays see it.
#[derive(Debug, Default)]
pub struct Optics {
    pub width: i32,
    pub height: i32,
    pub sites: Vec<Site>,
    /// Emission, and what fog sends on.
    pub source: Vec<Rgb>,
    /// Natural logarithm of the transmittance of one px.
    pub log_transmittance: Vec<Rgb>,
    pub sky: Sky,
}

/// Logarithm that stands for "lets nothing through"; finite, so that 0 px of it still pass light.
const LOG_OF_ZERO: f32 = -1e4;

impl Optics {
    /// Reads the grid; `changed` is empty or marks the cells that changed since the last frame.
    pub fn prepare(
        &mut self,
        cells: &Cells,
        settings: &Raymarch,
        distance: &[f32],
        changed: &[bool],
    ) {
        self.width = cells.width() as i32;
        self.height = cells.height() as i32;
        self.sky = cells.sky();
        let (n, w) = (cells.len(), cells.width() as usize);
        self.sites.resize(n, Site::default());
        self.source.resize(n, Rgb::default());
        self.log_transmittance.resize(n, Rgb::default());
        self.sites
            .par_chunks_mut(w)
            .zip(self.source.par_chunks_mut(w))
            .zip(self.log_transmittance.par_chunks_mut(w))
            .enumerate()
            .for_each(|(y, ((sites, sources), logs))| {
                for x in 0..w {
                    let i = y * w + x;
                    let kind = match () {
                        () if cells.is_solid(i) => Kind::Solid,
                        () if is_occupied(cells, i, settings.threshold) => Kind::Medium,
                        () => Kind::Clear,
                    };
                    let clearance = (distance[i] - MARGIN).clamp(0.0, 1e6);
                    let changed = changed.get(i).copied().unwrap_or(false);
                    sites[x] = Site { clearance, kind, changed };
                    sources[x] = cells.emission()[i].map(|e| e * settings.emission_multiplier);
                    if kind == Kind::Medium {
                        let keep = 1.0 - cells.opacity()[i];
                        logs[x] = cells.tint()[i].map(|t| (keep * t).ln().max(LOG_OF_ZERO));
                    }
                }
            });
    }

    /// Sets what fog sends out: emission and what it sends on.
    pub fn light_fog(&mut self, cells: &Cells, settings: &Raymarch, surfaces: &Surfaces) {
        for (&i, sent) in surfaces.fog.iter().zip(&surfaces.fog_sent) {
            let (i, m) = (i as usize, settings.emission_multiplier);
            self.source[i] = std::array::from_fn(|c| cells.emission()[i][c] * m + sent[c]);
        }
    }
}

/// `e^x` for x ≤ 0, with a relative error under 3e-7: 2^n by the exponent bits, 2^f by a
/// polynomial of degree 6 (Taylor, |f| ≤ ½).
#[inline]
pub fn exp_negative(x: f32) -> f32 {
    let t = (x * std::f32::consts::LOG2_E).max(-126.0);
    let n = (t - 0.5) as i32; // rounds to nearest, as t ≤ 0
    let f = (t - n as f32) * std::f32::consts::LN_2;
    let p = 1.0 / 720.0;
    let p = p * f + 1.0 / 120.0;
    let p = p * f + 1.0 / 24.0;
    let p = p * f + 1.0 / 6.0;
    let p = p * f + 0.5;
    let p = p * f + 1.0;
    let p = p * f + 1.0;
    p * f32::from_bits(((n + 127) as u32) << 23)
}

#[cfg(test)]
mod tests {
    use super::exp_negative;

    #[test]
    fn exp_negative_is_exact_to_rounding() {
        for i in 0..=200_000 {
            let x = -(i as f32) * 4e-4;
            let (got, want) = (f64::from(exp_negative(x)), f64::from(x).exp());
            assert!((got / want - 1.0).abs() < 4e-6 * (1.0 + f64::from(-x)), "{x}: {got} {want}");
        }
        assert_eq!(exp_negative(0.0), 1.0);
        assert!(exp_negative(-1e4) < 1e-37);
    }
}
