// What surfaces sent on in the frame before, where the same surface sends on now.

@group(0) @binding(1) var albedo: texture_2d<f32>;
@group(0) @binding(2) var<storage, read> source: array<vec4f>;
@group(0) @binding(3) var<storage, read> before: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> sent: array<vec4f>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    let reflects = frame.memory != NOTHING && any(textureLoad(albedo, id.xy, 0).rgb != vec3f(0.0));
    for (var face = 0u; face < 4u; face++) {
        let old = before[4u * i + face];
        let kind = old.w % CHANGED;
        let same = (kind == FACE && source[i].w == SOLID) || (kind == VOLUME && source[i].w == MEDIUM);
        // A face that is covered now is seen by nobody, and forgotten by the gather that follows.
        sent[4u * i + face] = select(vec4f(0.0), vec4f(old.rgb, kind), reflects && same);
    }
}
