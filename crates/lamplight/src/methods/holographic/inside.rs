//! Intervals to be looked at: what the rays of one level, that lead to the right, add and let through.

use super::interval::{PAD, scalar, words};
use super::pyramid::{Pyramid, levels, planes, rays};
use super::slabs::{Axis, Slabs};
use super::{Holographic, onto};
use crate::{Cells, Display, Rgb, Settings};
use fearless_simd::dispatch;
use image::RgbImage;

/// What stands for clear space: faint, so that light stands out.
const THROUGH: Rgb = [0.01, 0.02, 0.06];

impl Holographic {
    /// The first level of intervals, and the first that is not made.
    pub(crate) fn held(&self, cells: &Cells, settings: &Settings) -> [u32; 2] {
        let (depth, first) = (cells.width() as usize, settings.holographic.hop);
        // The planes at the very edge are not made: nothing looks to them.
        let end = (first..levels(depth, first)).find(|&level| planes(depth, level) < 2);
        [first, end.unwrap_or(levels(depth, first))]
    }

    /// Direct light of the intervals of a level: planes from left to right, a band each; in it a
    /// column a ray, from up to down; row by row where the ray begins.
    pub(crate) fn inside(
        &self,
        cells: &Cells,
        settings: &Settings,
        level: u32,
        display: &Display,
    ) -> RgbImage {
        let settings = &settings.holographic;
        let (mut slabs, mut pyramid) = (Slabs::default(), Pyramid::default());
        slabs.read(cells, Axis::X, (2 << settings.hop).max(onto::REACH), None);
        pyramid.prepare(&slabs, settings.hop);
        pyramid.aim(&slabs, settings.beams);
        let (band, height) = (rays(level) + 1, cells.height() as usize);
        let width = band * (planes(slabs.depth, level) - 1);
        let mut light: Vec<Rgb> = vec![[0.0; 3]; width * height];
        for plane in (1..planes(slabs.depth, settings.hop)).rev() {
            match slabs.channels {
                1 => dispatch!(self.level, simd => pyramid.make::<_, 1>(simd, &slabs, plane)),
                _ => dispatch!(self.level, simd => pyramid.make::<_, 3>(simd, &slabs, plane)),
            }
            let (above, below) = (plane >> (level - settings.hop), level - settings.hop);
            if plane != above << below {
                continue;
            }
            let stride = pyramid.stride;
            for ray in 0..rays(level) {
                let held = pyramid.held(level, above, ray);
                for y in 0..height {
                    let word = |i: usize| held[i * stride + PAD + y];
                    let third = if words(slabs.channels) > 2 { word(2) } else { 0 };
                    let (adds, through) = scalar([word(0), word(1), third], slabs.channels);
                    let to = &mut light[y * width + (above - 1) * band + ray];
                    *to = std::array::from_fn(|c| adds[c] + through[c] * THROUGH[c]);
                }
            }
        }
        display.picture(width as u32, height as u32, &light)
    }
}
