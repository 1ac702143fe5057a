// What frames hand on, carried to where its cells are now that the grid has moved over the world. What
// comes into the grid has no past: 0.

// Words a cell.
@group(0) @binding(1) var<uniform> words: u32;
@group(0) @binding(2) var<storage, read> before: array<u32>;
@group(0) @binding(3) var<storage, read_write> after: array<u32>;

fn copy(to: u32, from_: u32) {
    for (var word = 0u; word < words; word++) {
        after[words * to + word] = before[words * from_ + word];
    }
}

@compute @workgroup_size(8, 8)
fn aside(@builtin(global_invocation_id) id: vec3u) {
    if !outside(id.xy) {
        copy(index(id.xy), index(id.xy));
    }
}

@compute @workgroup_size(8, 8)
fn back(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    // Neither overflows: a grid is smaller than what is left of 32 bits.
    let was = vec2i(id.xy) + clamp(frame.moved, -vec2i(frame.size), vec2i(frame.size));
    if inside(was) {
        copy(index(id.xy), index(vec2u(was)));
        return;
    }
    for (var word = 0u; word < words; word++) {
        after[words * index(id.xy) + word] = 0u;
    }
}
