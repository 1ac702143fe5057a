// The light of small sources, which neighbouring rows exchange in part before intervals are extended, for the
// reason in crates/lamplight/src/methods/holographic/prefilter.rs.

#import methods/holographic/interval

// Fraction of the difference between two rows that bundles along the axis exchange, and what the diagonal adds.
override EXCHANGED: f32;
override EXCHANGED_DIAGONAL: f32;

// The fraction that a bundle exchanges, of `bundles` from a row.
fn exchanged(bundle: u32, bundles: u32) -> f32 {
    let straight = 0.5 * f32(bundles - 1u);
    let slope = (f32(bundle) - straight) / straight;
    return EXCHANGED + EXCHANGED_DIAGONAL * slope * slope;
}

// The rows of a tile that exchange light with the row after them: points stand for both at the plane, and the bundle of
// one may meet a small source.
fn exchanging(in_points: vec2u, small: vec2u) -> vec2u {
    return in_points & row_after(in_points) & (small | row_after(small));
}

// Bits of rows as those of the rows before them.
fn row_after(rows: vec2u) -> vec2u {
    return (rows >> vec2u(1u)) | vec2u(rows.y << 31u, 0u);
}

// The light of a bundle of another row less a bundle's own, by the words of their intervals that hold it.
fn gained(own: vec2u, other: vec2u) -> vec3f {
    return light_of(other) - light_of(own);
}

fn light_of(words: vec2u) -> vec3f {
    return unpack(vec3u(words, 0u)).light;
}
