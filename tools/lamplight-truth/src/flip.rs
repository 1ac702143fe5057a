//! LDR-FLIP: the difference that a person sees when flipping between two pictures.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: "FLIP: A Difference Evaluator
//! for Alternating Images", HPG 2020. Colours are blurred as the eye blurs them at the given
//! distance and compared in Hunt-adjusted L*a*b*; where edges or points differ, the difference
//! counts more. The error of a pixel is 0 (no difference) to 1.

use lamplight::Rgb;
use rayon::prelude::*;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// Pixels per degree of vision: 0.7 m from a screen 0.7 m and 3840 pixels wide.
pub const PIXELS_PER_DEGREE: f64 = 67.02;

/// The difference of two pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Flip {
    /// The error of each pixel, 0 to 1, in row order.
    pub map: Vec<f32>,
    /// The mean of the map, the one number to report; 0 for a picture without pixels.
    pub mean: f64,
}

/// Compares two pictures, sRGB-encoded in 0 to 1 (other values are clamped), in row order.
///
/// # Panics
/// If a picture does not hold `width × height` pixels, or `pixels_per_degree` is not above 0.
pub fn flip(
    width: usize,
    height: usize,
    reference: &[Rgb],
    test: &[Rgb],
    pixels_per_degree: f64,
) -> Flip {
    let n = width * height;
    assert!(reference.len() == n && test.len() == n, "a picture is not {width}×{height}");
    assert!(pixels_per_degree > 0.0, "{pixels_per_degree} pixels per degree");
    if n == 0 {
        return Flip { map: Vec::new(), mean: 0.0 };
    }
    let eye = Eye::new(pixels_per_degree);
    let [a, b] = [reference, test].map(|rgb| eye.see(width, height, rgb));
    let most = hyab(hunt([0.0, 1.0, 0.0]), hunt([0.0, 0.0, 1.0])).powf(COLOR_EXPONENT);
    let map: Vec<f32> = (0..n)
        .map(|i| {
            let color = redistribute(hyab(a.color[i], b.color[i]).powf(COLOR_EXPONENT), most);
            let edge = (a.edge[i] - b.edge[i]).abs();
            let point = (a.point[i] - b.point[i]).abs();
            let feature = (FRAC_1_SQRT_2 * edge.max(point)).powf(FEATURE_EXPONENT).min(1.0);
            color.powf(1.0 - feature) as f32
        })
        .collect();
    let mean = map.iter().map(|&e| f64::from(e)).sum::<f64>() / n as f64;
    Flip { map, mean }
}

/// [`flip`] of 8-bit sRGB pictures.
///
/// # Panics
/// As [`flip`].
pub fn flip8(
    width: usize,
    height: usize,
    reference: &[[u8; 3]],
    test: &[[u8; 3]],
    pixels_per_degree: f64,
) -> Flip {
    let [a, b] = [reference, test].map(|picture| -> Vec<Rgb> {
        picture.iter().map(|rgb| rgb.map(|v| f32::from(v) / 255.0)).collect()
    });
    flip(width, height, &a, &b, pixels_per_degree)
}

/// The exponent q_c of the paper.
const COLOR_EXPONENT: f64 = 0.7;
/// The exponent q_f of the paper.
const FEATURE_EXPONENT: f64 = 0.5;
/// Color differences up to p_c of the largest are spread over errors up to p_t.
const COLOR_KNEE: f64 = 0.4;
const ERROR_KNEE: f64 = 0.95;
/// Width of the feature detector, degrees.
const FEATURE_WIDTH: f64 = 0.082;

