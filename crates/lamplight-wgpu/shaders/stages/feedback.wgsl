// The scattered radiance of the frame before, where the same scatterer is still there.

#import shared/class
#import shared/normal
#import shared/scatter
#import shared/uniforms

@group(0) @binding(1) var albedo: texture_2d<f32>;
@group(0) @binding(2) var<storage, read> source: array<vec4f>;
@group(0) @binding(3) var<storage, read> before: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> scattered: array<vec4f>;

// Returns whether a face looks at a cell of the grid that is not solid.
fn exposed(at: vec2u, face: u32) -> bool {
    let front = vec2i(at) + normal(face);
    return inside(front) && class_of(source[index(vec2u(front))]) != SOLID;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    let scatters = frame.history != HISTORY_NONE && any(textureLoad(albedo, id.xy, 0).rgb != vec3f(0.0));
    let cell_class = class_of(source[i]);
    for (var face = 0u; face < 4u; face++) {
        let old = before[4u * i + face];
        let kind = old.w % INVALIDATED;
        let same = (kind == FACE && cell_class == SOLID && exposed(id.xy, face))
            || (kind == VOLUME && cell_class == MEDIUM);
        scattered[4u * i + face] = select(vec4f(0.0), vec4f(old.rgb, kind), scatters && same);
    }
}
