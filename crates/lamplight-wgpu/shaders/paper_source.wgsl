// The grid as the published cascades see it: what cells give off, and in w what they are. `bounce` adds
// what they send on of the light that the solve before found; `bounce_on` tells what that changed, too.

@group(0) @binding(1) var emission: texture_2d<f32>;
@group(0) @binding(2) var albedo: texture_2d<f32>;
@group(0) @binding(3) var matter: texture_2d<f32>;
@group(0) @binding(4) var<storage, read> light: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> source: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> found: array<Found>;

fn kind(at: vec2u) -> f32 {
    let tint_opacity = textureLoad(matter, at, 0);
    if tint_opacity.a >= 1.0 {
        return SOLID;
    }
    return select(CLEAR, MEDIUM, any(tint_opacity != vec4f(1.0, 1.0, 1.0, 0.0)));
}

fn see(at: vec2u, sent: vec3f) {
    source[index(at)] = vec4f(textureLoad(emission, at, 0).rgb + sent, kind(at));
}

fn sent(at: vec2u) -> vec3f {
    return textureLoad(albedo, at, 0).rgb * light[index(at)].rgb;
}

// Whether a cell sends light on; of walls, whether it can be seen.
fn surface(at: vec2u) -> bool {
    if kind(at) == MEDIUM {
        return any(textureLoad(albedo, at, 0).rgb != vec3f(0.0));
    }
    var seen = false;
    for (var face = 0u; face < 4u; face++) {
        let front = vec2i(at) + normal(face);
        seen = seen || (inside(front) && kind(vec2u(front)) != SOLID);
    }
    return seen && kind(at) == SOLID;
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
        see(id.xy, sent(id.xy));
    }
}

// The change, and the sum, is that of all matter, with what it gives off; the mean is over surfaces.
@compute @workgroup_size(SIDE, SIDE)
fn bounce_on(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    var own: Found;
    if !outside(id.xy) {
        let old = source[index(id.xy)];
        see(id.xy, sent(id.xy));
        if old.w != CLEAR {
            own = changed(old.rgb, source[index(id.xy)].rgb);
            own.count = select(0.0, 3.0, surface(id.xy));
        }
    }
    let all = over_group(own, thread);
    if thread == 0u {
        found[place(tile)] = all;
    }
}
