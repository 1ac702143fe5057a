// Merges a level of cones with the one above (Freeman, Sannikov and Margel 2025), with s ∈ {0, 1}, j = 2i + s,
// k = i + s, a = the angle of cone j:
// - planes of odd index, and the top level:
//   `R_n(p, i) = Σ_s [a·r(T_n(p, k)) + t(T_n(p, k))·R_{n+1}(p + v_n(k), j)]`;
// - planes of even index: the mean of `Σ_s R_{n+1}(p, j)` and of
//   `Σ_s [a·r(U) + t(U)·R_{n+1}(p + 2v_n(k), j)]`, `U = T_{n+1}(p, 2k)`.
// Outside the grid, and beyond the top level, there is sky. `main` makes a level, by plane, cone, channel
// and row; `last` adds the lowest to the light of cells.

#import methods/holographic/paper/load
#import methods/holographic/sky

@group(0) @binding(3) var<storage, read> near: array<f32>;
@group(0) @binding(4) var<storage, read> longer: array<f32>;
@group(0) @binding(5) var<storage, read> above: array<f32>;
@group(0) @binding(6) var<storage, read> cones: array<vec4f>;

fn word(level: u32, at: u32) -> f32 {
    if level > sweep.level {
        return longer[at];
    }
    return near[at];
}

fn is_top() -> bool {
    return planes(sweep.level) == 1u;
}

// The light of a cone of the level above.
fn far(plane: u32, cone: u32, row: i32) -> vec3f {
    let level = sweep.level + 1u;
    if is_top() || plane >= planes(level) || row < 0 || row >= i32(sweep.rows) {
        return sky_in(cone);
    }
    let at = ((plane << level) + cone) * 3u * sweep.rows + u32(row);
    return vec3f(above[at], above[at + sweep.rows], above[at + 2u * sweep.rows]);
}

// The light along a ray and, behind it, of a cone of the level above on the plane where the ray ends.
fn arrives(level: u32, plane: u32, ray: u32, end: u32, cone: u32, row: i32) -> vec3f {
    let ahead = load(level, plane, ray, row);
    let behind = far(end, cone, row + rise(level, ray));
    return cones[sweep.cones_above + cone].x * ahead.light + ahead.transmittance * behind;
}

fn merged(plane: u32, i: u32, row: i32) -> vec3f {
    let n = sweep.level;
    let j = 2u * i;
    if is_top() || (plane & 1u) == 1u {
        let end = (plane + 1u) / 2u;
        return arrives(n, plane, i, end, j, row) + arrives(n, plane, i + 1u, end, j + 1u, row);
    }
    let here = plane / 2u;
    let end = here + 1u;
    let kept = far(here, j, row) + far(here, j + 1u, row);
    let met = arrives(n + 1u, here, 2u * i, end, j, row)
        + arrives(n + 1u, here, 2u * i + 2u, end, j + 1u, row);
    return 0.5 * kept + 0.5 * met;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= sweep.rows {
        return;
    }
    let light = merged(id.z, id.y, i32(id.x));
    let at = ((id.z << sweep.level) + id.y) * 3u * sweep.rows + id.x;
    made[at] = light.r;
    made[at + sweep.rows] = light.g;
    made[at + 2u * sweep.rows] = light.b;
}

@compute @workgroup_size(64)
fn last(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= sweep.rows {
        return;
    }
    var sum = merged(id.z, 0u, i32(id.x));
    let at = 3u * index(cell_of(id.z, id.x));
    if sweep.turn > 0u {
        sum += vec3f(made[at], made[at + 1u], made[at + 2u]);
    }
    made[at] = sum.r;
    made[at + 1u] = sum.g;
    made[at + 2u] = sum.b;
}
