//! Debug views: the intervals of one level, of rays that lead to the right.

use super::Holographic;
use super::extend::IntervalLevels;
use super::faces;
use super::interval::{PAD, unpack_one, words};
use super::lattice::{GatherGeometry, levels, planes, points, rays};
use super::slabs::{Axis, Slabs};
use crate::{Cells, Display, Rgb, settings};
use image::RgbImage;

/// The radiance that represents full transmittance. It is faint, so that light stands out.
const CLEAR: Rgb = [0.01, 0.02, 0.06];

impl Holographic {
    /// Returns the first level of intervals, and the first that is not made.
    pub(crate) fn interval_levels(
        &self,
        cells: &Cells,
        settings: &settings::Holographic,
    ) -> [u32; 2] {
        let geometry = GatherGeometry::new(settings);
        let first = geometry.first();
        let depth = points(cells.width() as usize, geometry.spacing_level);
        // The planes at the very edge are not made: nothing gathers from them.
        let end = (first..levels(depth, first)).find(|&level| planes(depth, level) < 2);
        [first, end.unwrap_or(levels(depth, first))]
    }

    /// Draws the direct light of the intervals of a level: planes from left to right, a band each. In
    /// a band each column is a ray and each row the row where it starts.
    pub(crate) fn debug_view(
        &self,
        cells: &Cells,
        settings: &settings::Holographic,
        level: u32,
        display: &Display,
    ) -> RgbImage {
        let (mut slabs, mut intervals) = (Slabs::default(), IntervalLevels::default());
        let geometry = GatherGeometry::new(settings);
        let (first, spacing) = (geometry.first(), 1 << geometry.spacing_level);
        slabs.read(cells, Axis::X, [geometry.max_length().max(faces::REACH), spacing], None);
        intervals.prepare(&slabs, geometry);
        intervals.prepare_bundles(&slabs, settings.bundle_rays);
        let [depth, height] =
            [slabs.depth, slabs.rows].map(|side| points(side, geometry.spacing_level));
        let band = rays(level) + 1;
        let width = band * (planes(depth, level) - 1);
        let mut light: Vec<Rgb> = vec![[0.0; 3]; width * height];
        for plane in (1..planes(depth, first)).rev() {
            intervals.make(self.level, &slabs, plane);
            let (above, below) = (plane >> (level - first), level - first);
            if plane != above << below {
                continue;
            }
            let stride = intervals.stride;
            for ray in 0..rays(level) {
                let stored = intervals.ray_of_plane(level, above, ray);
                for y in 0..height {
                    let word = |i: usize| stored[i * stride + PAD + y];
                    let third = if words(slabs.channels) > 2 { word(2) } else { 0 };
                    let (radiance, transmittance) =
                        unpack_one([word(0), word(1), third], slabs.channels);
                    let to = &mut light[y * width + (above - 1) * band + ray];
                    *to = std::array::from_fn(|c| radiance[c] + transmittance[c] * CLEAR[c]);
                }
            }
        }
        display.picture(width as u32, height as u32, &light)
    }
}
