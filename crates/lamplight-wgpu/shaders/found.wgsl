// What a round of light changed of what surfaces send on, tile of cells by tile, added up always in the
// same order: the same numbers give the same decision.

struct Found {
    largest: f32,
    sum: f32,
    // Numbers added up.
    count: f32,
}

const SIDE: u32 = 8u;
const THREADS: u32 = 64u;

var<workgroup> parts: array<Found, THREADS>;

fn both(a: Found, b: Found) -> Found {
    return Found(max(a.largest, b.largest), a.sum + b.sum, a.count + b.count);
}

// Of one surface, by channel.
fn changed(old: vec3f, now: vec3f) -> Found {
    let change = abs(now - old);
    return Found(max(change.r, max(change.g, change.b)), now.r + now.g + now.b, 3.0);
}

// What all threads of a workgroup found, as a tree; known to the first.
fn over_group(own: Found, thread: u32) -> Found {
    parts[thread] = own;
    for (var half = THREADS / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if thread < half {
            parts[thread] = both(parts[thread], parts[thread + half]);
        }
    }
    return parts[0];
}

fn tiles() -> vec2u {
    return (frame.size + SIDE - 1u) / SIDE;
}

// Where a tile's is kept.
fn place(tile: vec3u) -> u32 {
    return tile.y * tiles().x + tile.x;
}
