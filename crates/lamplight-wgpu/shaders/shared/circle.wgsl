// Directions evenly around the circle, as symmetric as the circle itself: each is computed in the first
// octant, so that mirror images are equal to the bit (`circle.rs` of the library).

#import shared/direction

// Direction `i` of `n`: 0 is +x, then towards +y.
fn direction_of(i: u32, n: u32) -> Direction {
    let octant = 8u * i / n;
    let rest = 8u * i % n;
    let part = select(rest, n - rest, (octant & 1u) == 1u);
    // cos and sin of π/4.
    var magnitude = vec2f(0.70710678);
    if part != n {
        // Taylor, more precise than rounding: the built-in functions may be far less precise.
        let x = 0.78539816 * (f32(part) / f32(n));
        let y = x * x;
        let sine = x + x * y * (-1.6666667e-1 + y * (8.3333333e-3 + y * (-1.9841270e-4 + y * 2.7557319e-6)));
        let cosine = 1.0 - 0.5 * y
            + y * y * (4.1666667e-2 + y * (-1.3888889e-3 + y * (2.4801587e-5 - y * 2.7557319e-7)));
        magnitude = vec2f(cosine, sine);
    }
    // Octants 1, 2, 5 and 6 are steep; 2 to 5 point to −x, 4 to 7 to −y.
    let steep = ((octant + 1u) & 2u) != 0u;
    let back = ((octant + 2u) & 4u) != 0u;
    let up = (octant & 4u) != 0u;
    let sign = select(vec2f(1.0), vec2f(-1.0), vec2<bool>(back, up));
    return direction(select(magnitude, magnitude.yx, steep), sign);
}
