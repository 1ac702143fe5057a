// Converts the sums over each cell to its matter.

@group(0) @binding(0) var emission: texture_2d<f32>;
@group(0) @binding(1) var albedo: texture_2d<f32>;
@group(0) @binding(2) var tint: texture_2d<f32>;
@group(0) @binding(3) var opacity: texture_2d<f32>;

// One triangle that covers the grid.
@vertex
fn cover(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    let across = vec2f(f32(corner & 1u), f32(corner >> 1u)) * 4.0 - 1.0;
    return vec4f(across, 0.0, 1.0);
}

struct Matter {
    @location(0) emission: vec4f,
    @location(1) tint_opacity: vec4f,
    @location(2) albedo: vec4f,
}

@fragment
fn resolve(@builtin(position) position: vec4f) -> Matter {
    let at = vec2u(position.xy);
    let total = textureLoad(opacity, at, 0).r;
    let weight = select(0.0, 1.0 / total, total > 0.0);
    return Matter(
        vec4f(textureLoad(emission, at, 0).rgb * weight, 0.0),
        vec4f(min(textureLoad(tint, at, 0).rgb, vec3f(1.0)), min(total, 1.0)),
        vec4f(min(textureLoad(albedo, at, 0).rgb * weight, vec3f(1.0)), 0.0),
    );
}
