// What the cells are to the quadrants: a bit a cell for each of three kinds, slab by slab along both
// axes, 32 rows a word. What surfaces received is forgotten.

override MATTER: u32;
override FRACTION: u32;
override GLOWING: u32;

@group(0) @binding(2) var emission: texture_2d<f32>;
@group(0) @binding(3) var matter: texture_2d<f32>;
@group(0) @binding(4) var<storage, read> sent: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> bits: array<u32>;
@group(0) @binding(6) var<storage, read_write> received: array<vec2u>;

fn glows(at: vec2u) -> bool {
    if any(textureLoad(emission, at, 0).rgb != vec3f(0.0)) {
        return true;
    }
    var glows = false;
    for (var face = 0u; face < 4u && sweep.sends == 1u; face++) {
        glows = glows || any(unpack_rgb(sent[4u * index(at) + face]) != vec3f(0.0));
    }
    return glows;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let slab = id.x;
    let words = (sweep.rows + 31u) / 32u;
    if slab >= sweep.depth || id.y >= words {
        return;
    }
    var found = vec3u(0u);
    for (var bit = 0u; bit < 32u && 32u * id.y + bit < sweep.rows; bit++) {
        let at = cell_of(slab, 32u * id.y + bit);
        let tint_opacity = textureLoad(matter, at, 0);
        if any(tint_opacity != vec4f(1.0, 1.0, 1.0, 0.0)) {
            found |= vec3u(1u, u32(tint_opacity.a < 1.0), u32(glows(at))) << vec3u(bit);
        }
        if sweep.axis == 0u {
            for (var face = 0u; face < 4u; face++) {
                received[4u * index(at) + face] = vec2u(0u);
            }
        }
    }
    let place = sweep.bits + slab * words + id.y;
    bits[place + MATTER * sweep.depth * words] = found.x;
    bits[place + FRACTION * sweep.depth * words] = found.y;
    bits[place + GLOWING * sweep.depth * words] = found.z;
}
