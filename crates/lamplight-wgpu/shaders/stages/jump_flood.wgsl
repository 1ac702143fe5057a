// One pass of the jump flood: each cell keeps the nearest seed that it and eight cells `2^step` px
// away have found; of two at the same distance the one with the smaller packed position.

#import shared/uniforms

override NO_SEED: u32;

@group(0) @binding(1) var<uniform> step: u32;
@group(0) @binding(2) var<storage, read> before: array<u32>;
@group(0) @binding(3) var<storage, read_write> nearest: array<u32>;

fn distance2(at: vec2i, seed: u32) -> i32 {
    let away = vec2i(vec2u(seed & 0xffffu, seed >> 16u)) - at;
    return select(away.x * away.x + away.y * away.y, i32(0x7fffffff), seed == NO_SEED);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let at = vec2i(id.xy);
    let offset = 1i << step;
    var best = before[index(id.xy)];
    var best_distance = distance2(at, best);
    for (var y = -1; y <= 1; y++) {
        for (var x = -1; x <= 1; x++) {
            let other = at + vec2i(x, y) * offset;
            if !inside(other) {
                continue;
            }
            let seed = before[index(vec2u(other))];
            let distance = distance2(at, seed);
            if distance < best_distance || (distance == best_distance && seed < best) {
                best = seed;
                best_distance = distance;
            }
        }
    }
    nearest[index(id.xy)] = best;
}
