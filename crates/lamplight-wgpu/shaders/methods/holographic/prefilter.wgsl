// The light of small sources, which neighbouring rows exchange in part before intervals are extended, for the
// reason in crates/lamplight/src/methods/holographic/prefilter.rs.

#import methods/holographic/interval

// Fraction of the difference between two rows that they exchange.
override EXCHANGED: f32;

struct Traced {
    // The words of an interval that hold its radiance.
    words: vec2u,
    // Whether the row is open at the plane, and whether its bundle may meet a small source.
    open: bool,
    small: bool,
}

// The light that one lane gains from another.
fn gained(own: Traced, other: Traced) -> vec3f {
    if !own.open || !other.open || !(own.small || other.small) {
        return vec3f(0.0);
    }
    return EXCHANGED * (light_of(other.words) - light_of(own.words));
}

fn light_of(words: vec2u) -> vec3f {
    return unpack(vec3u(words, 0u)).light;
}
