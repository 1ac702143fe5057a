// The blur of `flood`: the light in the grid decays, flows between neighbours, and is shown (`blur.rs` of
// the library).

#import shared/class_at
#import shared/normal
#import shared/uniforms

override DECAY: f32;

// The direction of flow. Bit 0: along x or y; 2 or more: only from the neighbour after, 4 or more: only from the
// one before.
@group(0) @binding(1) var<uniform> step: u32;
@group(0) @binding(2) var<storage, read> before: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> after: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> light: array<vec4f>;

// Takes some light from every cell, and all of it from cells that are no longer open, or if history is
// rejected.
@compute @workgroup_size(8, 8)
fn decay(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    let left = max(after[i] - DECAY, vec4f(0.0));
    after[i] = select(vec4f(0.0), left, open(vec2i(id.xy)) && frame.history != HISTORY_NONE);
}

fn flow(own: vec4f, beside: vec2i, weight: f32) -> vec4f {
    if weight == 0.0 || !open(beside) {
        return vec4f(0.0);
    }
    return weight * (before[index(vec2u(beside))] - own);
}

// Moves every cell towards its neighbours along an axis. Solid cells neither give nor take.
@compute @workgroup_size(8, 8)
fn mix_neighbours(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let cell = vec2i(id.xy);
    let i = index(id.xy);
    if !open(cell) {
        after[i] = vec4f(0.0);
        return;
    }
    let next = select(vec2i(1, 0), vec2i(0, 1), (step & 1u) == 1u);
    var weights = vec2f(0.25);
    if step >= 2u {
        weights = select(vec2f(0.5, 0.0), vec2f(0.0, 0.5), step < 4u);
    }
    let own = before[i];
    // The sum of the two first: mirrored scenes give the same bits.
    after[i] = own + (flow(own, cell - next, weights.x) + flow(own, cell + next, weights.y));
}

// Shows the light of every open cell, and on solid ones the mean before their faces.
@compute @workgroup_size(8, 8)
fn show(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let cell = vec2i(id.xy);
    let i = index(id.xy);
    if open(cell) {
        light[i] = vec4f(after[i].rgb, 1.0);
        return;
    }
    var sum = vec3f(0.0);
    var faces = 0.0;
    for (var face = 0u; face < 4u; face++) {
        let beside = cell + normal(face);
        if open(beside) {
            sum += after[index(vec2u(beside))].rgb;
            faces += 1.0;
        }
    }
    light[i] = vec4f(sum / max(faces, 1.0), 1.0);
}
