// `flood`: what the grid holds fades, flows between neighbours, and is seen (`blur.rs` of the library).

override DECAY: f32;

// How light flows: along x or y, and whether to both sides, from the one after or from the one before.
@group(0) @binding(1) var<uniform> step: u32;
@group(0) @binding(2) var<storage, read> before: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> after: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> light: array<vec4f>;

// Takes some light from every cell, and all of it from those that are no longer open, or when the frames
// before are forgotten.
@compute @workgroup_size(8, 8)
fn decay(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    let left = max(after[i] - DECAY, vec4f(0.0));
    after[i] = select(vec4f(0.0), left, open(vec2i(id.xy)) && frame.memory != NOTHING);
}

fn flow(own: vec4f, beside: vec2i, share: f32) -> vec4f {
    if share == 0.0 || !open(beside) {
        return vec4f(0.0);
    }
    return share * (before[index(vec2u(beside))] - own);
}

// Moves every cell towards its neighbours along an axis. Walls neither give nor take.
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
    var shares = vec2f(0.25);
    if step >= 2u {
        shares = select(vec2f(0.5, 0.0), vec2f(0.0, 0.5), step < 4u);
    }
    let own = before[i];
    // The sum of the two first: mirrored scenes give the same bits.
    after[i] = own + (flow(own, cell - next, shares.x) + flow(own, cell + next, shares.y));
}

// What every cell holds; in walls, which hold nothing, the mean of what lies before their faces.
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
