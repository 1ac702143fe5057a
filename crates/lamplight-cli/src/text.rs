//! Text in pictures, in Noto Sans Mono.

use image::{Rgb, RgbImage};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// A size and a weight.
#[derive(Clone, Copy, Debug)]
pub struct Font {
    weight: FontWeight,
    size: RasterHeight,
}

/// The font of captions.
pub const SMALL: Font = Font { weight: FontWeight::Regular, size: RasterHeight::Size16 };
/// The font of names.
pub const STRONG: Font = Font { weight: FontWeight::Bold, size: RasterHeight::Size16 };
/// The font of titles.
pub const LARGE: Font = Font { weight: FontWeight::Bold, size: RasterHeight::Size24 };

impl Font {
    /// The height of a line, px.
    pub fn height(self) -> u32 {
        self.size.val() as u32
    }

    /// The width of a text, px.
    pub fn width(self, text: &str) -> u32 {
        (get_raster_width(self.weight, self.size) * text.chars().count()) as u32
    }
}

/// Writes a line with its top left corner at (x, y) and returns the x of its end. The picture clips
/// it; characters that the font lacks show as `?`.
pub fn write(
    picture: &mut RgbImage,
    [x, y]: [u32; 2],
    text: &str,
    font: Font,
    color: [u8; 3],
) -> u32 {
    let mut left = x;
    for character in text.chars() {
        let raster = |c| get_raster(c, font.weight, font.size);
        let Some(raster) = raster(character).or_else(|| raster('?')) else { continue };
        for (dy, row) in raster.rows().enumerate() {
            for (dx, &cover) in row.iter().enumerate() {
                let at = (left + dx as u32, y + dy as u32);
                if let Some(Rgb(pixel)) = picture.get_pixel_mut_checked(at.0, at.1) {
                    for c in 0..3 {
                        let (old, new) = (u32::from(pixel[c]), u32::from(color[c]));
                        let cover = u32::from(cover);
                        pixel[c] = ((old * (255 - cover) + new * cover + 127) / 255) as u8;
                    }
                }
            }
        }
        left += raster.width() as u32;
    }
    left
}
