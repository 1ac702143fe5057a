// The fraction of light that a medium of an optical depth absorbs, 1 − e^−τ. Thin media take it by its series,
// because GPUs compute 1 − exp(−τ) with few digits there.
fn absorptance(depth: vec3f) -> vec3f {
    let series = depth * (1.0 - depth * (0.5 - depth * (0.16666667 - depth * 0.041666668)));
    return select(1.0 - exp(-depth), series, depth < vec3f(0.02));
}