/// Contrast sensitivity of the channels Y, Cx and Cz (achromatic, red-green, blue-yellow) as sums
/// of Gaussians `a·√(π/b)·exp(−π²d²/b)`, d in degrees: pairs (a, b), table 1 of the paper.
const SENSITIVITY: [&[(f64, f64)]; 3] =
    [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
/// The widest b of all.
const WIDEST: f64 = 0.04;

/// The filters for one viewing distance.
struct Eye {
    /// For each channel the Gaussians, each with its weight; they sum to 1 in 2D.
    blur: [Vec<(f64, Vec<f64>)>; 3],
    gauss: Vec<f64>,
    edge: Vec<f64>,
    point: Vec<f64>,
}

/// A picture in the form that is compared.
struct Seen {
    /// Hunt-adjusted L*a*b*.
    color: Vec<[f64; 3]>,
    edge: Vec<f64>,
    point: Vec<f64>,
}

impl Eye {
    fn new(ppd: f64) -> Self {
        let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * ppd).ceil();
        let blur = SENSITIVITY.map(|terms| {
            let mut terms: Vec<_> = terms
                .iter()
                .map(|&(a, b)| {
                    let taps = kernel(radius, |x| (-PI * PI * (x / ppd).powi(2) / b).exp());
                    (a * (PI / b).sqrt(), taps)
                })
                .collect();
            let sum: f64 = terms.iter().map(|(a, k)| a * k.iter().sum::<f64>().powi(2)).sum();
            terms.iter_mut().for_each(|(a, _)| *a /= sum);
            terms
        });
        let sd = 0.5 * FEATURE_WIDTH * ppd;
        let radius = (3.0 * sd).ceil();
        let gauss = |x: f64| (-x * x / (2.0 * sd * sd)).exp();
        Self {
            blur,
            gauss: balanced(kernel(radius, gauss)),
            edge: balanced(kernel(radius, |x| -x * gauss(x))),
            point: balanced(kernel(radius, |x| (x * x / (sd * sd) - 1.0) * gauss(x))),
        }
    }

    fn see(&self, width: usize, height: usize, rgb: &[Rgb]) -> Seen {
        let opponent: Vec<[f64; 3]> = rgb
            .par_iter()
            .map(|rgb| opponent(xyz(rgb.map(|v| linear(f64::from(v).clamp(0.0, 1.0))))))
            .collect();
        let plane = |c: usize| -> Vec<f64> { opponent.iter().map(|v| v[c]).collect() };
        let blurred: [Vec<f64>; 3] = std::array::from_fn(|c| {
            let plane = plane(c);
            let mut sum = vec![0.0; plane.len()];
            for (weight, taps) in &self.blur[c] {
                let term = convolve(width, height, &plane, taps, taps);
                sum.iter_mut().zip(term).for_each(|(s, t)| *s += weight * t);
            }
            sum
        });
        let color = (0..rgb.len())
            .into_par_iter()
            .map(|i| {
                let rgb = from_xyz(from_opponent([0, 1, 2].map(|c| blurred[c][i])));
                hunt(rgb.map(|v| v.clamp(0.0, 1.0)))
            })
            .collect();
        let lightness: Vec<f64> = opponent.iter().map(|v| (v[0] + 16.0) / 116.0).collect();
        let feature = |taps: &[f64]| -> Vec<f64> {
            let x = convolve(width, height, &lightness, taps, &self.gauss);
            let y = convolve(width, height, &lightness, &self.gauss, taps);
            x.iter().zip(y).map(|(x, y)| x.hypot(y)).collect()
        };
        Seen { color, edge: feature(&self.edge), point: feature(&self.point) }
    }
}

/// A function at −radius … radius.
fn kernel(radius: f64, f: impl Fn(f64) -> f64) -> Vec<f64> {
    let r = radius as i32;
    (-r..=r).map(|x| f(f64::from(x))).collect()
}

/// A kernel normalised so that its positive taps sum to 1 and its negative ones, if any, to −1.
fn balanced(mut taps: Vec<f64>) -> Vec<f64> {
    let positive: f64 = taps.iter().filter(|t| **t > 0.0).sum();
    let negative: f64 = -taps.iter().filter(|t| **t < 0.0).sum::<f64>();
    taps.iter_mut()
        .for_each(|t| *t /= if *t > 0.0 { positive } else { negative.max(f64::MIN_POSITIVE) });
    taps
}

