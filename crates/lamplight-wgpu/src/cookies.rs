//! The cookies of a frame's lamps: their pictures, one after the other in a texture.

use crate::error::{PrepareError, Result};
use crate::error_scope::with_error_scope;
use crate::grid_size::GridSize;
use crate::matter::{cookies_texture, write_texels};
use lamplight::internals::cookie::axis;
use lamplight::{Cookie, CookiePixels, Lamp};
use wgpu::{Device, Queue, TextureView};

/// Texels of a row. Pictures follow each other without regard to rows.
const COLUMNS: u64 = 2048;

/// The pictures of all cookies, each once. They are uploaded only when a lamp has one that was not there, and take
/// 16 bytes per texel, until others take their place.
#[derive(Debug, Default)]
pub struct CookieAtlas {
    /// The pictures, and the first texel of each.
    pictures: Vec<(CookiePixels, u64)>,
    /// The texture, once a lamp has had a cookie.
    pub view: Option<TextureView>,
    /// True if the texture has these pictures.
    is_written: bool,
}

/// A cookie as shaders/shared/lamps.wgsl reads it.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlacedCookie {
    /// Its axis.
    pub axis: [f32; 2],
    /// Columns, and rows times 2¹⁶; 0 for none.
    pub size: u32,
    /// Its first texel.
    pub first: u32,
}

impl CookieAtlas {
    /// Makes room for the cookies of lamps.
    ///
    /// # Errors
    /// If the device has no texture of that size.
    pub fn set(&mut self, device: &Device, grid: GridSize, lamps: &[Lamp]) -> Result<()> {
        let cookies = || lamps.iter().filter_map(|lamp| lamp.cookie.as_ref()?.pixels());
        if cookies().all(|pixels| self.first(pixels).is_some()) {
            return Ok(());
        }
        self.pictures.clear();
        self.is_written = false;
        let mut end = 0;
        for pixels in cookies() {
            if self.first(pixels).is_none() {
                self.pictures.push((pixels.clone(), end));
                end += pixels.pixels().len() as u64;
            }
        }
        let rows = end.div_ceil(COLUMNS);
        let present = self.view.as_ref().map_or(0, |view| u64::from(view.texture().height()));
        if rows > present {
            let most = u64::from(device.limits().max_texture_dimension_2d);
            if rows > most || COLUMNS > most {
                self.pictures.clear();
                let what = "rows of 2048 texels for the cookies of its lamps";
                return Err(grid.too_large(what, rows, most));
            }
            let rows = (present + present / 2).clamp(rows, most) as u32;
            let create = || Ok(cookies_texture(device, [COLUMNS as u32, rows]));
            let created = with_error_scope::<_, PrepareError>(device, create);
            if created.is_err() {
                self.pictures.clear();
            }
            self.view = Some(created?);
        }
        Ok(())
    }

    /// The bytes of a texture of cookies.
    pub fn bytes(view: &TextureView) -> u64 {
        let texture = view.texture();
        u64::from(texture.width()) * u64::from(texture.height()) * size_of::<[f32; 4]>() as u64
    }

    /// The first texel of a picture, if it has a place.
    fn first(&self, pixels: &CookiePixels) -> Option<u64> {
        let placed = self.pictures.iter().find(|(placed, _)| placed.shares(pixels));
        placed.map(|(_, first)| *first)
    }

    /// The cookie of a lamp, if it has one.
    pub fn placed(&self, cookie: Option<&Cookie>) -> PlacedCookie {
        let place = |cookie: &Cookie| {
            let pixels = cookie.pixels()?;
            let [width, height] = pixels.size();
            // Textures have no more than 2³² texels.
            let first = self.first(pixels)? as u32;
            Some(PlacedCookie { axis: axis(cookie), size: width | height << 16, first })
        };
        cookie.and_then(place).unwrap_or_default()
    }

    /// Writes the pictures, unless the texture has them already.
    pub fn write(&mut self, queue: &Queue) {
        let Some(view) = self.view.as_ref().filter(|_| !self.is_written) else { return };
        write_texels(queue, view, &self.texels());
        self.is_written = true;
    }

    /// The texels of the texture, if there is one.
    pub fn texels(&self) -> Vec<[f32; 4]> {
        let Some(view) = &self.view else { return Vec::new() };
        let texture = view.texture();
        let count = texture.width() as usize * texture.height() as usize;
        let mut texels = Vec::with_capacity(count);
        for (pixels, _) in &self.pictures {
            texels.extend(pixels.pixels().iter().map(|&[r, g, b]| [r, g, b, 0.0]));
        }
        texels.resize(count, [0.0; 4]);
        texels
    }
}
