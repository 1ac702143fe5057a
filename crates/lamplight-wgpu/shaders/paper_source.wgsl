// The grid as the published cascades see it: what cells give off, and in w what they are. `bounce` adds
// what they send on of the light that the solve before found.

@group(0) @binding(1) var emission: texture_2d<f32>;
@group(0) @binding(2) var albedo: texture_2d<f32>;
@group(0) @binding(3) var matter: texture_2d<f32>;
@group(0) @binding(4) var<storage, read> light: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> source: array<vec4f>;

fn see(at: vec2u, sent: vec3f) {
    let tint_opacity = textureLoad(matter, at, 0);
    var kind = select(CLEAR, MEDIUM, any(tint_opacity != vec4f(1.0, 1.0, 1.0, 0.0)));
    if tint_opacity.a >= 1.0 {
        kind = SOLID;
    }
    source[index(at)] = vec4f(textureLoad(emission, at, 0).rgb + sent, kind);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if !outside(id.xy) {
        see(id.xy, vec3f(0.0));
    }
}

@compute @workgroup_size(8, 8)
fn bounce(@builtin(global_invocation_id) id: vec3u) {
    if !outside(id.xy) {
        see(id.xy, textureLoad(albedo, id.xy, 0).rgb * light[index(id.xy)].rgb);
    }
}
