//! Debug views: the shadow map of each lamp, its light unrolled round it.

use super::PolarSolver;
use crate::{Display, Rgb};
use image::RgbImage;

/// Columns: angles from 0 (to the right), clockwise in the picture.
const ANGLES: usize = 720;
/// Rows of a lamp: distances from 0 to its reach,
const ROWS: usize = 40;
/// and a dark one after them.
const STRIP: usize = ROWS + 1;
/// The most lamps that are shown.
const LAMPS: usize = 32;

impl PolarSolver {
    /// Returns a strip for each of the first lamps of the last frame's last group.
    pub(crate) fn ray_textures(&self) -> RgbImage {
        let shadow_maps = &self.shadow_maps[..self.last.min(LAMPS)];
        let mut light: Vec<Rgb> = vec![[0.0; 3]; ANGLES * STRIP * shadow_maps.len().max(1)];
        for (shadow_map, strip) in shadow_maps.iter().zip(light.chunks_exact_mut(ANGLES * STRIP)) {
            for (row, light) in strip.chunks_exact_mut(ANGLES).take(ROWS).enumerate() {
                // Brightness only separates near from far: light itself is white at the lamp.
                let far = (row as f32 + 0.5) / ROWS as f32;
                let (distance, brightness) = (shadow_map.reach * far, 1.0 - 0.9 * far);
                for (column, light) in light.iter_mut().enumerate() {
                    if shadow_map.length(column * shadow_map.count / ANGLES) > distance {
                        *light = shadow_map.lamp.color.map(|c| c * brightness);
                    }
                }
            }
        }
        Display::PLAIN.picture(ANGLES as u32, (light.len() / ANGLES) as u32, &light)
    }
}
