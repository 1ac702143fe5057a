//! Error maps: the error of every cell as a colour, on a logarithmic scale.

use lamplight::image::{Rgb as Pixel, RgbImage};
use lamplight::{Light, Rgb};

/// The lower end of the scale, relative to the mean of the reference; the upper end is 1.
pub const LEAST: f64 = 0.001;
/// The colour of walls, which are not compared.
pub const WALL: [u8; 3] = [52, 54, 60];

/// The colour of a relative error.
pub fn color(error: f64) -> [u8; 3] {
    let position = if error > 0.0 { 1.0 - error.log10() / LEAST.log10() } else { 0.0 };
    let color = colorous::MAGMA.eval_continuous(position.clamp(0.0, 1.0));
    [color.r, color.g, color.b]
}

/// The absolute error of each open cell (mean over the channels) ÷ the mean of the reference.
pub fn map(light: &Light, truth: &Light, mean: f64) -> RgbImage {
    RgbImage::from_fn(truth.width(), truth.height(), |x, y| {
        let i = (y * truth.width() + x) as usize;
        let (a, b): (Rgb, Rgb) = (light.at(x, y), truth.at(x, y));
        let error: f64 = (0..3).map(|c| f64::from((a[c] - b[c]).abs())).sum::<f64>() / 3.0;
        Pixel(if truth.solid()[i] { WALL } else { color(error / mean.max(f64::MIN_POSITIVE)) })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_has_its_ends_and_its_middle() {
        let at = |share| {
            let c = colorous::MAGMA.eval_continuous(share);
            [c.r, c.g, c.b]
        };
        assert_eq!(color(0.0), at(0.0));
        assert_eq!(color(LEAST), at(0.0));
        assert_eq!(color(LEAST.sqrt()), at(0.5));
        assert_eq!(color(1.0), at(1.0));
        assert_eq!(color(50.0), at(1.0));
    }
}
