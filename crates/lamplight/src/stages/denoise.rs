//! Edge-aware blur: the à-trous wavelet transform (Dammertz et al. 2010), with the range of light
//! taken from the variance of its noise (Schied et al. 2017).
//!
//! Each pass blurs with a 5×5 B-spline kernel whose taps lie twice as far apart as before. A tap
//! counts by `exp(−|ΔL| / (2·strength·σ))`, with σ the standard deviation of the noise there, and by
//! `exp(−8·|Δα|)` for opacity; and not at all where the straight line to it meets a solid cell. That
//! is read off clear squares ([`super::clearance`]) or, near walls, walked cell by cell, so light
//! never leaks through a wall however thin. Solid cells keep their light.
//!
//! The method says how noisy each cell is, from neighbouring rays, so that real gradients and
//! edges are not taken for noise: light without noise stays as it is.

use super::clearance::{Ground, clearance, quadrant, side};
use super::traced::Traced;
use crate::settings;
use crate::srgb::luminance;
use crate::{Cells, Rgb};
use rayon::prelude::*;

/// B-spline weights by distance in taps.
pub const KERNEL: [f32; 3] = [3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0];
/// Differences in light count against this many standard deviations of the noise: of 1 to 4 the one
/// with the least error over the example scenes.
pub const DEVIATIONS: f32 = 2.0;
/// How fast a difference in opacity ends the blur.
pub const OPACITY: f32 = 8.0;

/// Buffers of the passes.
#[derive(Debug, Default)]
pub struct Denoise {
    ground: Vec<Ground>,
    squares: Vec<u8>,
    noisy: Vec<Noisy>,
    blurred: Vec<Noisy>,
}

/// Light and the variance of its luminance.
#[derive(Clone, Copy, Debug, Default)]
struct Noisy {
    light: Rgb,
    variance: f32,
}

impl Denoise {
    /// Blurs the light of open cells in place.
    pub fn denoise(&mut self, settings: &settings::Denoise, cells: &Cells, traced: &mut Traced) {
        let Traced { light, variance, .. } = traced;
        let ground = |i| if cells.is_solid(i) { Ground::Closed } else { Ground::Clear };
        self.ground.clear();
        self.ground.extend((0..cells.len()).map(ground));
        clearance(cells.width(), &self.ground, |_, _| false, &mut self.squares);
        self.noisy.resize(light.len(), Noisy::default());
        self.blurred.resize(light.len(), Noisy::default());
        self.estimate(cells, variance, light);
        for pass in 0..settings.passes {
            self.pass(settings, cells, 1 << pass);
            std::mem::swap(&mut self.noisy, &mut self.blurred);
        }
        light.iter_mut().zip(&self.noisy).for_each(|(light, noisy)| *light = noisy.light);
    }

    /// Smooths the variance, itself an estimate from few rays, over the cells that a cell sees.
    fn estimate(&mut self, cells: &Cells, variance: &[f32], light: &[Rgb]) {
        let mut noisy = std::mem::take(&mut self.noisy);
        let view = self.view(cells);
        noisy.par_iter_mut().enumerate().for_each(|(i, noisy)| {
            let (mut sum, mut weight) = (0.0, f32::MIN_POSITIVE);
            if self.ground[i] == Ground::Clear {
                view.taps(i, 1, |j, kernel| {
                    (sum, weight) = (sum + kernel * variance[j], weight + kernel);
                });
            }
            *noisy = Noisy { light: light[i], variance: sum / weight };
        });
        self.noisy = noisy;
    }

    fn pass(&mut self, settings: &settings::Denoise, cells: &Cells, spread: i32) {
        let mut blurred = std::mem::take(&mut self.blurred);
        let view = self.view(cells);
        blurred.par_iter_mut().enumerate().for_each(|(i, blurred)| {
            let here = self.noisy[i];
            *blurred = here;
            if self.ground[i] == Ground::Closed {
                return;
            }
            let l = luminance(here.light);
            let range = DEVIATIONS * settings.strength * here.variance.sqrt() + f32::MIN_POSITIVE;
            let (mut light, mut variance, mut weight) = ([0.0f32; 3], 0.0f32, 0.0f32);
            view.taps(i, spread, |j, kernel| {
                let there = self.noisy[j];
                let difference = (luminance(there.light) - l).abs() / range
                    + OPACITY * (cells.opacity()[j] - cells.opacity()[i]).abs();
                let w = kernel * (-difference).exp();
                (0..3).for_each(|c| light[c] += w * there.light[c]);
                variance += w * w * there.variance;
                weight += w;
            });
            *blurred =
                Noisy { light: light.map(|v| v / weight), variance: variance / (weight * weight) };
        });
        self.blurred = blurred;
    }

    fn view<'a>(&'a self, cells: &Cells) -> View<'a> {
        let size = [cells.width() as i32, cells.height() as i32];
        View { size, ground: &self.ground, squares: &self.squares }
    }
}

/// Which cells see one another.
struct View<'a> {
    size: [i32; 2],
    ground: &'a [Ground],
    squares: &'a [u8],
}

impl View<'_> {
    /// Calls `each` with the index and the kernel weight of every tap that cell `i` sees, itself
    /// included.
    #[inline]
    fn taps(&self, i: usize, spread: i32, mut each: impl FnMut(usize, f32)) {
        let [w, h] = self.size;
        let (x, y) = (i as i32 % w, i as i32 / w);
        for ky in -2i32..=2 {
            for kx in -2i32..=2 {
                let offset = [kx * spread, ky * spread];
                let (tx, ty) = (x + offset[0], y + offset[1]);
                if (0..w).contains(&tx) && (0..h).contains(&ty) && self.sees([x, y], offset) {
                    let kernel =
                        KERNEL[kx.unsigned_abs() as usize] * KERNEL[ky.unsigned_abs() as usize];
                    each((ty * w + tx) as usize, kernel);
                }
            }
        }
    }

    /// Whether the line between the centres of two cells meets no solid cell.
    fn sees(&self, from: [i32; 2], offset: [i32; 2]) -> bool {
        let length = offset[0].abs().max(offset[1].abs());
        let index = (from[1] * self.size[0] + from[0]) as usize;
        let plane = quadrant(offset.map(|o| o as f32)) * self.ground.len();
        length < side(self.squares[plane + index]) || self.walk(from, offset)
    }

    /// Goes from cell to cell along the line; a corner between two solid cells blocks it.
    fn walk(&self, from: [i32; 2], offset: [i32; 2]) -> bool {
        let open = |x: i32, y: i32| self.ground[(y * self.size[0] + x) as usize] == Ground::Clear;
        let count = offset.map(i32::abs);
        let sign = offset.map(i32::signum);
        let ([mut x, mut y], mut done) = (from, [0, 0]);
        while done != count {
            let next = (1 + 2 * done[0]) * count[1] - (1 + 2 * done[1]) * count[0];
            if next == 0 && !open(x + sign[0], y) && !open(x, y + sign[1]) {
                return false;
            }
            if next <= 0 {
                (x, done[0]) = (x + sign[0], done[0] + 1);
            }
            if next >= 0 {
                (y, done[1]) = (y + sign[1], done[1] + 1);
            }
            if !open(x, y) {
                return false;
            }
        }
        true
    }
}
