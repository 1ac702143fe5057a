// atan2(y, x) in −π to π, within 3e-7 (Moshier's Cephes, `atanf.c`), as on the CPU: the built-in function
// may be far less precise. 0 at the origin.
fn angle(at: vec2f) -> f32 {
    let magnitude = abs(at);
    let small = min(magnitude.x, magnitude.y);
    let large = max(magnitude.x, magnitude.y);
    // Beyond tan(π/8) the argument is rotated back by π/4.
    let rotated = small > large * 0.41421357;
    let top = select(small, small - large, rotated);
    let bottom = max(select(large, small + large, rotated), 1.17549435e-38);
    let t = top / bottom;
    let z = t * t;
    let p = ((z * 8.0537445e-2 - 1.3877681e-1) * z + 1.9977711e-1) * z - 3.333295e-1;
    var a = p * z * t + t + select(0.0, 0.78539816, rotated);
    a = select(a, 1.5707964 - a, magnitude.y > magnitude.x);
    a = select(a, 3.1415927 - a, at.x < 0.0);
    return select(a, -a, at.y < 0.0);
}
