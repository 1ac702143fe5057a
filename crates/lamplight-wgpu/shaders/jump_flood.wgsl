// One pass of the jump flood: each cell keeps the nearest seed that it and eight cells `2^step` px
// away know; of two at the same distance the one with the smaller packed position.

override NONE: u32;

@group(0) @binding(1) var<uniform> step: u32;
@group(0) @binding(2) var<storage, read> known: array<u32>;
@group(0) @binding(3) var<storage, read_write> nearest: array<u32>;

fn distance2(at: vec2i, seed: u32) -> i32 {
    let away = vec2i(vec2u(seed & 0xffffu, seed >> 16u)) - at;
    return select(away.x * away.x + away.y * away.y, i32(0x7fffffff), seed == NONE);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let at = vec2i(id.xy);
    let offset = 1i << step;
    var best = known[index(id.xy)];
    var held = distance2(at, best);
    for (var y = -1; y <= 1; y++) {
        for (var x = -1; x <= 1; x++) {
            let other = at + vec2i(x, y) * offset;
            if !inside(other) {
                continue;
            }
            let seed = known[index(vec2u(other))];
            let offered = distance2(at, seed);
            if offered < held || (offered == held && seed < best) {
                best = seed;
                held = offered;
            }
        }
    }
    nearest[index(id.xy)] = best;
}
