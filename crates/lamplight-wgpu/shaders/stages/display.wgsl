// The displayed picture of light in a buffer.

#import shared/display

@group(0) @binding(2) var<storage, read> light: array<vec4f>;

fn light_at(i: u32) -> vec3f {
    return light[i].rgb;
}
