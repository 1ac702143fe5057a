#import shared/uniforms

// The radiance of the sky, seen along a ray whose direction has the y component `dy`.
fn sky(dy: f32) -> vec3f {
    return mix(frame.horizon, select(frame.ground, frame.zenith, dy < 0.0), abs(dy));
}
