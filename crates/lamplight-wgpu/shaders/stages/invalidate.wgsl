// Cells whose matter differs from the frame before, found by a hash of 64 bits: of two that differ, 1 in
// 2⁶⁴ is taken for equal.

#import shared/pcg
#import shared/uniforms

@group(0) @binding(1) var emission: texture_2d<f32>;
@group(0) @binding(2) var matter: texture_2d<f32>;
@group(0) @binding(3) var albedo: texture_2d<f32>;
// 0 if nothing is known of the frame before.
@group(0) @binding(4) var<storage, read_write> hashes: array<vec2u>;
// Its `w` is set to 1 in cells that changed.
@group(0) @binding(5) var<storage, read_write> extinction: array<vec4f>;
// 1 if any cell changed.
@group(0) @binding(6) var<storage, read_write> any_changed: atomic<u32>;

// The bits of numbers; both zeros are one.
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
    let comparable = frame.history == HISTORY_FULL && any(hashes[i] != vec2u(0u));
    let changed = comparable && any(hash.xy != hashes[i]);
    hashes[i] = hash.xy;
    if changed {
        extinction[i].w = 1.0;
        atomicStore(&any_changed, 1u);
    }
}
