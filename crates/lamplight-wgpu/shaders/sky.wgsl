// What a ray sees that leaves the grid in a direction whose y component is `dy`.
fn sky(dy: f32) -> vec3f {
    return mix(frame.horizon, select(frame.ground, frame.zenith, dy < 0.0), abs(dy));
}
