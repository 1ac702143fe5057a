// The scattered radiance of the frame before, where the same scatterer is still there.

#import methods/holographic/packed_rgb
#import shared/solid
#import shared/uniforms

@group(0) @binding(2) var albedo: texture_2d<f32>;
@group(0) @binding(3) var<storage, read_write> scattered: array<vec2u>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let slot = 4u * index(id.xy);
    let was_medium = all(scattered[slot + 1u] == KEPT_MEDIUM);
    let is_medium = textureLoad(matter, id.xy, 0).a < 1.0;
    let scatters = frame.history != HISTORY_NONE && any(textureLoad(albedo, id.xy, 0).rgb != vec3f(0.0));
    let same = scatters && was_medium == is_medium;
    for (var face = 0u; face < 4u; face++) {
        let is_there = select(exposed(id.xy, face), face == 0u, is_medium);
        if !(same && is_there) {
            scattered[slot + face] = vec2u(0u);
        }
    }
}
