//! Pictures of the cells and of the fields that the stages before the rays compute.
//!
//! [`crate::Light::picture`] and [`crate::Light::compose`] show the light itself.

use crate::grid::empty_space::side;
use crate::stages::seed::{NONE, unpack};
use crate::{Cells, Display};
use image::{Rgb as Pixel, RgbImage};
use std::borrow::Cow;

/// The colour of a cell without a value.
const NOTHING: Pixel<u8> = Pixel([24, 24, 28]);

/// Emission, and the glow of 1 px, through a tone map.
pub fn emission(cells: &Cells, display: &Display) -> RgbImage {
    display.picture(cells.width(), cells.height(), &emitted(cells))
}

/// Emission plus the glow of 1 px.
pub fn emitted(cells: &Cells) -> Cow<'_, [crate::Rgb]> {
    let Some(glow) = cells.glow() else { return Cow::Borrowed(cells.emission()) };
    let sum = |(e, g): (&crate::Rgb, &crate::Rgb)| std::array::from_fn(|c| e[c] + g[c]);
    cells.emission().iter().zip(glow).map(sum).collect()
}

/// Opacity: white is solid. Values are not sRGB-encoded, as in the layers of a scene.
pub fn opacity(cells: &Cells) -> RgbImage {
    pixels(cells.width(), cells.height(), |i| Pixel([share(cells.opacity()[i]); 3]))
}

/// Albedo, sRGB-encoded.
pub fn albedo(cells: &Cells) -> RgbImage {
    Display::PLAIN.picture(cells.width(), cells.height(), cells.albedo())
}

/// Tint. Values are not sRGB-encoded, as in the layers of a scene.
pub fn tint(cells: &Cells) -> RgbImage {
    pixels(cells.width(), cells.height(), |i| Pixel(cells.tint()[i].map(share)))
}

/// Seed map or Voronoi map, `width` columns, packed as in [`crate::Stages`]: each cell
/// in the colour of its seed, the seed itself darker.
pub fn seeds(width: u32, seeds: &[u32]) -> RgbImage {
    pixels(width, rows(width, seeds), |i| {
        let seed = seeds[i];
        if seed == NONE {
            return NOTHING;
        }
        let [x, y] = unpack(seed);
        Pixel(seed_color(seed, (y * width + x) as usize == i))
    })
}

/// Distance field in px, `width` columns: near is bright, with contour lines; infinite is blank.
pub fn distance(width: u32, distance: &[f32]) -> RgbImage {
    let far = distance.iter().copied().filter(|d| d.is_finite()).fold(1.0, f32::max);
    let step = contour_step(far);
    let band = |i: usize| (distance[i] / step).floor();
    let (w, h) = (width as usize, rows(width, distance) as usize);
    pixels(width, h as u32, |i| {
        let d = distance[i];
        if !d.is_finite() {
            return NOTHING;
        }
        // A step from what is occupied to what is near, so that shapes stand out.
        let brightness = if d == 0.0 { 1.0 } else { 0.9 - 0.85 * f64::from(d / far) };
        let (x, y) = (i % w, i / w);
        let edge =
            d > 0.0 && (x + 1 < w && band(i + 1) != band(i) || y + 1 < h && band(i + w) != band(i));
        let mix = |v: u8| if edge { (u16::from(v) + 255).div_ceil(2) as u8 } else { v };
        Pixel(heat(brightness).map(mix))
    })
}

/// Visibility ([`crate::SightSolver::field`]), `width` columns: white is seen. Values are not sRGB-encoded.
pub fn visibility(width: u32, visibility: &[f32]) -> RgbImage {
    pixels(width, rows(width, visibility), |i| Pixel([share(visibility[i]); 3]))
}

/// Empty-space skips of one quadrant of directions ([`crate::grid::empty_space`]), `width` columns:
/// bright cells let a ray skip far.
pub(crate) fn empty_space(width: u32, squares: &[u8]) -> RgbImage {
    let most = squares.iter().map(|&square| side(square)).fold(1, i32::max);
    pixels(width, rows(width, squares), |i| match side(squares[i]) {
        0 => NOTHING,
        // Most squares are small; the root spreads their values.
        side => Pixel(heat((f64::from(side) / f64::from(most)).sqrt())),
    })
}

/// A colour for 0 (dark) to 1 (bright), perceptually uniform (magma, Smith and van der Walt 2015).
fn heat(share: f64) -> [u8; 3] {
    let color = colorous::MAGMA.eval_continuous(share.clamp(0.0, 1.0));
    [color.r, color.g, color.b]
}

/// 0 to 1 as a byte, without sRGB.
fn share(v: f32) -> u8 {
    (v * 255.0).round() as u8
}

fn rows<T>(width: u32, values: &[T]) -> u32 {
    (values.len() / width.max(1) as usize) as u32
}

fn pixels(width: u32, height: u32, at: impl Fn(usize) -> Pixel<u8>) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| at(y as usize * width as usize + x as usize))
}

/// The distance in px between contour lines: 1, 2 or 5 times a power of ten, for about twelve lines.
fn contour_step(far: f32) -> f32 {
    let least = (far / 12.0).max(1.0);
    let power = 10f32.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|f| f * power).into_iter().find(|&s| s >= least).unwrap_or(least)
}

/// The colour of a seed: a hashed hue of roughly constant lightness; seeds themselves are darker.
fn seed_color(seed: u32, is_seed: bool) -> [u8; 3] {
    // Two rounds of a multiplicative hash (Wellons' lowbias32): neighbours get different hues.
    let mut hash = seed;
    for factor in [0x7feb_352d, 0x846c_a68b] {
        hash = (hash ^ (hash >> 16)).wrapping_mul(factor);
    }
    hash ^= hash >> 16;
    let hue = f64::from(hash & 0xffff) / 65_536.0;
    let color = colorous::SINEBOW.eval_continuous(hue);
    let shade = if is_seed { 0.35 } else { 0.7 + f64::from(hash >> 16) / 65_536.0 * 0.3 };
    // Half way to grey, so that neighbouring tiles are not glaring.
    let soften = |v: u8| ((f64::from(v) * 0.6 + 90.0) * shade) as u8;
    [soften(color.r), soften(color.g), soften(color.b)]
}