/// Convolves rows with one kernel and columns with another; beyond the border the last pixel
/// is repeated. (Like the reference, without flipping the kernels: only sizes of features matter.)
fn convolve(
    width: usize,
    height: usize,
    plane: &[f64],
    x_taps: &[f64],
    y_taps: &[f64],
) -> Vec<f64> {
    let at = |i: usize, tap: usize, taps: &[f64], side: usize| {
        (i + tap).saturating_sub(taps.len() / 2).min(side - 1)
    };
    let mut rows = vec![0.0; plane.len()];
    rows.par_chunks_mut(width).zip(plane.par_chunks(width)).for_each(|(out, row)| {
        for x in 0..width {
            out[x] = (0..x_taps.len()).map(|k| x_taps[k] * row[at(x, k, x_taps, width)]).sum();
        }
    });
    let mut out = vec![0.0; plane.len()];
    out.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
        for (k, &tap) in y_taps.iter().enumerate() {
            let row = at(y, k, y_taps, height) * width;
            out.iter_mut().zip(&rows[row..row + width]).for_each(|(o, v)| *o += tap * v);
        }
    });
    out
}

/// Maps differences to errors: those up to the knee get most of the range.
fn redistribute(difference: f64, most: f64) -> f64 {
    let knee = COLOR_KNEE * most;
    if difference < knee {
        ERROR_KNEE / knee * difference
    } else {
        ERROR_KNEE + (difference - knee) / (most - knee) * (1.0 - ERROR_KNEE)
    }
}

/// A distance for large colour differences: |ΔL| + √(Δa² + Δb²).
fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// Converts sRGB to linear.
fn linear(v: f64) -> f64 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// Converts linear sRGB to XYZ, in the exact fractions of the paper's code.
const TO_XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// White, linear (1, 1, 1), in XYZ.
fn white() -> [f64; 3] {
    TO_XYZ.map(|row| row.iter().sum())
}

fn xyz(rgb: [f64; 3]) -> [f64; 3] {
    TO_XYZ.map(|row| (0..3).map(|c| row[c] * rgb[c]).sum())
}

/// The inverse of [`xyz`], by Cramer's rule.
fn from_xyz(xyz: [f64; 3]) -> [f64; 3] {
    let columns: [[f64; 3]; 3] = std::array::from_fn(|c| TO_XYZ.map(|row| row[c]));
    let triple = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
        (0..3)
            .map(|i| {
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                a[i] * (b[j] * c[k] - b[k] * c[j])
            })
            .sum::<f64>()
    };
    let [r, g, b] = columns;
    let all = triple(r, g, b);
    [triple(xyz, g, b) / all, triple(r, xyz, b) / all, triple(r, g, xyz) / all]
}

