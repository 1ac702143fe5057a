//! Fine structure that light should not have: bricks, stripes, fans and noise.
//!
//! Eyes see fine structure in even light long before a mean error shows it. The ratio q of light to what is
//! right is smooth where a method is only biased. What is left of it without its own mean over a window,
//! `q / mean(q) − 1`, is the residue:
//!
//! * **ripple**: q is light ÷ the closed form of one lone lamp;
//! * **grain**: q is light ÷ the reference, at places that are lit and even.

use crate::closed_forms::disc_mean_radiance;
use lamplight::{Light, Rgb};

/// The least distance from a lamp at which its ripple is measured, px.
pub const FAR: f64 = 60.0;
/// Side of the window, px.
pub const WINDOW: usize = 9;
/// Places count as lit if the reference there is at least this fraction of its mean.
const LIT: f64 = 0.1;
/// Places count as even if the reference in the window varies by no more than this factor.
const EVEN: f64 = 1.5;

/// The residue over some places.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residue {
    /// Root mean square.
    pub rms: f64,
    /// The largest.
    pub worst: f64,
    /// The number of places.
    pub places: usize,
}

/// Returns the residue of a ratio, given row by row, over the places whose whole window lies in the grid and
/// which `counts` accepts by index.
///
/// # Panics
/// If the ratios are not whole rows.
pub fn residue(width: usize, ratio: &[f64], counts: impl Fn(usize) -> bool) -> Residue {
    assert!(ratio.len().is_multiple_of(width), "{} values in rows of {width}", ratio.len());
    let (mut squares, mut residue) = (0.0, Residue::default());
    for_each_window(width, ratio.len() / width, |at| {
        if counts(at) {
            let sum: f64 = window(width, at).map(|i| ratio[i]).sum();
            let mean = sum / (WINDOW * WINDOW) as f64;
            let off = ratio[at] / mean - 1.0;
            squares += off * off;
            residue.worst = residue.worst.max(off.abs());
            residue.places += 1;
        }
    });
    residue.rms = (squares / residue.places.max(1) as f64).sqrt();
    residue
}

/// Returns the ripple of the light of one lone lamp of radiance 1, over the places more than [`FAR`] px from it.
pub fn ripple(light: &Light, position: [f32; 2], radius: f64) -> Residue {
    let width = light.width() as usize;
    let distance = |i: usize| {
        let [x, y] = [i % width, i / width].map(|v| v as f64 + 0.5);
        (x - f64::from(position[0])).hypot(y - f64::from(position[1]))
    };
    let ratio = |(i, light): (usize, &Rgb)| match distance(i) {
        d if d > radius => f64::from(light[0]) / disc_mean_radiance(1.0, radius, d),
        _ => 1.0,
    };
    let ratio: Vec<f64> = light.pixels().iter().enumerate().map(ratio).collect();
    residue(width, &ratio, |i| distance(i) > FAR)
}

/// Returns the grain of light: the root mean square, over channels, of the residue of light ÷ reference at the
/// lit and even places. What the reference's own noise (`standard_error`, cell by cell) adds to it is taken off.
/// None without such a place, or if the residue is not a number.
///
/// # Panics
/// If sizes differ.
pub fn grain(light: &Light, reference: &Light, standard_error: &[Rgb]) -> Option<f64> {
    let (width, height) = (reference.width() as usize, reference.height() as usize);
    assert!(light.pixels().len() == width * height && standard_error.len() == width * height);
    let solid = reference.solid();
    let open = || reference.pixels().iter().zip(solid).filter(|&(_, &solid)| !solid);
    let sum: f64 = open().flat_map(|(rgb, _)| rgb).map(|&v| f64::from(v)).sum();
    let lit = LIT * sum / (3 * open().count().max(1)) as f64;
    let (mut squares, mut noise, mut places) = (0.0, 0.0, 0);
    for c in 0..3 {
        let truth = |i: usize| f64::from(reference.pixels()[i][c]);
        let mut counts = vec![false; width * height];
        for_each_window(width, height, |at| {
            let (mut least, mut most) = (f64::INFINITY, 0.0f64);
            for i in window(width, at) {
                let truth = if solid[i] { 0.0 } else { truth(i) };
                (least, most) = (least.min(truth), most.max(truth));
            }
            counts[at] = least > 0.0 && truth(at) >= lit && most <= EVEN * least;
        });
        let ratio = |(i, light): (usize, &Rgb)| f64::from(light[c]) / truth(i);
        let ratio: Vec<f64> = light.pixels().iter().enumerate().map(ratio).collect();
        let found = residue(width, &ratio, |i| counts[i]);
        squares += found.rms * found.rms * found.places as f64;
        places += found.places;
        let counted = (0..counts.len()).filter(|&i| counts[i]);
        noise += counted.map(|i| (f64::from(standard_error[i][c]) / truth(i)).powi(2)).sum::<f64>();
    }
    // The mean over the window has a share of the noise of the place itself.
    let noise = noise * (1.0 - 1.0 / (WINDOW * WINDOW) as f64);
    let grain = ((squares - noise).max(0.0) / places.max(1) as f64).sqrt();
    (places > 0 && squares.is_finite()).then_some(grain)
}

