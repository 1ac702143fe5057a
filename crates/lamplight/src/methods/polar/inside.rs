//! Ray textures to be looked at: the light of each lamp unrolled round it.

use super::Polar;
use crate::{Display, Rgb, ToneMap};
use image::RgbImage;

/// Columns, angles from 0 (to the right) on, clockwise as the picture has it.
const ANGLES: usize = 720;
/// Rows of a lamp: px from the lamp to its reach,
const ROWS: usize = 40;
/// and a dark one after them.
const STRIP: usize = ROWS + 1;
/// More lamps than this are not shown.
const LAMPS: usize = 32;

impl Polar {
    /// A strip for each of the first lamps of the last frame's last group.
    pub(crate) fn ray_textures(&self) -> RgbImage {
        let fans = &self.fans[..self.last.min(LAMPS)];
        let mut light: Vec<Rgb> = vec![[0.0; 3]; ANGLES * STRIP * fans.len().max(1)];
        for (fan, strip) in fans.iter().zip(light.chunks_exact_mut(ANGLES * STRIP)) {
            for (row, light) in strip.chunks_exact_mut(ANGLES).take(ROWS).enumerate() {
                // Brightness only tells near from far: light itself would be white at the lamp.
                let far = (row as f32 + 0.5) / ROWS as f32;
                let (distance, brightness) = (fan.reach * far, 1.0 - 0.9 * far);
                for (column, light) in light.iter_mut().enumerate() {
                    if fan.length(column * fan.count / ANGLES) > distance {
                        *light = fan.lamp.color.map(|c| c * brightness);
                    }
                }
            }
        }
        let plain = Display { tonemap: ToneMap::None, exposure: 0.0 };
        plain.picture(ANGLES as u32, (light.len() / ANGLES) as u32, &light)
    }
}
