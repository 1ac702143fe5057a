// Extinction of matter, as on the CPU: T = exp(−σ_t·d).

// Extinction that stands for "opaque". It is finite, so that 0 px of it still transmit light.
override MAX_OPTICAL_DEPTH: f32;

// The extinction coefficient σ_t per px.
fn extinction_of(tint_opacity: vec4f) -> vec3f {
    let transmittance = (1.0 - tint_opacity.a) * tint_opacity.rgb;
    let depth = select(-log(transmittance), vec3f(MAX_OPTICAL_DEPTH), transmittance <= vec3f(0.0));
    // Thin media take the series, because GPUs compute logarithms near 0 with few digits.
    let absorbed = 1.0 - transmittance;
    let series = absorbed * (1.0 + absorbed * (0.5 + absorbed * (0.33333334 + absorbed * 0.25)));
    return min(select(depth, series, absorbed < vec3f(0.02)), vec3f(MAX_OPTICAL_DEPTH));
}
