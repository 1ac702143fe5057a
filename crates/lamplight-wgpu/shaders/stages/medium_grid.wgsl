// The medium grid of `raymarch` and `cascades`: emitted radiance, class and extinction of each cell. Between
// bounces `light_media` adds to the emission of media what they scatter.

#import shared/class
#import shared/scatter
#import shared/transmittance
#import shared/uniforms

// True if media that scatter are kept apart: no two of their cells are equal, so that no skip crosses two
// of them, whatever they are going to scatter.
override APART: bool;

@group(0) @binding(1) var emission: texture_2d<f32>;
@group(0) @binding(2) var matter: texture_2d<f32>;
// Emitted radiance; in `w` the class.
@group(0) @binding(3) var<storage, read_write> source: array<vec4f>;
// Extinction per px. In `w` more than 0 if matter changed since the frame before, or, in media, what they
// see; a negative number, different in each cell, if media are kept apart.
@group(0) @binding(4) var<storage, read_write> extinction: array<vec4f>;
// Scattered radiance of four faces; of media in the first.
@group(0) @binding(5) var<storage, read> scattered: array<vec4f>;
@group(0) @binding(6) var albedo: texture_2d<f32>;

@compute @workgroup_size(8, 8)
fn light_media(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    if class_of(source[i]) == MEDIUM {
        let own = textureLoad(emission, id.xy, 0).rgb * frame.emission_multiplier;
        source[i] = vec4f(own + scattered[4u * i].rgb, f32(MEDIUM));
        if scattered[4u * i].w >= INVALIDATED {
            extinction[i].w = 1.0;
        }
    }
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let tint_opacity = textureLoad(matter, id.xy, 0);
    let cell_class = classify(tint_opacity, frame.threshold);
    let i = index(id.xy);
    let emitted = textureLoad(emission, id.xy, 0).rgb * frame.emission_multiplier;
    source[i] = vec4f(emitted, f32(cell_class));
    let is_medium = cell_class == MEDIUM;
    var mark = 0.0;
    if APART && is_medium && any(textureLoad(albedo, id.xy, 0).rgb != vec3f(0.0)) {
        mark = -1.0 - f32(i);
    }
    extinction[i] = vec4f(select(vec3f(0.0), extinction_of(tint_opacity), is_medium), mark);
}
