// The light as a texture of half floats.

#import shared/uniforms

override MAX_HALF: f32;

@group(0) @binding(1) var<storage, read> light: array<vec4f>;
@group(0) @binding(2) var picture: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let rgb = min(light[index(id.xy)].rgb, vec3f(MAX_HALF));
    textureStore(picture, id.xy, vec4f(rgb, 1.0));
}
