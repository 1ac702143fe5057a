// What the faces of walls, and fog, make of the light that they receive: `send` turns it into what they
// send on, `show` lets walls be seen by the mean over their faces.

@group(0) @binding(2) var albedo: texture_2d<f32>;
@group(0) @binding(3) var<storage, read> received: array<vec2u>;
@group(0) @binding(4) var<storage, read_write> sent: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> light: array<vec4f>;

// Whether a face (left, right, top, bottom) looks at a cell that is not solid.
fn exposed(at: vec2u, face: u32) -> bool {
    let open = vec2i(at) + normal(face);
    return inside(open) && !solid(open);
}

@compute @workgroup_size(8, 8)
fn send(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = 4u * index(id.xy);
    let share = textureLoad(albedo, id.xy, 0).rgb;
    let tint_opacity = textureLoad(matter, id.xy, 0);
    let wall = tint_opacity.a >= 1.0;
    let fog = !wall && any(tint_opacity != vec4f(1.0, 1.0, 1.0, 0.0));
    for (var face = 0u; face < 4u; face++) {
        var light = vec3f(0.0);
        if wall && exposed(id.xy, face) {
            light = share * 0.5 * unpack_rgb(received[i + face]);
        } else if fog && face == 0u {
            light = share * unpack_rgb(received[i]);
        }
        sent[i + face] = pack_rgb(light);
    }
}

@compute @workgroup_size(8, 8)
fn show(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) || !solid(vec2i(id.xy)) {
        return;
    }
    let i = index(id.xy);
    var sum = vec3f(0.0);
    var count = 0.0;
    for (var face = 0u; face < 4u; face++) {
        if exposed(id.xy, face) {
            sum += 0.5 * unpack_rgb(received[4u * i + face]);
            count += 1.0;
        }
    }
    light[i] = vec4f(sum / max(count, 1.0), 1.0);
}
