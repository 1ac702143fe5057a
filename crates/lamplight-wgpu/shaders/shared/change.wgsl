// The change of scattered radiance in a bounce, per tile of 8×8 cells. It is always added up in the same
// order, so that the same numbers give the same decision.

#import shared/uniforms

struct Change {
    largest: f32,
    sum: f32,
    // Numbers added up.
    count: f32,
}

const SIDE: u32 = 8u;
const THREADS: u32 = 64u;

// A thread of a kernel that measures the change of a tile.
struct TileThread {
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) lane: u32,
}

var<workgroup> parts: array<Change, THREADS>;

fn both(a: Change, b: Change) -> Change {
    return Change(max(a.largest, b.largest), a.sum + b.sum, a.count + b.count);
}

// The change of one scatterer over its channels.
fn change_of(old: vec3f, now: vec3f) -> Change {
    let change = abs(now - old);
    return Change(max(change.r, max(change.g, change.b)), now.r + now.g + now.b, 3.0);
}

// The sum over all threads of a workgroup, as a tree; valid in the first thread.
fn over_group(own: Change, lane: u32) -> Change {
    parts[lane] = own;
    for (var half = THREADS / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if lane < half {
            parts[lane] = both(parts[lane], parts[lane + half]);
        }
    }
    return parts[0];
}

fn tiles() -> vec2u {
    return (frame.size + SIDE - 1u) / SIDE;
}

// The index of a tile.
fn tile_index(tile: vec3u) -> u32 {
    return tile.y * tiles().x + tile.x;
}
