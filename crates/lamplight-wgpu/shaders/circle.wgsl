// Ways evenly round the circle, as symmetric as the circle itself: each is worked out in the first
// eighth, so that images of one another are so to the bit (`circle.rs` of the library).

// Way `i` of `n`: 0 is +x, on towards +y.
fn way_of(i: u32, n: u32) -> Way {
    let eighth = 8u * i / n;
    let rest = 8u * i % n;
    let part = select(rest, n - rest, (eighth & 1u) == 1u);
    // cos and sin of π/4.
    var magnitude = vec2f(0.70710678);
    if part != n {
        // Taylor, to less than rounding: shaders' own may be off by far more.
        let x = 0.78539816 * (f32(part) / f32(n));
        let y = x * x;
        let sine = x + x * y * (-1.6666667e-1 + y * (8.3333333e-3 + y * (-1.9841270e-4 + y * 2.7557319e-6)));
        let cosine = 1.0 - 0.5 * y
            + y * y * (4.1666667e-2 + y * (-1.3888889e-3 + y * (2.4801587e-5 - y * 2.7557319e-7)));
        magnitude = vec2f(cosine, sine);
    }
    // Eighths 1, 2, 5 and 6 are steep; 2 to 5 go back, 4 to 7 up.
    let steep = ((eighth + 1u) & 2u) != 0u;
    let back = ((eighth + 2u) & 4u) != 0u;
    let up = (eighth & 4u) != 0u;
    let sign = select(vec2f(1.0), vec2f(-1.0), vec2<bool>(back, up));
    return way(select(magnitude, magnitude.yx, steep), sign);
}
