// Gathers light at the centres of open cells and on the faces of solid ones. Later batches of cones of the
// nearest cascade add to the first.

#import methods/cascades/probe
#import shared/class
#import shared/normal
#import shared/receive
#import shared/scatter
#import shared/surfaces
#import shared/uniforms

// Distance in px before a face at which its rays start, so that they start in an open cell.
override BEFORE: f32;

@group(0) @binding(9) var<storage, read_write> light: array<vec4f>;
@group(0) @binding(11) var albedo: texture_2d<f32>;
// `½∫cosθ dθ` over each cone of the nearest cascade, θ from the normal of each face.
@group(0) @binding(12) var<storage, read> cosines: array<vec4f>;

fn over_circle(at: vec2u) -> Seen {
    let centre = vec2f(at) + 0.5;
    let around = around(centre);
    var sum = Seen();
    for (var ray = 0u; ray < layer.cones; ray++) {
        add(&sum, 1.0 / f32(layer.rays), see(centre, around, ray, vec2f(0.0)));
    }
    return sum;
}

// The irradiance `E/2 = ½∫L cosθ dθ` at the centre of a face.
fn over_face(at: vec2u, face: u32) -> vec3f {
    let normal = vec2f(normal(face));
    let before = vec2f(at) + 0.5 + (0.5 + BEFORE) * normal;
    let around = around(before);
    var sum = vec3f(0.0);
    for (var ray = 0u; ray < layer.cones; ray++) {
        let weight = cosines[layer.cone + ray][face];
        if weight > 0.0 {
            sum += weight * see(before, around, ray, normal).light;
        }
    }
    return sum;
}

// The mean over the faces of a solid cell.
fn over_faces(at: vec2u) -> vec3f {
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

// Adds to what the batches before have left.
fn put(i: u32, gathered: vec3f, kind: f32) {
    var sum = gathered;
    if layer.cone > 0u {
        sum += light[i].rgb;
    }
    light[i] = vec4f(sum, kind);
}

fn reflect_face(slot: u32, albedo: vec3f, at: vec2u, face: u32) {
    put(slot, albedo * over_face(at, face), FACE);
}

fn scatter(slot: u32, albedo: vec3f, at: vec2u) {
    put(slot, albedo * over_circle(at).light, VOLUME);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    if class_of(source[index(id.xy)]) == SOLID {
        put(index(id.xy), over_faces(id.xy), 1.0);
        return;
    }
    let seen = over_circle(id.xy);
    put(index(id.xy), seen.light, 1.0);
    if MOMENT {
        put(moment_index(0u, index(id.xy)), seen.moment_x, 1.0);
        put(moment_index(1u, index(id.xy)), seen.moment_y, 1.0);
    }
}
