//! Hashes and pseudorandom numbers for tests.

use lamplight::Cells;
use std::hash::{DefaultHasher, Hash, Hasher};

/// A hash over every bit of the cells and lamps.
pub fn hash(cells: &Cells) -> u64 {
    let mut hasher = DefaultHasher::new();
    let mut add = |values: &[f32]| values.iter().for_each(|v| v.to_bits().hash(&mut hasher));
    add(cells.opacity());
    add(cells.emission().as_flattened());
    add(cells.tint().as_flattened());
    add(cells.albedo().as_flattened());
    add(cells.color().map(<[_]>::as_flattened).unwrap_or_default());
    for lamp in cells.lamps() {
        add(&[lamp.position[0], lamp.position[1], lamp.intensity, lamp.size]);
        add(&lamp.color);
    }
    hasher.finish()
}

/// The generator splitmix64.
pub struct Rng(pub u64);

impl Rng {
    /// Seeds from the clock or from `LAMPLIGHT_SEED`, and prints the seed, so that failures can be reproduced.
    pub fn new(test: &str) -> Self {
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        let seed = std::env::var("LAMPLIGHT_SEED").ok().and_then(|s| s.parse().ok());
        let seed = seed.unwrap_or_else(|| now.map_or(1, |t| t.as_nanos() as u64));
        println!("{test}: LAMPLIGHT_SEED={seed}");
        Self(seed)
    }

    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    pub fn range(&mut self, from: f32, to: f32) -> f32 {
        from + (to - from) * (self.bits() >> 40) as f32 / (1 << 24) as f32
    }
}
