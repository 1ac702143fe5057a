// Adds direct light, as stages/direct.wgsl finds it: to the light of cells, of solid ones the mean over their faces,
// or to what `raymarch` and `cascades` let them scatter.

#import shared/uniforms

@group(0) @binding(1) var<storage, read> found: array<vec4f>;
@group(0) @binding(2) var albedo: texture_2d<f32>;
// Light of cells, or scattered radiance of their faces; in `w` 0 where nothing scatters.
@group(0) @binding(3) var<storage, read_write> light: array<vec4f>;

@compute @workgroup_size(8, 8)
fn add(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    var sum = vec4f(0.0);
    for (var face = 0u; face < 4u; face++) {
        sum += found[4u * index(id.xy) + face];
    }
    light[index(id.xy)] += vec4f(sum.rgb / max(sum.w, 1.0), 0.0);
}

@compute @workgroup_size(8, 8)
fn scatter(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let own = textureLoad(albedo, id.xy, 0).rgb;
    for (var face = 0u; face < 4u; face++) {
        let slot = 4u * index(id.xy) + face;
        if light[slot].w > 0.0 {
            light[slot] += vec4f(own * found[slot].rgb, 0.0);
        }
    }
}
