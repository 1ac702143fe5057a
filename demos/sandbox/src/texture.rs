//! Noise for rock, floors and backdrops. It depends only on the position and the seed.

/// White noise, 0 to 1.
pub(crate) fn hash(x: i32, y: i32, seed: u32) -> f32 {
    let mut h = (x as u32).wrapping_mul(0x9e37_79b1)
        ^ (y as u32).wrapping_mul(0x85eb_ca6b)
        ^ seed.wrapping_mul(0xc2b2_ae35);
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    ((h ^ (h >> 15)) >> 8) as f32 / 16_777_216.0
}

/// Value noise, 0 to 1, smooth, with features of about one unit.
pub(crate) fn noise(x: f32, y: f32, seed: u32) -> f32 {
    let (left, top) = (x.floor(), y.floor());
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (fx, fy) = (ease(x - left), ease(y - top));
    let at = |dx: i32, dy: i32| hash(left as i32 + dx, top as i32 + dy, seed);
    let above = at(0, 0) + (at(1, 0) - at(0, 0)) * fx;
    let below = at(0, 1) + (at(1, 1) - at(0, 1)) * fx;
    above + (below - above) * fy
}

/// Four octaves of [`noise`], 0 to 1.
pub(crate) fn cloud(x: f32, y: f32, seed: u32) -> f32 {
    let octave = |k: u32| {
        let scale = (1 << k) as f32;
        noise(x * scale, y * scale, seed.wrapping_add(k)) / scale
    };
    (0..4).map(octave).sum::<f32>() / 1.875
}