/// Converts XYZ to Y Cx Cz, a linear cousin of L*a*b*.
fn opponent(xyz: [f64; 3]) -> [f64; 3] {
    let white = white();
    let [x, y, z] = [0, 1, 2].map(|c| xyz[c] / white[c]);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn from_opponent([l, cx, cz]: [f64; 3]) -> [f64; 3] {
    let white = white();
    let y = (l + 16.0) / 116.0;
    [(y + cx / 500.0) * white[0], y * white[1], (y - cz / 200.0) * white[2]]
}

/// Converts linear RGB to L*a*b* in which dark colours are less colourful (Hunt effect).
fn hunt(rgb: [f64; 3]) -> [f64; 3] {
    const DELTA: f64 = 6.0 / 29.0;
    let (xyz, white) = (xyz(rgb), white());
    let [x, y, z] = [0, 1, 2].map(|c| {
        let t = xyz[c] / white[c];
        if t > DELTA.powi(3) { t.cbrt() } else { t / (3.0 * DELTA * DELTA) + 4.0 / 29.0 }
    });
    let l = 116.0 * y - 16.0;
    [l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The reference computes in f32, with tabled rounding of its own.
    const F32: f64 = 2e-4;

    /// A picture with slopes, bands and blocks; `changed` moves colours in a block, a bar and a
    /// strip and sets one white pixel.
    fn picture(width: usize, height: usize, changed: bool) -> Vec<[u8; 3]> {
        let mut pixels = Vec::new();
        for y in 0..height {
            for x in 0..width {
                let mut r = (x * 5 + y * 3) % 256;
                let mut g = (x * x + y * 7) / 3 % 256;
                let mut b = (x / 4 + y / 4) % 2 * 180 + 20;
                if changed {
                    if (10..20).contains(&x) && (8..16).contains(&y) {
                        r = (r + 60) % 256;
                    }
                    if (30..34).contains(&x) {
                        g = (g + 25).min(255);
                    }
                    if y >= 24 {
                        b = b.saturating_sub(15);
                    }
                    if (x, y) == (40, 5) {
                        (r, g, b) = (255, 255, 255);
                    }
                }
                pixels.push([r as u8, g as u8, b as u8]);
            }
        }
        pixels
    }

    /// Numbers printed by the authors' own implementation, PyPI `flip-evaluator` 1.7, for these
    /// pictures ÷ 255 as float32:
    /// `evaluate(a, b, "LDR", inputsRGB=True, applyMagma=False, parameters={"ppd": …})`.
    #[test]
    fn agrees_with_the_authors_implementation() {
        let (width, height) = (48, 32);
        let a = picture(width, height, false);
        let b = picture(width, height, true);
        #[rustfmt::skip]
        let cases = [
            (PIXELS_PER_DEGREE, 0.135_261_01, [
                ((0, 0), 0.000_025_5), ((14, 11), 0.464_781_9), ((31, 20), 0.405_764_0),
                ((40, 5), 0.479_004_2), ((41, 6), 0.273_338_2), ((47, 31), 0.193_884_0),
                ((20, 8), 0.203_829_2),
            ]),
            (30.0, 0.117_583_64, [
                ((0, 0), 0.0), ((14, 11), 0.436_053_5), ((31, 20), 0.425_993_8),
                ((40, 5), 0.966_914_8), ((41, 6), 0.117_518_9), ((47, 31), 0.005_518_5),
                ((20, 8), 0.129_470_1),
            ]),
        ];
        for (ppd, mean, pixels) in cases {
            let flip = flip8(width, height, &a, &b, ppd);
            assert!((flip.mean - mean).abs() < F32, "ppd {ppd}: {} is not {mean}", flip.mean);
            for ((x, y), expected) in pixels {
                let found = f64::from(flip.map[y * width + x]);
                assert!((found - expected).abs() < F32, "ppd {ppd}, {x}, {y}: {found}, {expected}");
            }
        }
    }

    #[test]
    fn the_largest_differences_are_known() {
        // From the same implementation: black and white, and the pair that defines 1.
        let all = |rgb: Rgb| vec![rgb; 16];
        let of = |a, b| flip(4, 4, &all(a), &all(b), PIXELS_PER_DEGREE).mean;
        assert!((of([0.0; 3], [1.0; 3]) - 0.967_388_2).abs() < F32);
        assert!((of([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]) - 1.0).abs() < F32);
    }

    #[test]
    fn the_same_picture_differs_nowhere_and_order_does_not_matter() {
        let (a, b) = (picture(23, 17, false), picture(23, 17, true));
        let same = flip8(23, 17, &a, &a, PIXELS_PER_DEGREE);
        assert_eq!(same, Flip { map: vec![0.0; 23 * 17], mean: 0.0 });
        let there = flip8(23, 17, &a, &b, PIXELS_PER_DEGREE);
        assert!(there.mean > 100.0 * F32);
        assert_eq!(there, flip8(23, 17, &b, &a, PIXELS_PER_DEGREE));
        assert_eq!(flip(0, 0, &[], &[], PIXELS_PER_DEGREE).mean, 0.0);
    }
}
