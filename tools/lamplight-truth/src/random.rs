//! Random numbers that depend only on their key, never on the thread that draws them.

/// The odd constant nearest to 2⁶⁴ ÷ the golden ratio: the step of SplitMix64.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

/// A keyed stream of random numbers (SplitMix64; Steele, Lea and Flood 2014).
pub struct Random(u64);

impl Random {
    /// The stream of a key. The same key gives the same numbers, different keys unrelated ones.
    pub fn new(seed: u64, cell: u64, path: u64) -> Self {
        Self(mix(mix(mix(seed) ^ cell).wrapping_add(STEP) ^ path))
    }

    /// The next number, uniform in [0, 1), in steps of 2⁻⁵³.
    #[inline]
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(STEP);
        (mix(self.0) >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }
}

/// Scrambles 64 bits one to one (Stafford's mix 13).
#[inline]
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_are_uniform_and_unrelated() {
        const N: usize = 100_000;
        // Four standard errors of a mean of uniform numbers, 1/√(12 N), and of a product.
        let bound = 4.0 / (12.0 * N as f64).sqrt();
        for (a, b) in [((1, 0, 0), (1, 0, 1)), ((1, 5, 0), (1, 6, 0)), ((1, 0, 7), (2, 0, 7))] {
            let (mut a, mut b) = (Random::new(a.0, a.1, a.2), Random::new(b.0, b.1, b.2));
            let (mut mean, mut product) = (0.0, 0.0);
            for _ in 0..N {
                let (u, v) = (a.unit(), b.unit());
                assert!((0.0..1.0).contains(&u));
                mean += u / N as f64;
                product += (u - 0.5) * (v - 0.5) / N as f64;
            }
            assert!((mean - 0.5).abs() < bound, "mean {mean}");
            assert!(product.abs() < bound, "product {product}");
        }
    }

    #[test]
    fn first_numbers_of_neighbouring_keys_are_uniform() {
        const N: u64 = 100_000;
        let bound = 4.0 / (12.0 * N as f64).sqrt();
        let mean = (0..N).map(|i| Random::new(3, i / 300, i % 300).unit()).sum::<f64>() / N as f64;
        assert!((mean - 0.5).abs() < bound, "mean {mean}");
    }
}
