// The distance field: px to the nearest occupied cell, centre to centre; FAR if there is none.

#import shared/uniforms

override NO_SEED: u32;
// Stands for infinity, which a shader may not rely on.
override FAR: f32;

@group(0) @binding(1) var<storage, read> nearest: array<u32>;
@group(0) @binding(2) var<storage, read_write> distance: array<f32>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let seed = nearest[index(id.xy)];
    let away = vec2f(vec2u(seed & 0xffffu, seed >> 16u)) - vec2f(id.xy);
    distance[index(id.xy)] = select(sqrt(away.x * away.x + away.y * away.y), FAR, seed == NO_SEED);
}
