// Solid cells, as the host's texture has them.

@group(0) @binding(1) var matter: texture_2d<f32>;

fn solid(at: vec2i) -> bool {
    return textureLoad(matter, at, 0).a >= 1.0;
}
