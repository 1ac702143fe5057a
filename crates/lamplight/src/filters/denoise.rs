//! Edge-aware blur: the à-trous wavelet transform (Dammertz et al. 2010), with the range of light
//! taken from the variance of its noise (Schied et al. 2017).
//!
//! Each pass blurs with a 5×5 B-spline kernel whose taps lie twice as far apart as before. A tap
//! counts by `exp(−|ΔL| / (2·strength·σ))`, with σ the standard deviation of the noise there, and by
//! `exp(−8·|ΔT|)`, with T the transmittance of a px in the channel in which it differs most, so that panes of glass and
//! banks of fog keep their edges; and not at all where the straight line to it meets a solid cell. That
//! is read off empty squares ([`crate::grid::empty_space`]) or, near walls, cell by cell, so light
//! does not leak through walls of any thickness. In the first pass 6 takes the place of 2
//! ([`WIDE_DEVIATIONS`]).
//!
//! Cells of a wall are blurred along it in the first passes, together with those that are open to the same side alone. All
//! other solid cells keep their light.
//!
//! The method estimates the noise of each cell from neighbouring rays, so that real gradients and
//! edges are not taken for noise: light without noise stays as it is.

use super::estimate::Estimate;
use crate::grid::center_line::{Piece, center_line};
use crate::grid::class::CellClass;
use crate::grid::empty_space::{EmptySpace, quadrant, side};
use crate::settings;
use crate::srgb::luminance;
use crate::{Cells, Moment, Rgb};
use rayon::prelude::*;

/// B-spline weights by distance in taps.
pub const KERNEL: [f32; 3] = [3.0 / 8.0, 1.0 / 4.0, 1.0 / 16.0];
/// Differences in light count against this many standard deviations of the noise: of 1 to 4 the one
/// with the least error over the example scenes.
pub const DEVIATIONS: f32 = 2.0;
/// Likewise in the first pass, and along walls. Of a small light far away most pixels see nothing and a few too much; if
/// those did not count, its light would be too dark, and the pattern of its noise would stay.
pub const WIDE_DEVIATIONS: f32 = 6.0;
/// The rate at which a difference in transmittance ends the blur.
pub const TRANSMITTANCE: f32 = 8.0;

/// The widest spread of taps along walls, px: shadows on walls are to have edges.
pub const WALL_SPREAD: usize = 4;
/// The distance along walls from which the noise is known, px: within it some faces see such a light.
pub const WALL_REACH: usize = 12;

/// Taps of the kernel along each axis.
const TAPS: usize = 5;

/// Buffers of the passes.
#[derive(Debug, Default)]
pub struct Denoiser {
    empty_space: EmptySpace,
    /// The transmittance of a px of each cell; empty if there are no media.
    transmittance: Vec<Rgb>,
    taps: [Tap; TAPS * TAPS],
    noisy: Vec<Noisy>,
    blurred: Vec<Noisy>,
    moment: Vec<Moment>,
    blurred_moment: Vec<Moment>,
}

/// A tap of the kernel.
#[derive(Debug, Default)]
struct Tap {
    /// Columns and rows to it.
    offset: [i32; 2],
    weight: f32,
    /// The line of sight to it, as index offsets: it is blocked at a pair of cells of which both are
    /// solid. A cell on the line is paired with itself, cells beside a corner with each other.
    line: Vec<[isize; 2]>,
}

/// Light and the variance of its luminance.
#[derive(Clone, Copy, Debug, Default)]
struct Noisy {
    light: Rgb,
    variance: f32,
}

impl Denoiser {
    /// Blurs the light of all cells in place.
    pub fn denoise(
        &mut self,
        settings: &settings::Denoise,
        cells: &Cells,
        estimate: &mut Estimate,
    ) {
        let Estimate { light, moment, variance, .. } = estimate;
        // Media do not block.
        let class = |i| if cells.is_solid(i) { CellClass::Solid } else { CellClass::Empty };
        let classes = (0..cells.len()).map(class);
        self.empty_space.measure(cells.width(), classes, |_, _| false);
        self.find_transmittance(cells);
        self.noisy.resize(light.len(), Noisy::default());
        self.blurred.resize(light.len(), Noisy::default());
        self.moment.clear();
        self.moment.extend(moment.iter().flatten());
        self.blurred_moment.clone_from(&self.moment);
        self.spread(cells, 1);
        self.smooth_variance(cells, variance, light);
        for pass in 0..settings.passes {
            self.spread(cells, 1 << pass);
            self.pass(settings, cells, 1 << pass);
            std::mem::swap(&mut self.noisy, &mut self.blurred);
            std::mem::swap(&mut self.moment, &mut self.blurred_moment);
        }
        if let Some(moment) = moment {
            moment.clone_from(&self.moment);
        }
        light.iter_mut().zip(&self.noisy).for_each(|(light, noisy)| *light = noisy.light);
    }