/// Calls `visit` with the index of every place whose whole window lies in the grid.
fn for_each_window(width: usize, height: usize, mut visit: impl FnMut(usize)) {
    let reach = WINDOW / 2;
    for y in reach..height.saturating_sub(reach) {
        for x in reach..width.saturating_sub(reach) {
            visit(y * width + x);
        }
    }
}

/// Returns the cells of the window around a place.
fn window(width: usize, at: usize) -> impl Iterator<Item = usize> {
    let reach = WINDOW / 2;
    let first = at - reach * width - reach;
    (0..WINDOW).flat_map(move |row| first + row * width..first + row * width + WINDOW)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use lamplight::Cells;

    const SIDE: usize = 40;

    /// Light that falls off smoothly, times a factor by place.
    fn light(factor: impl Fn(usize, usize) -> f32) -> Light {
        let at = |i: usize| [(2.0 + i as f32 / 800.0) * factor(i % SIDE, i / SIDE); 3];
        let cells = Cells::new(SIDE as u32, SIDE as u32).unwrap();
        Light::from_pixels(&cells, (0..SIDE * SIDE).map(at).collect()).unwrap()
    }

    /// The error of a reference without noise.
    fn none() -> Vec<Rgb> {
        vec![[0.0; 3]; SIDE * SIDE]
    }

    fn grain_of(of: &Light) -> f64 {
        grain(of, &light(|_, _| 1.0), &none()).unwrap()
    }

    #[test]
    fn a_factor_is_no_grain_and_bricks_are() {
        assert!(grain_of(&light(|_, _| 1.3)) < 1e-6);
        let bricks = grain_of(&light(|x, _| if x / 8 % 2 == 0 { 1.05 } else { 1.0 }));
        assert!((0.01..0.05).contains(&bricks), "{bricks}");
    }

    #[test]
    fn the_noise_of_the_reference_is_no_grain() {
        let noise = |x: usize, y: usize| Random::new(7, (y * SIDE + x) as u64, 0).unit() as f32;
        let noisy = light(|x, y| 1.0 + 0.1 * (noise(x, y) - 0.5));
        // The spread of a uniform variable of width 0.1.
        let spread = 0.1 / 12f32.sqrt();
        let error: Vec<Rgb> = noisy.pixels().iter().map(|rgb| rgb.map(|v| v * spread)).collect();
        let clean = light(|_, _| 1.0);
        let found = grain(&clean, &noisy, &error).unwrap();
        let uncorrected = grain(&clean, &noisy, &none()).unwrap();
        assert!(found < 0.3 * uncorrected, "{found} of {uncorrected}");
    }

    #[test]
    fn dark_and_uneven_places_do_not_count() {
        let fault = |x: usize, _| if x.is_multiple_of(2) { 2.0 } else { 1.0 };
        let dark = |x: usize, _: usize| if x < 30 { 1e-3 } else { 1.0 };
        let of = |reference: &dyn Fn(usize, usize) -> f32| {
            let light = light(|x, y| reference(x, y) * if x < 30 { fault(x, y) } else { 1.0 });
            grain(&light, &self::light(reference), &none()).unwrap()
        };
        assert!(of(&|_, _| 1.0) > 0.1);
        assert!(of(&dark) < 1e-6);
        assert!(of(&|x, _| if x < 30 && x / 2 % 2 == 0 { 2.0 } else { 1.0 }) < 0.1);
        let black = light(|_, _| 0.0);
        assert_eq!(grain(&black, &black, &none()), None);
    }
}
