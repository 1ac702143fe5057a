//! Pseudorandom numbers from a seed, the same on every machine.

/// The generator xorshift64* (Vigna 2016), whose state is one word.
#[derive(Clone, Debug)]
pub(crate) struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        // Similar seeds have different states. The state must not be 0.
        let mixed = (seed ^ 0x9e37_79b9_7f4a_7c15).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        Self((mixed ^ (mixed >> 29)) | 1)
    }

    #[inline]
    pub fn bits(&mut self) -> u32 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 32) as u32
    }

    /// A number from 0 to `n` − 1.
    #[inline]
    pub fn below(&mut self, n: u32) -> u32 {
        ((u64::from(self.bits()) * u64::from(n)) >> 32) as u32
    }

    /// `true` with probability 1 / `n`.
    #[inline]
    pub fn once_in(&mut self, n: u32) -> bool {
        self.below(n) == 0
    }

    /// A number from `from` to `to`.
    pub fn range(&mut self, from: f32, to: f32) -> f32 {
        from + (to - from) * (self.bits() >> 8) as f32 / 16_777_216.0
    }
}