    fn find_transmittance(&mut self, cells: &Cells) {
        self.transmittance.clear();
        let is_medium = |i| CellClass::of(cells, i, 0.0) == CellClass::Medium;
        if (0..cells.len()).any(is_medium) {
            let of_cells = cells.opacity().iter().zip(cells.tint());
            let transmittance = of_cells.map(|(opacity, tint)| tint.map(|t| (1.0 - opacity) * t));
            self.transmittance.extend(transmittance);
        }
    }

    /// Sets the taps `spread` px apart.
    fn spread(&mut self, cells: &Cells, spread: i32) {
        let width = cells.width() as isize;
        let index = |[x, y]: [i32; 2]| y as isize * width + x as isize;
        for (i, tap) in self.taps.iter_mut().enumerate() {
            let [x, y] = [i % TAPS, i / TAPS].map(|k| k as i32 - TAPS as i32 / 2);
            tap.offset = [x * spread, y * spread];
            tap.weight = KERNEL[x.unsigned_abs() as usize] * KERNEL[y.unsigned_abs() as usize];
            tap.line.clear();
            tap.line.extend(center_line(tap.offset).map(|piece| match piece {
                Piece::Cross { at, .. } => [index(at); 2],
                Piece::Corner(beside) => beside.map(index),
            }));
        }
    }

    /// Smooths the variance, itself an estimate from few rays, over the cells that a cell sees, or along its wall.
    fn smooth_variance(&mut self, cells: &Cells, variance: &[f32], light: &[Rgb]) {
        let mut noisy = std::mem::take(&mut self.noisy);
        let (visible, walls) = (self.visibility(cells), self.walls(cells));
        noisy.par_iter_mut().enumerate().for_each(|(i, noisy)| {
            let (mut sum, mut weight) = (0.0, f32::MIN_POSITIVE);
            let mut add = |j: usize, kernel| {
                (sum, weight) = (sum + kernel * variance[j], weight + kernel);
            };
            if self.empty_space.is_solid(i) {
                walls.along(i, WALL_REACH, |j, _| add(j, 1.0));
            } else {
                visible.taps(i, add);
            }
            *noisy = Noisy { light: light[i], variance: sum / weight };
        });
        self.noisy = noisy;
    }

    fn pass(&mut self, settings: &settings::Denoise, cells: &Cells, spread: usize) {
        let mut blurred = std::mem::take(&mut self.blurred);
        let mut blurred_moment = std::mem::take(&mut self.blurred_moment);
        let (visible, walls) = (self.visibility(cells), self.walls(cells));
        let blur = |i: usize, blurred: &mut Noisy, moment: Option<&mut Moment>| {
            let here = self.noisy[i];
            *blurred = here;
            if self.empty_space.is_solid(i) {
                if spread <= WALL_SPREAD {
                    blurred.light = self.along_wall(settings, &walls, i, spread);
                }
                return;
            }
            let l = luminance(here.light);
            let deviations = if spread == 1 { WIDE_DEVIATIONS } else { DEVIATIONS };
            let range = deviations * settings.strength * here.variance.sqrt() + f32::MIN_POSITIVE;
            let (mut light, mut variance, mut weight) = ([0.0f32; 3], 0.0f32, 0.0f32);
            let mut sum = Moment::default();
            visible.taps(i, |j, kernel| {
                let there = self.noisy[j];
                let difference = (luminance(there.light) - l).abs() / range;
                let w = kernel * (-difference).exp();
                (0..3).for_each(|c| light[c] += w * there.light[c]);
                variance += w * w * there.variance;
                weight += w;
                if let Some(there) = self.moment.get(j) {
                    sum.as_flattened_mut()
                        .iter_mut()
                        .zip(there.as_flattened())
                        .for_each(|(sum, there)| *sum += w * there);
                }
            });
            if let Some(moment) = moment {
                *moment = sum.map(|part| part.map(|v| v / weight));
            }
            *blurred =
                Noisy { light: light.map(|v| v / weight), variance: variance / (weight * weight) };
        };
        if blurred_moment.is_empty() {
            blurred.par_iter_mut().enumerate().for_each(|(i, blurred)| blur(i, blurred, None));
        } else {
            let both = blurred.par_iter_mut().zip(&mut blurred_moment).enumerate();
            both.for_each(|(i, (blurred, moment))| blur(i, blurred, Some(moment)));
        }
        (self.blurred, self.blurred_moment) = (blurred, blurred_moment);
    }

