//! The jitter of a pixel's rays: noise over pixel and frame.
//!
//! The rays of a pixel leave at a fixed angular stride, all rotated by its jitter (Cranley and
//! Patterson 1976). The same rotation everywhere would show as bands; a random one turns the error
//! into noise. The spread of that noise over pixels and frames decides how visible it is, and how
//! well blurs and means over frames remove it:
//!
//! - `white` hashes pixel, frame and seed with PCG4D (Jarzynski, Olano 2020, "Hash functions for GPU
//!   rendering"): independent everywhere.
//! - `blue` reads the project's texture of 16 slices of 64×64 px, made by `cargo xtask noise` (void
//!   and cluster with the spatio-temporal energy of Wolfe et al. 2022): neighbours in space and in
//!   time differ as much as they can. After 16 frames the texture is moved to another place.
//! - `golden` is a lattice: Roberts' R2 sequence (2018) over the pixel, plus frame × 1/φ.
//!
//! All of it is 32-bit integer arithmetic, so that a shader gives the same bits.

use crate::settings::Noise;

/// Side of a slice of the texture, px.
pub const SIDE: u32 = 64;
/// Slices of the texture, frames.
pub const FRAMES: u32 = 16;

const HEADER: usize = b"P5\n64 1024\n255\n".len();
/// The slices below one another, as a picture: a header, then a byte a pixel.
static TEXTURE: &[u8; HEADER + (SIDE * SIDE * FRAMES) as usize] = include_bytes!("blue_noise.pgm");

/// 2³²/g and 2³²/g², with g = 1.3247… the root of g³ = g + 1: R2's steps in x and y.
pub const R2: [u32; 2] = [3_242_174_889, 2_447_445_414];
/// 2³²/φ, the golden ratio's step from frame to frame.
pub const GOLDEN: u32 = 2_654_435_769;

/// Returns the blue-noise texture: its slices below one another, row by row, a byte a texel.
pub fn blue() -> &'static [u8] {
    &TEXTURE[HEADER..]
}

/// Returns the jitter of a pixel in a frame, as a fraction of the stride from ray to ray (or of the
/// circle): in [0, 1), uniform over pixels, frames and seeds.
#[inline]
pub fn jitter(noise: Noise, x: u32, y: u32, frame: u32, seed: u64) -> f32 {
    let key = fold(seed);
    match noise {
        Noise::White => unit(hash([x, y, frame, key])),
        Noise::Blue => {
            // Every 16 frames and every seed the texture lies elsewhere.
            let lap = (frame / FRAMES).wrapping_add(key);
            let shift = |step: u32| lap.wrapping_mul(step) >> 26;
            let column = x.wrapping_add(shift(R2[0])) % SIDE;
            let row = y.wrapping_add(shift(R2[1])) % SIDE;
            let slice = frame % FRAMES;
            let texel = TEXTURE[HEADER + ((slice * SIDE + row) * SIDE + column) as usize];
            // The texture's 256 steps would show in means over many frames: hash what lies below.
            unit(u32::from(texel) << 24 | hash([x, y, frame, key]) >> 8)
        }
        Noise::Golden => {
            let place = x.wrapping_mul(R2[0]).wrapping_add(y.wrapping_mul(R2[1]));
            unit(place.wrapping_add(frame.wrapping_mul(GOLDEN)).wrapping_add(key))
        }
    }
}

/// Returns the jitter of a face at a place along its wall, whatever the noise: few rays of a face find a small light that
/// shines along it, and neighbours on a lattice find it evenly, so that their mean is neither black nor too bright.
#[inline]
pub fn jitter_along(along: u32, frame: u32, seed: u64) -> f32 {
    // From somewhere on: rays that run exactly along a face would be ties.
    let first = R2[1].wrapping_add(fold(seed)).wrapping_add(frame.wrapping_mul(R2[0]));
    unit(along.wrapping_mul(GOLDEN).wrapping_add(first))
}

