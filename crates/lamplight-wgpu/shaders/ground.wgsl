// The grid as rays of lamps see it: two bits a cell, sixteen cells of a block of 4×4 to a word, so
// that a ray finds its next cells where it found the last.

@group(0) @binding(1) var matter: texture_2d<f32>;
@group(0) @binding(2) var<storage, read_write> kinds: array<u32>;
// What a frame counts from 0.
@group(0) @binding(3) var<storage, read_write> used: u32;

fn kind(at: vec2u) -> u32 {
    if outside(at) {
        return BEYOND;
    }
    let tint_opacity = textureLoad(matter, at, 0);
    if tint_opacity.a >= 1.0 {
        return WALL;
    }
    let seen = tint_opacity.a > 0.0 || any(tint_opacity.rgb != vec3f(1.0));
    return select(EMPTY, FOG, seen);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let blocks = (frame.size + 3u) / 4u;
    if any(id.xy >= blocks) {
        return;
    }
    var word = 0u;
    for (var cell = 0u; cell < 16u; cell++) {
        word |= kind(4u * id.xy + vec2u(cell & 3u, cell >> 2u)) << (2u * cell);
    }
    kinds[id.y * blocks.x + id.x] = word;
    if all(id.xy == vec2u(0u)) {
        used = 0u;
    }
}
