// Intervals: what a stretch of a ray adds to light and what it lets through.

struct Interval {
    light: vec3f,
    through: vec3f,
}

fn nothing() -> Interval {
    return Interval(vec3f(0.0), vec3f(1.0));
}

// Front to back: ⟨a⟩ ⊕ ⟨b⟩.
fn then(a: Interval, b: Interval) -> Interval {
    return Interval(fma(a.through, b.light, a.light), a.through * b.through);
}

// Two ways and the mean of both.
fn mean(a: Interval, b: Interval) -> Interval {
    return Interval((a.light + b.light) * 0.5, (a.through + b.through) * 0.5);
}
