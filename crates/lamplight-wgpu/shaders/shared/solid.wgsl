// Solid cells, as the host's texture has them.

#import shared/normal
#import shared/uniforms

@group(0) @binding(1) var matter: texture_2d<f32>;

fn solid(at: vec2i) -> bool {
    return textureLoad(matter, at, 0).a >= 1.0;
}

// Returns whether a face (left, right, top, bottom) looks at a cell of the grid that is not solid.
fn exposed(at: vec2u, face: u32) -> bool {
    let front = vec2i(at) + normal(face);
    return inside(front) && !solid(front);
}
