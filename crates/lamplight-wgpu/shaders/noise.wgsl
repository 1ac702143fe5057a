// Where a pixel's first ray starts: `first_angle` of the library, to the bit.

const WHITE: u32 = 0u;
const BLUE: u32 = 1u;

override SIDE: u32;
override SLICES: u32;
override STEP_X: u32;
override STEP_Y: u32;
override GOLDEN: u32;

// The texture's slices below one another, a byte a texel, four to a word.
@group(0) @binding(1) var<storage, read> blue: array<u32>;

fn unit(bits: u32) -> f32 {
    return f32(bits >> 8u) * (1.0 / 16777216.0);
}

// A share of the step from ray to ray. Noise belongs to the world: it stays where it is when the grid
// moves over it.
fn first_angle(here: vec2u) -> f32 {
    let at = here + bitcast<vec2u>(frame.origin);
    if frame.noise == WHITE {
        return unit(pcg(vec4u(at, frame.number, frame.key)).x);
    }
    if frame.noise == BLUE {
        let lap = frame.number / SLICES + frame.key;
        let column = (at.x + ((lap * STEP_X) >> 26u)) % SIDE;
        let row = (at.y + ((lap * STEP_Y) >> 26u)) % SIDE;
        let texel = (frame.number % SLICES * SIDE + row) * SIDE + column;
        let byte = (blue[texel / 4u] >> (8u * (texel % 4u))) & 255u;
        return unit((byte << 24u) | (pcg(vec4u(at, frame.number, frame.key)).x >> 8u));
    }
    return unit(at.x * STEP_X + at.y * STEP_Y + frame.number * GOLDEN + frame.key);
}
