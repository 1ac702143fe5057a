//! The cookies of a scene's lamps, read from their images.

use super::picture::Picture;
use super::source::Source;
use crate::{Cookie, CookiePicture, CookiePixels, Error, Lamp, Result};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// The image of a lamp's cookie, as the scene names it.
pub fn image(lamp: &Lamp) -> Option<&PathBuf> {
    match &lamp.cookie.as_ref()?.picture {
        CookiePicture::File(path) => Some(path),
        CookiePicture::Pixels(_) => None,
    }
}

/// Returns the lamps with the pixels of their cookies. Those of one image share them.
pub fn with_pixels(lamps: &[Lamp], source: Source) -> Result<Vec<Lamp>> {
    let mut read = HashMap::new();
    let mut lamps = lamps.to_vec();
    for (i, lamp) in lamps.iter_mut().enumerate() {
        let Some(Cookie { picture, .. }) = &mut lamp.cookie else { continue };
        let CookiePicture::File(path) = &*picture else { continue };
        let path = source.place(path);
        let pixels: CookiePixels = match read.get(&path) {
            Some(pixels) => CookiePixels::clone(pixels),
            None => pixels(source, &path, &format!("lamp[{i}].cookie.picture"))?,
        };
        read.insert(path, pixels.clone());
        *picture = pixels.into();
    }
    Ok(lamps)
}

/// Reads the pixels of an image; `key` names it in errors.
fn pixels(source: Source, path: &Path, key: &str) -> Result<CookiePixels> {
    let most = CookiePixels::MAX_SIDE;
    let fits = |width, height| {
        if width <= most && height <= most {
            return Ok(());
        }
        let found = format!("an image of {width}×{height} px ({})", path.display());
        Err(Error::value(key, found, format!("of at most {most}×{most} px")))
    };
    let picture = Picture::open(source, path, key, fits)?;
    let [width, height] = picture.size();
    let mut texels = Vec::with_capacity(width as usize * height as usize);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let (rgb, alpha) = picture.color(x, y);
        let texel = rgb.map(|v| v * alpha);
        if !texel.iter().all(|v| (0.0..=CookiePixels::BRIGHTEST).contains(v)) {
            let [r, g, b] = texel;
            let found = format!("an image with [{r}, {g}, {b}] at ({x}, {y}) ({})", path.display());
            return Err(Error::value(key, found, "of values from 0 to 1e6"));
        }
        texels.push(texel);
    }
    CookiePixels::new([width, height], &texels)
}
