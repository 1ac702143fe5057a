// Adds direct light, as stages/direct.wgsl finds it: to the light of cells, of solid ones the mean over their faces,
// or to what `raymarch` and `cascades` let them scatter.

#import shared/moment
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
    let i = index(id.xy);
    var sum = vec4f(0.0);
    for (var face = 0u; face < 4u; face++) {
        let value = found[4u * i + face];
        sum += value * value.w;
    }
    // Lamps take no more light than there is.
    light[i] = max(light[i] + vec4f(sum.rgb / max(sum.w, 1.0), 0.0), vec4f(0.0));
    if MOMENT {
        var moment: array<vec3f, 2>;
        for (var component = 0u; component < 2u; component++) {
            // Of a solid cell these are faces, or black.
            let value = found[4u * i + 1u + component];
            moment[component] = light[moment_index(component, i)].rgb + (1.0 - value.w) * value.rgb;
        }
        moment = limited(moment, light[i].rgb);
        for (var component = 0u; component < 2u; component++) {
            let slot = moment_index(component, i);
            light[slot] = vec4f(moment[component], light[slot].w);
        }
    }
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
            light[slot] = max(light[slot] + vec4f(own * found[slot].rgb, 0.0), vec4f(0.0));
        }
    }
}
