// The jitter of a pixel's rays: the same numbers as the library's `noise.rs`, to the bit.

#import shared/pcg
#import shared/uniforms

const WHITE: u32 = 0u;
const BLUE: u32 = 1u;

override SIDE: u32;
override SLICES: u32;
override STEP_X: u32;
override STEP_Y: u32;
override GOLDEN: u32;

// Slices of the blue-noise texture below one another, one byte per texel, four per word.
@group(0) @binding(1) var<storage, read> blue: array<u32>;

fn unit(bits: u32) -> f32 {
    return f32(bits >> 8u) * (1.0 / 16777216.0);
}

// A fraction of the angle between rays. The noise is attached to the world, not to the grid, so that it
// stays in place when the grid moves.
fn jitter(here: vec2u) -> f32 {
    let at = here + bitcast<vec2u>(frame.origin);
    if frame.noise == WHITE {
        return unit(pcg(vec4u(at, frame.number, frame.seed)).x);
    }
    if frame.noise == BLUE {
        let lap = frame.number / SLICES + frame.seed;
        let column = (at.x + ((lap * STEP_X) >> 26u)) % SIDE;
        let row = (at.y + ((lap * STEP_Y) >> 26u)) % SIDE;
        let texel = (frame.number % SLICES * SIDE + row) * SIDE + column;
        let byte = (blue[texel / 4u] >> (8u * (texel % 4u))) & 255u;
        return unit((byte << 24u) | (pcg(vec4u(at, frame.number, frame.seed)).x >> 8u));
    }
    return unit(at.x * STEP_X + at.y * STEP_Y + frame.number * GOLDEN + frame.seed);
}

// The jitter of a face at a place along its wall, whatever the noise.
fn jitter_along(here: u32, axis: u32) -> f32 {
    let along = here + bitcast<u32>(frame.origin[axis]);
    return unit(along * GOLDEN + frame.number * STEP_X + STEP_Y + frame.seed);
}
