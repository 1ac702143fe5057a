// A direction, and what a traversal of the grid derives from it.

// The smallest positive normal number.
const MIN_POSITIVE: f32 = 1.17549435e-38;

struct Direction {
    along: vec2f,
    // 1 or −1: the side of the next edge, also where the component is 0.
    sign: vec2f,
    inverse: vec2f,
}

fn direction(magnitude: vec2f, sign: vec2f) -> Direction {
    // Never 1/0, so that no edge is 0·∞ px away.
    return Direction(sign * magnitude, sign, sign / max(magnitude, vec2f(MIN_POSITIVE)));
}
