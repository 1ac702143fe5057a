// The displayed picture of light in a texture as wide as the grid, for devices without storage buffers.

#import shared/display
#import shared/uniforms

@group(0) @binding(2) var light: texture_2d<f32>;

fn light_at(i: u32) -> vec3f {
    return textureLoad(light, vec2u(i % frame.size.x, i / frame.size.x), 0).rgb;
}
