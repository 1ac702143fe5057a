// What the faces of walls, and fog, make of the light that they receive: `send` turns it into what they
// send on (`send_on`: and tells what that changed), `show` lets walls be seen by the mean over their faces.

@group(0) @binding(2) var albedo: texture_2d<f32>;
@group(0) @binding(3) var<storage, read> received: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> sent: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> light: array<vec4f>;
// Where rounds go on until light has converged.
@group(0) @binding(6) var<storage, read_write> found: array<Found>;
@group(0) @binding(7) var<uniform> step: u32;

// Whether a face (left, right, top, bottom) looks at a cell that is not solid.
fn exposed(at: vec2u, face: u32) -> bool {
    let open = vec2i(at) + normal(face);
    return inside(open) && !solid(open);
}

// Light that a face receives, fog by the first; 1 in the fourth place where there is one.
fn receives(at: vec2u, face: u32, tint_opacity: vec4f) -> vec4f {
    let slot = 4u * index(at) + face;
    if tint_opacity.a >= 1.0 {
        if exposed(at, face) {
            return vec4f(0.5 * unpack_rgb(received[slot]), 1.0);
        }
    } else if face == 0u && any(tint_opacity != vec4f(1.0, 1.0, 1.0, 0.0)) {
        return vec4f(unpack_rgb(received[slot]), 1.0);
    }
    return vec4f(0.0);
}

@compute @workgroup_size(8, 8)
fn send(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let share = textureLoad(albedo, id.xy, 0).rgb;
    let tint_opacity = textureLoad(matter, id.xy, 0);
    for (var face = 0u; face < 4u; face++) {
        let light = share * receives(id.xy, face, tint_opacity).rgb;
        sent[4u * index(id.xy) + face] = pack_rgb(light);
    }
}

// The same, compared with what was sent in the round before: both as they are stored, so that what
// stays the same is no change, however bright.
@compute @workgroup_size(SIDE, SIDE)
fn send_on(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    var own: Found;
    if !outside(id.xy) {
        let share = textureLoad(albedo, id.xy, 0).rgb;
        let reflects = any(share != vec3f(0.0));
        let tint_opacity = textureLoad(matter, id.xy, 0);
        for (var face = 0u; face < 4u; face++) {
            let slot = 4u * index(id.xy) + face;
            let light = receives(id.xy, face, tint_opacity);
            let now = pack_rgb(share * light.rgb);
            // Before the first round nothing was sent.
            let old = select(sent[slot], vec2u(0u), step == 0u);
            sent[slot] = now;
            if reflects && light.w > 0.0 {
                own = both(own, changed(unpack_rgb(old), unpack_rgb(now)));
            }
        }
    }
    let all = over_group(own, thread);
    if thread == 0u {
        found[place(tile)] = all;
    }
}

@compute @workgroup_size(8, 8)
fn show(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) || !solid(vec2i(id.xy)) {
        return;
    }
    var sum = vec4f(0.0);
    for (var face = 0u; face < 4u; face++) {
        sum += receives(id.xy, face, vec4f(1.0));
    }
    light[index(id.xy)] = vec4f(sum.rgb / max(sum.a, 1.0), 1.0);
}
