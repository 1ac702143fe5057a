// The matter of the host's textures as numbers, for the CPU. A texture of any format is decoded as it is read.

#import shared/uniforms

@group(0) @binding(1) var emission: texture_2d<f32>;
@group(0) @binding(2) var matter: texture_2d<f32>;
@group(0) @binding(3) var albedo: texture_2d<f32>;
@group(0) @binding(4) var glow: texture_2d<f32>;
@group(0) @binding(5) var masks: texture_2d<f32>;
// Per cell: emission; tint and opacity; albedo and, in `w`, the layers; glow.
@group(0) @binding(6) var<storage, read_write> values: array<vec4f>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    // The uniforms are those of the frame before.
    let size = textureDimensions(emission);
    if any(id.xy >= size) {
        return;
    }
    let first = 4u * (id.y * size.x + id.x);
    values[first] = textureLoad(emission, id.xy, 0);
    values[first + 1u] = textureLoad(matter, id.xy, 0);
    // Textures of a single texel stand for all cells.
    let of_layers = min(id.xy, textureDimensions(masks) - 1u);
    let layers = textureLoad(masks, of_layers, 0).r;
    values[first + 2u] = vec4f(textureLoad(albedo, id.xy, 0).rgb, layers);
    values[first + 3u] = textureLoad(glow, min(id.xy, textureDimensions(glow) - 1u), 0);
}