/// Mixes a seed into 32 bits: seeds that differ by 1 end up far apart.
#[inline]
pub fn fold(seed: u64) -> u32 {
    (seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32) as u32
}

/// Returns PCG4D's first number.
#[inline]
fn hash(v: [u32; 4]) -> u32 {
    let [mut x, mut y, mut z, mut w] =
        v.map(|v| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let mut stir = || {
        x = x.wrapping_add(y.wrapping_mul(w));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        w = w.wrapping_add(y.wrapping_mul(z));
        [&mut x, &mut y, &mut z, &mut w].into_iter().for_each(|v| *v ^= *v >> 16);
    };
    stir();
    stir();
    x
}

/// Returns the upper 24 bits as a number in [0, 1): an f32 holds no more.
#[inline]
fn unit(bits: u32) -> f32 {
    const STEP: f32 = 1.0 / (1 << 24) as f32;
    (bits >> 8) as f32 * STEP
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const ALL: [Noise; 3] = [Noise::White, Noise::Blue, Noise::Golden];

    /// A seed that is new in each run, printed so that a failure can be repeated.
    fn new_seed() -> u64 {
        let seed = fastrand::u64(..);
        println!("seed {seed}");
        seed
    }

    /// Pearson's statistic over 64 equal bins: 63 ± 11 for independent uniform numbers.
    fn chi_square(numbers: impl Iterator<Item = f32>) -> f64 {
        let mut bins = [0u32; 64];
        numbers.for_each(|v| bins[(v * 64.0) as usize] += 1);
        let mean = f64::from(bins.iter().sum::<u32>()) / 64.0;
        bins.iter().map(|&n| (f64::from(n) - mean).powi(2) / mean).sum()
    }
    /// The chance that uniform numbers exceed it is under 10⁻⁹ (χ² with 63 degrees of freedom).
    const CHI_SQUARE_LIMIT: f64 = 150.0;

    fn picture(noise: Noise, frame: u32, seed: u64) -> impl Iterator<Item = f32> {
        (0..SIDE * SIDE).map(move |i| jitter(noise, i % SIDE, i / SIDE, frame, seed))
    }

    #[test]
    fn is_uniform_over_pixels_frames_and_seeds() {
        let seed = new_seed();
        for noise in ALL {
            let pixels = chi_square(picture(noise, 7, seed));
            let frames = chi_square((0..4096).map(|f| jitter(noise, 31, 17, f, seed)));
            let seeds = chi_square((0..4096).map(|s| jitter(noise, 5, 9, 2, seed ^ s)));
            println!("{noise:?}: pixels {pixels:.1}, frames {frames:.1}, seeds {seeds:.1}");
            assert!(pixels < CHI_SQUARE_LIMIT, "{noise:?} over pixels: {pixels}");
            assert!(frames < CHI_SQUARE_LIMIT, "{noise:?} over frames: {frames}");
            assert!(seeds < CHI_SQUARE_LIMIT, "{noise:?} over seeds: {seeds}");
        }
        let bent = chi_square(picture(Noise::White, 7, seed).map(|v| v.powf(1.2)));
        assert!(bent > CHI_SQUARE_LIMIT, "numbers that are not uniform pass: {bent}");
    }

    #[test]
    fn every_slice_of_the_texture_holds_every_value_equally_often() {
        assert!(TEXTURE.starts_with(b"P5\n64 1024\n255\n"));
        for slice in TEXTURE[HEADER..].chunks((SIDE * SIDE) as usize) {
            let mut count = [0u32; 256];
            slice.iter().for_each(|&v| count[usize::from(v)] += 1);
            assert_eq!(count, [SIDE * SIDE / 256; 256]);
        }
    }

    /// Power at a frequency, 1 on average for white noise of variance 1/12.
    fn power(numbers: &[(f64, f32)], frequency: f64) -> f64 {
        let (mut re, mut im) = (0.0, 0.0);
        for &(phase, v) in numbers {
            let (sin, cos) = (TAU * phase * frequency).sin_cos();
            re += cos * (f64::from(v) - 0.5);
            im += sin * (f64::from(v) - 0.5);
        }
        12.0 * (re * re + im * im) / numbers.len() as f64
    }

    /// Mean power of a picture at up to 8 periods a slice (an eighth of the range), white = 1.
    fn low_power_in_space(noise: Noise, frame: u32, seed: u64) -> f64 {
        let picture: Vec<f32> = picture(noise, frame, seed).collect();
        let side = SIDE as usize;
        let (mut sum, mut count) = (0.0, 0);
        for fy in -8i32..=8 {
            for fx in 0..=8i32 {
                if fx * fx + fy * fy == 0 || fx * fx + fy * fy > 64 {
                    continue;
                }
                let phase = |i: usize| {
                    let (x, y) = ((i % side) as i32, (i / side) as i32);
                    f64::from((x * fx + y * fy).rem_euclid(SIDE as i32)) / f64::from(SIDE)
                };
                let numbers: Vec<_> =
                    picture.iter().enumerate().map(|(i, &v)| (phase(i), v)).collect();
                sum += power(&numbers, 1.0);
                count += 1;
            }
        }
        sum / f64::from(count)
    }

    /// Mean power of single pixels over 16 frames at 1 and 2 periods, white = 1.
    fn low_power_in_time(noise: Noise, seed: u64) -> f64 {
        let mut sum = 0.0;
        for i in 0..SIDE * SIDE {
            let numbers: Vec<_> = (0..FRAMES)
                .map(|f| {
                    let phase = f64::from(f) / f64::from(FRAMES);
                    (phase, jitter(noise, i % SIDE, i / SIDE, f, seed))
                })
                .collect();
            sum += power(&numbers, 1.0) + power(&numbers, 2.0);
        }
        sum / f64::from(2 * SIDE * SIDE)
    }

    /// Most low-frequency power over space that counts as blue: several times what void and cluster
    /// leaves, and a hundredth of white's.
    const BLUE_IN_SPACE: f64 = 0.01;
    /// Power over time, where slices share their energy with space.
    const BLUE_IN_TIME: f64 = 0.15;

    #[test]
    fn blue_is_blue_in_space_and_white_is_not() {
        let seed = new_seed();
        for frame in 0..FRAMES {
            let blue = low_power_in_space(Noise::Blue, frame, seed);
            println!("slice {frame}: low frequencies have {blue:.4} of white's power");
            assert!(blue < BLUE_IN_SPACE, "slice {frame}: {blue}");
        }
        let white = low_power_in_space(Noise::White, 0, seed);
        assert!(white > 50.0 * BLUE_IN_SPACE, "white noise passes for blue: {white}");
    }

    #[test]
    fn blue_is_blue_in_time_and_white_is_not() {
        let seed = new_seed();
        let blue = low_power_in_time(Noise::Blue, seed);
        let white = low_power_in_time(Noise::White, seed);
        println!("low frequencies over time: blue {blue:.3}, white {white:.3}");
        assert!(blue < BLUE_IN_TIME, "{blue}");
        assert!((white - 1.0).abs() < 0.1, "white noise is white: {white}");
    }

    #[test]
    fn seeds_and_laps_move_the_texture() {
        for noise in ALL {
            let here: Vec<f32> = picture(noise, 0, 0).collect();
            for (frame, seed) in [(0, 1), (16, 0), (32, 0), (1, 0)] {
                let there: Vec<f32> = picture(noise, frame, seed).collect();
                let same = here.iter().zip(&there).filter(|(a, b)| (*a - *b).abs() < 1e-3).count();
                assert!(same < 100, "{noise:?}, frame {frame}, seed {seed}: {same} of 4096 alike");
            }
        }
    }

    #[test]
    fn takes_any_argument() {
        for noise in ALL {
            let v = jitter(noise, u32::MAX, u32::MAX, u32::MAX, u64::MAX);
            assert!((0.0..1.0).contains(&v));
        }
    }
}