    /// Returns the light of a solid cell, blurred along its wall.
    fn along_wall(
        &self,
        settings: &settings::Denoise,
        walls: &WallRuns,
        i: usize,
        spread: usize,
    ) -> Rgb {
        let here = self.noisy[i];
        let l = luminance(here.light);
        let range = WIDE_DEVIATIONS * settings.strength * here.variance.sqrt() + f32::MIN_POSITIVE;
        let (mut light, mut weight) = ([0.0f32; 3], 0.0f32);
        walls.along(i, 2 * spread, |j, away| {
            if away % spread == 0 {
                let there = self.noisy[j].light;
                let difference = (luminance(there) - l).abs() / range;
                let w = KERNEL[away / spread] * (-difference).exp();
                (0..3).for_each(|c| light[c] += w * there[c]);
                weight += w;
            }
        });
        light.map(|v| v / weight)
    }

    fn walls<'a>(&'a self, cells: &Cells) -> WallRuns<'a> {
        let size = [cells.width() as usize, cells.height() as usize];
        WallRuns { size, empty_space: &self.empty_space }
    }

    fn visibility<'a>(&'a self, cells: &Cells) -> Visibility<'a> {
        let size = [cells.width() as i32, cells.height() as i32];
        let Self { empty_space, transmittance, taps, .. } = self;
        Visibility { size, empty_space, transmittance, taps }
    }
}

/// The lines of sight between cells.
struct Visibility<'a> {
    size: [i32; 2],
    empty_space: &'a EmptySpace,
    transmittance: &'a [Rgb],
    taps: &'a [Tap],
}

impl Visibility<'_> {
    /// Calls `each` with the index and the weight, by place and matter, of every tap that cell `i` sees, itself
    /// included.
    #[inline]
    fn taps(&self, i: usize, mut each: impl FnMut(usize, f32)) {
        let [w, h] = self.size;
        let (x, y) = (i as i32 % w, i as i32 / w);
        for tap in self.taps {
            let [tx, ty] = [x + tap.offset[0], y + tap.offset[1]];
            if (0..w).contains(&tx) && (0..h).contains(&ty) && self.sees(i, tap) {
                let j = (ty * w + tx) as usize;
                each(j, tap.weight * self.likeness(i, j));
            }
        }
    }

    /// The weight of cell `j` in the light of cell `i` by the matter of both.
    #[inline]
    fn likeness(&self, i: usize, j: usize) -> f32 {
        let (Some(own), Some(other)) = (self.transmittance.get(i), self.transmittance.get(j))
        else {
            return 1.0;
        };
        let difference = (0..3).map(|c| (own[c] - other[c]).abs()).fold(0.0, f32::max);
        (-TRANSMITTANCE * difference).exp()
    }

    /// Returns whether no solid cell blocks the line from cell `i` to a tap within the grid.
    fn sees(&self, i: usize, tap: &Tap) -> bool {
        let [x, y] = tap.offset;
        let square = self.empty_space.plane(quadrant([x as f32, y as f32]))[i];
        let is_solid = |offset| self.empty_space.is_solid(i.wrapping_add_signed(offset));
        x.abs().max(y.abs()) < side(square)
            || !tap.line.iter().any(|pair| is_solid(pair[0]) && is_solid(pair[1]))
    }
}

/// The walls along which light is blurred.
struct WallRuns<'a> {
    size: [usize; 2],
    empty_space: &'a EmptySpace,
}

impl WallRuns<'_> {
    /// Calls `each` with the index of a solid cell and its distance, 0, and, if it is open to the left and the right only or
    /// above and below only, with those of the cells along its wall that are open to the same sides, up to a distance.
    #[inline]
    fn along(&self, i: usize, reach: usize, mut each: impl FnMut(usize, usize)) {
        each(i, 0);
        let [w, h] = self.size;
        let own = self.open_sides(i);
        let [left, right, upper, lower] = own;
        let (step, place, side) = match (left || right, upper || lower) {
            (false, true) => (1, i % w, w),
            (true, false) => (w, i / w, h),
            _ => return,
        };
        let before = (1..=reach.min(place)).map(|away| (i - away * step, away));
        let after = (1..=reach.min(side - 1 - place)).map(|away| (i + away * step, away));
        let same = |&(j, _): &(usize, usize)| self.open_sides(j) == own;
        before.take_while(same).for_each(|(j, away)| each(j, away));
        after.take_while(same).for_each(|(j, away)| each(j, away));
    }

    /// The sides to which a solid cell is open: left, right, upper, lower; none of another cell.
    #[inline]
    fn open_sides(&self, i: usize) -> [bool; 4] {
        let [w, h] = self.size;
        let (x, y) = (i % w, i / w);
        let solid = |i: usize| self.empty_space.is_solid(i);
        if !solid(i) {
            return [false; 4];
        }
        [
            x > 0 && !solid(i - 1),
            x + 1 < w && !solid(i + 1),
            y > 0 && !solid(i - w),
            y + 1 < h && !solid(i + w),
        ]
    }
}
