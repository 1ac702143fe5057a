// Normals of everything that is drawn on the screen. Follows quads.wgsl in the same module.

// The bits of `Material::bits` of surfaces.
const Y_DOWN: u32 = 1u;
const SRGB: u32 = 2u;
const TWO_CHANNELS: u32 = 4u;

// `normal_map_at` samples the normal map of a quad; it is written by src/render/pipelines.rs.

override STRAIGHT: f32;
override SLOPE: f32;
override OFFSET: f32;
override GAMMA: f32;

const TOWARDS_VIEWER: vec3f = vec3f(0.0, 0.0, 1.0);

// The stored value of an sRGB texel, which sampling has decoded as a colour.
fn stored(linear: vec3f) -> vec3f {
    let curve = (1.0 + OFFSET) * pow(linear, vec3f(1.0 / GAMMA)) - OFFSET;
    return select(curve, linear * SLOPE, linear <= vec3f(STRAIGHT));
}

// The normal of a texel, y down: the counterpart of `decode` in `relief.rs` of `lamplight`.
fn decoded(texel: vec3f, encoding: u32) -> vec3f {
    let values = select(texel, stored(texel), (encoding & SRGB) != 0u);
    var normal = clamp((values * 255.0 - 128.0) / 127.0, vec3f(-1.0), vec3f(1.0));
    if (encoding & TWO_CHANNELS) != 0u {
        normal.z = sqrt(max(1.0 - dot(normal.xy, normal.xy), 0.0));
    }
    if (encoding & Y_DOWN) == 0u {
        normal.y = -normal.y;
    }
    return normal;
}

// A normal of the image as its quad turns and mirrors it on the grid. Stretching does not change the tilt.
fn on_grid(quad: Quad, normal: vec3f) -> vec3f {
    let turn = quad.texels_x.x * quad.texels_y.y - quad.texels_x.y * quad.texels_y.x;
    // The directions on the grid in which the image's x and y grow.
    let right = sign(turn) * (quad.x_axis * quad.texels_y.y - quad.y_axis * quad.texels_x.y);
    let down = sign(turn) * (quad.y_axis * quad.texels_x.x - quad.x_axis * quad.texels_y.x);
    let lengths = vec2f(length(right), length(down));
    if min(lengths.x, lengths.y) == 0.0 || dot(normal, normal) == 0.0 {
        return TOWARDS_VIEWER;
    }
    let along = normal.x * right / lengths.x + normal.y * down / lengths.y;
    return normalize(vec3f(along, normal.z));
}

// The normal of a quad with a normal map, weighted by coverage.
@fragment
fn tilted(in: VertexOut) -> @location(0) vec4f {
    let coverage = color_at(in).a;
    let quad = quad_of(in);
    let at = quad.texels_origin + in.unit.x * quad.texels_x + in.unit.y * quad.texels_y;
    let texel = normal_map_at(at, quad.layer).rgb;
    let normal = on_grid(quad, decoded(texel, material_of(in).bits));
    return vec4f(normal * coverage, coverage);
}

// The normal of a quad without one.
@fragment
fn untilted(in: VertexOut) -> @location(0) vec4f {
    let coverage = color_at(in).a;
    return vec4f(TOWARDS_VIEWER * coverage, coverage);
}
