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
    var sum = Seen();
    for (var branch = 0u; branch < BRANCHES; branch++) {
        add(&sum, 1.0 / f32(BRANCHES), see(at, around, BRANCHES * id.z + branch, vec2f(0.0)));
    }
    let probe = (id.z * layer.count.y + id.y) * layer.count.x + id.x;
    near[values() * probe] = vec4f(sum.light, 0.0);
    if MOMENT {
        near[values() * probe + 1u] = vec4f(sum.moment_x, 0.0);
        near[values() * probe + 2u] = vec4f(sum.moment_y, 0.0);
    }
}
