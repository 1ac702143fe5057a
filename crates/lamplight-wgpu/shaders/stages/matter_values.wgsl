// The matter of the host's textures as numbers, for the CPU. A texture of any format is decoded as it is read. The values
// are drawn, as devices may have no compute shaders.

#import shared/uniforms

@group(0) @binding(1) var emission: texture_2d<f32>;
@group(0) @binding(2) var matter: texture_2d<f32>;
@group(0) @binding(3) var albedo: texture_2d<f32>;
@group(0) @binding(4) var glow: texture_2d<f32>;
@group(0) @binding(5) var masks: texture_2d<f32>;

// The values that are drawn: 0 emission; 1 tint and opacity; 2 albedo and, in `w`, the layers; 3 glow.
override PART: u32;

// One triangle that covers the grid.
@vertex
fn cover(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    let across = vec2f(f32(corner & 1u), f32(corner >> 1u)) * 4.0 - 1.0;
    return vec4f(across, 0.0, 1.0);
}

fn value(at: vec2u) -> vec4f {
    if PART == 0u {
        return textureLoad(emission, at, 0);
    }
    if PART == 1u {
        return textureLoad(matter, at, 0);
    }
    if PART == 3u {
        return textureLoad(glow, at, 0);
    }
    // A texture of a single texel stands for all cells.
    let of_layers = min(at, textureDimensions(masks) - 1u);
    return vec4f(textureLoad(albedo, at, 0).rgb, textureLoad(masks, of_layers, 0).r);
}

// Bits, because not every device draws on floats.
@fragment
fn values(@builtin(position) position: vec4f) -> @location(0) vec4u {
    return bitcast<vec4u>(value(vec2u(position.xy)));
}
