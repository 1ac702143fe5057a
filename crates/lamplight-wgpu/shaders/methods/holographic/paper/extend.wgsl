// Extends a level of intervals to the next (Freeman, Sannikov and Margel 2025):
// `T_{n+1}(p, 2k) = T_n(p, k) ⊕ T_n(p + v_n(k), k)`, and between two such the mean of both bent paths,
// `T_n(p, k) ⊕ T_n(p + v_n(k), k+1)` and `T_n(p, k+1) ⊕ T_n(p + v_n(k+1), k)`.

#import methods/holographic/paper/load

@group(0) @binding(3) var<storage, read> shorter: array<f32>;

fn word(level: u32, at: u32) -> f32 {
    return shorter[at];
}

// The interval along one ray to the next plane, and another from there.
fn bent(plane: u32, first: u32, second: u32, row: i32) -> Interval {
    let n = sweep.level;
    let near = load(n, 2u * plane, first, row);
    return then(near, load(n, 2u * plane + 1u, second, row + rise(n, first)));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= sweep.rows {
        return;
    }
    let row = i32(id.x);
    let a = id.y / 2u;
    let b = (id.y + 1u) / 2u;
    var longer = bent(id.z, a, b, row);
    if a != b {
        longer = mean(longer, bent(id.z, b, a, row));
    }
    store(place(sweep.level + 1u, id.z, id.y, id.x), longer);
}
