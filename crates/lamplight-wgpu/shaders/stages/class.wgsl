// The classes of cells for rays of lamps: two bits per cell, sixteen cells of a 4×4 block per word, so that
// the next cells of a ray lie in the word of the last.

#import shared/class
#import shared/uniforms

@group(0) @binding(1) var matter: texture_2d<f32>;
@group(0) @binding(2) var<storage, read_write> classes: array<u32>;
// A counter that starts at 0 in every frame.
@group(0) @binding(3) var<storage, read_write> used: u32;

fn matter_class(at: vec2u) -> u32 {
    if outside(at) {
        return OUTSIDE;
    }
    return classify(textureLoad(matter, at, 0), 0.0);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let blocks = (frame.size + 3u) / 4u;
    if any(id.xy >= blocks) {
        return;
    }
    var word = 0u;
    for (var cell = 0u; cell < 16u; cell++) {
        word |= matter_class(4u * id.xy + vec2u(cell & 3u, cell >> 2u)) << (2u * cell);
    }
    classes[id.y * blocks.x + id.x] = word;
    if all(id.xy == vec2u(0u)) {
        used = 0u;
    }
}
