// Reprojection of history: moves it with its cells when the grid moves over the world or changes its size. Cells
// that come into the grid have no history: 0.

#import shared/uniforms

// Words per cell.
@group(0) @binding(1) var<uniform> words: u32;
@group(0) @binding(2) var<storage, read> before: array<u32>;
@group(0) @binding(3) var<storage, read_write> after: array<u32>;

fn copy(to: u32, start: u32) {
    for (var word = 0u; word < words; word++) {
        after[words * to + word] = before[words * start + word];
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
    // Neither overflows: a side of a grid is far below 2³¹.
    let was = vec2i(id.xy) + clamp(frame.moved, -vec2i(frame.size), vec2i(frame.size_before));
    if all(was >= vec2i(0)) && all(vec2u(was) < frame.size_before) {
        copy(index(id.xy), u32(was.y) * frame.size_before.x + u32(was.x));
        return;
    }
    for (var word = 0u; word < words; word++) {
        after[words * index(id.xy) + word] = 0u;
    }
}
