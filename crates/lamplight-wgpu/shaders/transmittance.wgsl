// How much light gets through matter, as on the CPU.

// Logarithm that stands for "lets nothing through"; finite, so that 0 px of it still pass light.
override LOG_OF_ZERO: f32;

// Natural logarithm of the transmittance of one px.
fn log_transmittance(tint_opacity: vec4f) -> vec3f {
    let through = (1.0 - tint_opacity.a) * tint_opacity.rgb;
    let logarithm = select(log(through), vec3f(LOG_OF_ZERO), through <= vec3f(0.0));
    return max(logarithm, vec3f(LOG_OF_ZERO));
}
