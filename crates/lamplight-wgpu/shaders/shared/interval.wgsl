// Intervals: the radiance that a segment of a ray adds, and its transmittance.

struct Interval {
    light: vec3f,
    transmittance: vec3f,
}

// An interval through empty space.
fn nothing() -> Interval {
    return Interval(vec3f(0.0), vec3f(1.0));
}

// Two intervals, `a` in front of `b`.
fn then(a: Interval, b: Interval) -> Interval {
    return Interval(fma(a.transmittance, b.light, a.light), a.transmittance * b.transmittance);
}

fn mean(a: Interval, b: Interval) -> Interval {
    return Interval((a.light + b.light) * 0.5, (a.transmittance + b.transmittance) * 0.5);
}
