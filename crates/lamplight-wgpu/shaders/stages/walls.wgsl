// The light that solid cells show: it penetrates them from their faces inwards, and emission is added.

#import shared/solid
#import shared/uniforms

@group(0) @binding(2) var<uniform> step: u32;
@group(0) @binding(3) var emission: texture_2d<f32>;
// 0 if a cell has not been reached, otherwise 1 + its ring.
@group(0) @binding(4) var<storage, read> before: array<u32>;
@group(0) @binding(5) var<storage, read_write> after: array<u32>;
@group(0) @binding(6) var<storage, read_write> light: array<vec4f>;

fn open(at: vec2i) -> bool {
    return inside(at) && !solid(at);
}

@compute @workgroup_size(8, 8)
fn begin(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let at = vec2i(id.xy);
    let i = index(id.xy);
    let exposed = open(at - vec2i(1, 0)) || open(at + vec2i(1, 0))
        || open(at - vec2i(0, 1)) || open(at + vec2i(0, 1));
    after[i] = select(0u, 1u, solid(at) && exposed);
    if solid(at) && !exposed {
        light[i] = vec4f(0.0, 0.0, 0.0, 1.0);
    }
}

// Cells behind the ring before take the mean of their neighbours in the rings before.
@compute @workgroup_size(8, 8)
fn sink(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let at = vec2i(id.xy);
    let i = index(id.xy);
    after[i] = before[i];
    if before[i] != 0u || !solid(at) {
        return;
    }
    var sum = vec3f(0.0);
    var count = 0.0;
    var is_next = false;
    for (var y = -1; y <= 1; y++) {
        for (var x = -1; x <= 1; x++) {
            let other = at + vec2i(x, y);
            if !inside(other) {
                continue;
            }
            let j = index(vec2u(other));
            if before[j] != 0u {
                sum += light[j].rgb;
                count += 1.0;
                is_next = is_next || before[j] == step;
            }
        }
    }
    if is_next {
        after[i] = step + 1u;
        light[i] = vec4f(sum / count, 1.0);
    }
}

@compute @workgroup_size(8, 8)
fn finish(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) || !solid(vec2i(id.xy)) {
        return;
    }
    let i = index(id.xy);
    let depth = f32(max(before[i], 1u) - 1u);
    let fade = max(1.0 - depth / (frame.wall_depth + 1.0), 0.0);
    light[i] = vec4f(light[i].rgb * fade + textureLoad(emission, id.xy, 0).rgb, 1.0);
}
