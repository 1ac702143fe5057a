//! Hashes and pseudorandom numbers for tests.

use fastrand::Rng;
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
    add(cells.normals().map(<[_]>::as_flattened).unwrap_or_default());
    for lamp in cells.lamps() {
        add(&[lamp.position[0], lamp.position[1], lamp.intensity, lamp.size]);
        add(&lamp.color);
    }
    hasher.finish()
}

/// A random number generator with a new seed in each run, or with that of `LAMPLIGHT_SEED`. Prints the seed, so
/// that failures can be reproduced.
pub fn seeded(test: &str) -> Rng {
    let given = std::env::var("LAMPLIGHT_SEED").ok().and_then(|s| s.parse().ok());
    let seed = given.unwrap_or_else(|| fastrand::u64(..));
    println!("{test}: LAMPLIGHT_SEED={seed}");
    Rng::with_seed(seed)
}

/// A random number in [from, to).
pub fn range(rng: &mut Rng, from: f32, to: f32) -> f32 {
    from + (to - from) * rng.f32()
}
