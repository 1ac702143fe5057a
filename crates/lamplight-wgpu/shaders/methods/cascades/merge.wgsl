// Merges a cascade with the next one, within some cones of the nearest: per cone of the next nearer cascade
// and probe, the mean over the four rays in that cone.

#import methods/cascades/probe

@group(0) @binding(9) var<storage, read_write> near: array<vec4f>;

const BRANCHES: u32 = 4u;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= layer.count) {
        return;
    }
    let at = position(vec2f(id.xy), layer.count, layer.spacing);
    let around = around(at);
    var sum = vec3f(0.0);
    for (var branch = 0u; branch < BRANCHES; branch++) {
        sum += see(at, around, BRANCHES * id.z + branch, vec2f(0.0));
    }
    let probe = (id.z * layer.count.y + id.y) * layer.count.x + id.x;
    near[probe] = vec4f(sum / f32(BRANCHES), 0.0);
}
