// Where light is wanted: at the centres of cells and on the faces of walls. Cones of the nearest
// cascade that are worked out later add to what the first ones left.

// px before a face from which its rays start, so that they start in the open.
override BEFORE: f32;

@group(0) @binding(9) var<storage, read_write> light: array<vec4f>;
@group(0) @binding(10) var albedo: texture_2d<f32>;
// `½∫cosθ dθ` over each cone of the nearest cascade, θ from the normal of each face.
@group(0) @binding(11) var<storage, read> cosines: array<vec4f>;

fn over_circle(at: vec2u) -> vec3f {
    let centre = vec2f(at) + 0.5;
    let around = around(centre);
    var sum = vec3f(0.0);
    for (var ray = 0u; ray < layer.cones; ray++) {
        sum += see(centre, around, ray, vec2f(0.0));
    }
    return sum / f32(layer.rays);
}

// `B = ½∫L cosθ dθ`, from the middle of a face.
fn over_face(at: vec2u, face: u32) -> vec3f {
    let normal = vec2f(normal(face));
    let before = vec2f(at) + 0.5 + (0.5 + BEFORE) * normal;
    let around = around(before);
    var sum = vec3f(0.0);
    for (var ray = 0u; ray < layer.cones; ray++) {
        let weight = cosines[layer.cone + ray][face];
        if weight > 0.0 {
            sum += weight * see(before, around, ray, normal);
        }
    }
    return sum;
}

fn on_wall(at: vec2u) -> vec3f {
    var sum = vec3f(0.0);
    var count = 0.0;
    for (var face = 0u; face < 4u; face++) {
        if exposed(at, face) {
            sum += over_face(at, face);
            count += 1.0;
        }
    }
    return sum / max(count, 1.0);
}

fn put(i: u32, found: vec3f, kind: f32) {
    var sum = found;
    if layer.cone > 0u {
        sum += light[i].rgb;
    }
    light[i] = vec4f(sum, kind);
}

// What faces and fog send on of what they receive.
@compute @workgroup_size(8, 8)
fn receive(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    let kind = source[i].w;
    let share = textureLoad(albedo, id.xy, 0).rgb;
    let reflects = any(share != vec3f(0.0));
    for (var face = 0u; face < 4u; face++) {
        let slot = 4u * i + face;
        if reflects && kind == SOLID && exposed(id.xy, face) {
            put(slot, share * over_face(id.xy, face), FACE);
        } else if reflects && kind == MEDIUM && face == 0u {
            put(slot, share * over_circle(id.xy), VOLUME);
        } else {
            light[slot] = vec4f(0.0);
        }
    }
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    if source[index(id.xy)].w == SOLID {
        put(index(id.xy), on_wall(id.xy), 1.0);
    } else {
        put(index(id.xy), over_circle(id.xy), 1.0);
    }
}
