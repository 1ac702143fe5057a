// Which cells hold other matter than in the frame before, told by a hash of 64 bits: of two that
// differ, 1 in 2⁶⁴ pass for the same.

@group(0) @binding(1) var emission: texture_2d<f32>;
@group(0) @binding(2) var matter: texture_2d<f32>;
@group(0) @binding(3) var albedo: texture_2d<f32>;
// 0 where nothing is known of the frame before.
@group(0) @binding(4) var<storage, read_write> hashes: array<vec2u>;
// Gets 1 in the fourth place of cells that changed.
@group(0) @binding(5) var<storage, read_write> logs: array<vec4f>;
// 1 where any cell changed.
@group(0) @binding(6) var<storage, read_write> any_changed: atomic<u32>;

// Bits of numbers; both zeros are one.
fn bits(value: vec4f) -> vec4u {
    return bitcast<vec4u>(select(value, vec4f(0.0), value == vec4f(0.0)));
}

@compute @workgroup_size(1)
fn begin() {
    atomicStore(&any_changed, 0u);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    var hash = pcg(bits(vec4f(textureLoad(emission, id.xy, 0).rgb, 0.0)));
    hash = pcg(hash ^ bits(textureLoad(matter, id.xy, 0)));
    hash = pcg(pcg(hash ^ bits(vec4f(textureLoad(albedo, id.xy, 0).rgb, 0.0))));
    let known = frame.memory == ALL && any(hashes[i] != vec2u(0u));
    let changed = known && any(hash.xy != hashes[i]);
    hashes[i] = hash.xy;
    if changed {
        logs[i].w = 1.0;
        atomicStore(&any_changed, 1u);
    }
}
