// Cells that glow, as media with more emission: the formulas are those of `glow.rs` of the library.

#import shared/transmittance
#import shared/uniforms

// The largest tint of a cell that glows.
override THINNEST: f32;

@group(0) @binding(1) var emission: texture_2d<f32>;
@group(0) @binding(2) var matter: texture_2d<f32>;
@group(0) @binding(3) var albedo: texture_2d<f32>;
// The emission coefficient.
@group(0) @binding(4) var glow: texture_2d<f32>;
@group(0) @binding(5) var media_emission: texture_storage_2d<rgba32float, write>;
@group(0) @binding(6) var media_matter: texture_storage_2d<rgba32float, write>;
@group(0) @binding(7) var media_albedo: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    var emitted = textureLoad(emission, id.xy, 0).rgb;
    var tint_opacity = textureLoad(matter, id.xy, 0);
    var reflected = textureLoad(albedo, id.xy, 0).rgb;
    let added = textureLoad(glow, id.xy, 0).rgb;
    if any(added > vec3f(0.0)) && tint_opacity.a < 1.0 {
        let own = extinction_of(tint_opacity);
        tint_opacity = vec4f(min(tint_opacity.rgb, vec3f(THINNEST)), tint_opacity.a);
        let seen = extinction_of(tint_opacity);
        emitted = (own * emitted + added) / seen;
        reflected *= own / seen;
    }
    textureStore(media_emission, id.xy, vec4f(emitted, 0.0));
    textureStore(media_matter, id.xy, tint_opacity);
    textureStore(media_albedo, id.xy, vec4f(reflected, 0.0));
}
