// The grid as rays see it: what each cell is and gives off, and the logarithm of what a px lets
// through. Between bounces what fog sends on is added to what it gives off.

// Whether fog that sends light on is kept apart: no two cells of it are alike, so that no leap passes two
// of them, whatever they are going to send.
override APART: bool;

@group(0) @binding(1) var emission: texture_2d<f32>;
@group(0) @binding(2) var matter: texture_2d<f32>;
@group(0) @binding(3) var<storage, read_write> source: array<vec4f>;
// In the fourth place more than 0 where matter changed since the frame before, or, in fog, what it sees;
// less than 0, and another number in each, where fog is kept apart.
@group(0) @binding(4) var<storage, read_write> logs: array<vec4f>;
// What surfaces send on; fog on the first of four.
@group(0) @binding(5) var<storage, read> sent: array<vec4f>;
@group(0) @binding(6) var albedo: texture_2d<f32>;

@compute @workgroup_size(8, 8)
fn light_fog(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    if source[i].w == MEDIUM {
        let own = textureLoad(emission, id.xy, 0).rgb * frame.multiplier;
        source[i] = vec4f(own + sent[4u * i].rgb, MEDIUM);
        if sent[4u * i].w >= CHANGED {
            logs[i].w = 1.0;
        }
    }
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let tint_opacity = textureLoad(matter, id.xy, 0);
    var kind = select(CLEAR, MEDIUM, occupied(tint_opacity));
    if tint_opacity.a >= 1.0 {
        kind = SOLID;
    }
    let i = index(id.xy);
    source[i] = vec4f(textureLoad(emission, id.xy, 0).rgb * frame.multiplier, kind);
    var own = 0.0;
    if APART && kind == MEDIUM && any(textureLoad(albedo, id.xy, 0).rgb != vec3f(0.0)) {
        own = -1.0 - f32(i);
    }
    logs[i] = vec4f(select(vec3f(0.0), log_transmittance(tint_opacity), kind == MEDIUM), own);
}
