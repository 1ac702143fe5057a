//! Debug views: the light that the probes of one cascade gather, before the next nearer one reads it.

use super::ladder::BRANCHES;
use super::merge::LIGHT;
use super::{Cascade, Cascades};
use crate::{Cells, Display, Rgb, settings};
use image::RgbImage;

impl Cascades {
    /// Returns all cascades but the nearest, whose probes are the cells themselves.
    pub(crate) fn farther(&self) -> &[Cascade] {
        self.cascades.get(1..).unwrap_or_default()
    }

    /// Draws the light that the probes of a cascade gather, cascade 1 and on, for the last frame: a tile
    /// per cone, the mean over its four rays, cones row by row in the order of their angles.
    pub(crate) fn debug_view(
        &mut self,
        cells: &Cells,
        settings: &settings::Cascades,
        number: u32,
        display: &Display,
    ) -> RgbImage {
        let Some(&cascade) = self.cascades.get(number as usize) else { return RgbImage::new(1, 1) };
        let tiles = cascade.rays / BRANCHES;
        let columns = f64::from(tiles).sqrt().ceil() as usize;
        let [across, down] = cascade.lattice.count.map(|count| count as usize);
        let width = columns * across;
        let mut light: Vec<Rgb> = vec![[0.0; 3]; width * (tiles as usize).div_ceil(columns) * down];
        let filled = |filled: &Cascade, first: u32, gathered: &[f32]| {
            if filled.rays != cascade.rays {
                return;
            }
            let probes = across * down;
            for (tile, planes) in (first as usize..).zip(gathered.chunks_exact(3 * probes)) {
                let corner = tile / columns * down * width + tile % columns * across;
                for probe in 0..probes {
                    let to = corner + probe / across * width + probe % across;
                    light[to] = [0, 1, 2].map(|c| planes[c * probes + probe]);
                }
            }
        };
        self.each_cone::<LIGHT>(cells, settings, |_, _, _| (), filled);
        display.picture(width as u32, (light.len() / width) as u32, &light)
    }
}
