//! Import of images into a canvas, and of scene files as a canvas.

use super::{Canvas, Error, Result, Stuff};
use crate::look::Look;
use crate::paint::{mix, scale};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use lamplight::{Cells, Rgb, Scene, srgb};
use std::io::Cursor;
use std::path::Path;

/// The matter that an image becomes. Transparent pixels change nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum As {
    /// Walls of its colours.
    Wall,
    /// Solids that emit its colours times a factor.
    Glow(f32),
    /// Glass of its colours.
    Glass,
    /// The backdrop.
    Backdrop,
}

/// The smallest alpha of a px that is painted.
const HALF: f32 = 0.5;
/// Bytes that decoding may allocate in addition to the px.
const DECODER_BYTES: u64 = 64 << 20;
/// Bytes per px, decoded and converted.
const PIXEL_BYTES: u64 = 16;

impl Canvas {
    /// The largest scene file and image, bytes.
    pub const MAX_BYTES: usize = 64 << 20;

    /// Paints a PNG into the middle of the canvas, as one edit. A larger image is scaled down to fit, and
    /// a message about it is returned.
    ///
    /// The size is checked before the px are decoded.
    pub fn place_image(&mut self, png: &[u8], kind: As) -> Result<Option<String>> {
        let picture = Picture::decode(png)?;
        let [w, h] = self.size();
        let [from_w, from_h] = picture.size;
        let shrink = (w as f32 / from_w as f32).min(h as f32 / from_h as f32).min(1.0);
        let fit = |side: u32, most: u32| ((side as f32 * shrink).round() as u32).clamp(1, most);
        let to = [fit(from_w, w), fit(from_h, h)];
        let corner = [(w - to[0]) / 2, (h - to[1]) / 2];
        self.begin();
        for y in 0..to[1] {
            for x in 0..to[0] {
                let (color, alpha) = picture.mean([x, y], to);
                let index = ((corner[1] + y) * w + corner[0] + x) as usize;
                self.place_px(index, color, alpha, kind);
            }
        }
        self.end();
        Ok((to != picture.size).then(|| {
            format!(
                "The image of {from_w}×{from_h} px is larger than the canvas; it was scaled down \
                 to {}×{}.",
                to[0], to[1]
            )
        }))
    }

    fn place_px(&mut self, index: usize, color: Rgb, alpha: f32, kind: As) {
        if kind == As::Backdrop {
            let under = self.backdrop[index].color;
            return self.touch(index, Stuff::Backdrop(mix(under, color, alpha)));
        }
        if alpha < HALF {
            return;
        }
        let stuff = match kind {
            As::Wall => Stuff::Wall(color),
            As::Glow(by) => Stuff::Glow(scale(color, by)),
            As::Glass | As::Backdrop => Stuff::Glass(color),
        };
        self.touch(index, stuff);
    }

    /// Loads a canvas from the text of a scene file (TOML or JSON) and the images that it refers to, by name.
    ///
    /// Nothing is read from disk. Shapes become cells, so that everything can be painted over.
    pub fn from_scene(text: &str, files: &[(String, Vec<u8>)]) -> Result<Self> {
        short(text.as_bytes())?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let scene = if text.trim_start().starts_with('{') {
            Scene::from_json(text)?
        } else {
            Scene::from_toml(text)?
        };
        let given = |path: &Path| {
            let find = |path: &Path| files.iter().find(|(name, _)| Path::new(name) == path);
            // Browsers provide files without their folders.
            let named = find(path).or_else(|| find(Path::new(path.file_name()?)));
            named.map(|(_, bytes)| bytes.as_slice())
        };
        Self::of_scene(&scene, |scene| scene.cells_with(given))
    }

    /// Loads a canvas from a scene with the cells that `draw` makes of it. Its size is checked before.
    pub fn of_scene(
        scene: &Scene,
        draw: impl FnOnce(&Scene) -> lamplight::Result<Cells>,
    ) -> Result<Self> {
        Self::check_size(scene.size)?;
        if scene.lamps.len() > Self::MAX_LAMPS {
            return Err(Error::Lamps(scene.lamps.len()));
        }
        Self::of(draw(scene)?, Look::of(&scene.resolve_settings()?, scene.display))
    }
}

fn short(bytes: &[u8]) -> Result<()> {
    let (found, most) = (bytes.len(), Canvas::MAX_BYTES);
    if found > most { Err(Error::Long { found, most }) } else { Ok(()) }
}

/// A decoded image.
struct Picture {
    size: [u32; 2],
    rgba: image::RgbaImage,
}

impl Picture {
    fn decode(png: &[u8]) -> Result<Self> {
        short(png)?;
        let broken = |e: image::ImageError| Error::Image(format!("{e}; a PNG is needed"));
        let mut reader = ImageReader::with_format(Cursor::new(png), ImageFormat::Png);
        let mut limits = Limits::default();
        limits.max_alloc = Some(DECODER_BYTES);
        reader.limits(limits.clone());
        let mut decoder = reader.into_decoder().map_err(broken)?;
        let (width, height) = decoder.dimensions();
        let pixels = u64::from(width) * u64::from(height);
        if pixels > u64::from(Canvas::MAX_PIXELS) {
            return Err(Error::Pixels { width, height });
        }
        limits.max_alloc = Some(pixels * PIXEL_BYTES + DECODER_BYTES);
        decoder.set_limits(limits).map_err(broken)?;
        let image = DynamicImage::from_decoder(decoder).map_err(broken)?;
        Ok(Self { size: [width, height], rgba: image.into_rgba8() })
    }

    /// The mean linear colour, weighted by alpha, of the px that one px of size `to` covers.
    fn mean(&self, at: [u32; 2], to: [u32; 2]) -> (Rgb, f32) {
        let span = |i: usize| {
            let edge = |k: u32| (u64::from(k) * u64::from(self.size[i]) / u64::from(to[i])) as u32;
            edge(at[i])..edge(at[i] + 1).max(edge(at[i]) + 1)
        };
        let (mut sum, mut alpha, mut count) = ([0.0f32; 3], 0.0f32, 0.0f32);
        for y in span(1) {
            for x in span(0) {
                let [r, g, b, a] = self.rgba.get_pixel(x, y).0;
                let weight = f32::from(a) / 255.0;
                let color = [r, g, b].map(srgb::decode_u8);
                (0..3).for_each(|c| sum[c] += weight * color[c]);
                alpha += weight;
                count += 1.0;
            }
        }
        let color = if alpha > 0.0 { sum.map(|v| (v / alpha).min(1.0)) } else { [0.0; 3] };
        (color, alpha / count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::Paint;

    #[test]
    fn an_image_in_its_own_size_keeps_its_colours() {
        let mut canvas = Canvas::new([8, 8]).unwrap();
        let image = image::RgbaImage::from_fn(4, 2, |x, y| {
            image::Rgba([x as u8 * 60, y as u8 * 200, 7, if x == 3 { 0 } else { 255 }])
        });
        let mut png = Cursor::new(Vec::new());
        image.write_to(&mut png, ImageFormat::Png).unwrap();
        assert_eq!(canvas.place_image(png.get_ref(), As::Wall).unwrap(), None);
        let color = [60, 200, 7].map(srgb::decode_u8);
        let index = canvas.cells().index(3, 4);
        assert_eq!(Paint::of(canvas.cells(), index), Paint::wall(color));
        let clear = canvas.cells().index(5, 4);
        assert_eq!(canvas.cells().opacity()[clear], 0.0);
        assert!(canvas.undo());
        assert_eq!(canvas.cells(), Canvas::new([8, 8]).unwrap().cells());
    }
}
