// Rounds of light until the largest change is small against the mean. What surfaces send on is
// compared with the round before, workgroup by workgroup and then over all of them, always in the
// same order: the same numbers give the same decision.

// Entries of `sent` a cell.
override SLOTS: u32;
// Largest change, ÷ the mean, at which rounds end.
override CONVERGED: f32;

// What one workgroup, or thread, found.
struct Found {
    largest: f32,
    sum: f32,
    // Numbers added up.
    count: f32,
}

@group(0) @binding(1) var<uniform> step: u32;
// Light that surfaces send on in this round, by entry, 0 in the fourth place where there is none;
@group(0) @binding(2) var<storage, read> received: array<vec4f>;
// and in the round before, which it replaces.
@group(0) @binding(3) var<storage, read_write> sent: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> found: array<Found>;
// Workgroups of the rounds to come: none when they have converged.
@group(0) @binding(5) var<storage, read_write> groups: array<u32, 3>;

const SIDE: u32 = 8u;
const THREADS: u32 = 64u;

var<workgroup> parts: array<Found, THREADS>;

fn both(a: Found, b: Found) -> Found {
    return Found(max(a.largest, b.largest), a.sum + b.sum, a.count + b.count);
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

// Before the first round.
@compute @workgroup_size(1)
fn begin() {
    let all = tiles();
    groups = array<u32, 3>(all.x, all.y, 1u);
}

// After each round: the change in every tile.
@compute @workgroup_size(SIDE, SIDE)
fn compare(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    var own: Found;
    if !outside(id.xy) {
        let first = SLOTS * index(id.xy);
        for (var slot = first; slot < first + SLOTS; slot++) {
            let now = received[slot];
            // Before the first round nothing was sent.
            let old = select(sent[slot].rgb, vec3f(0.0), step == 0u);
            sent[slot] = now;
            if now.w > 0.0 {
                let change = abs(now.rgb - old);
                let largest = max(change.r, max(change.g, change.b));
                own = both(own, Found(largest, now.r + now.g + now.b, 3.0));
            }
        }
    }
    let all = over_group(own, thread);
    if thread == 0u {
        found[tile.y * tiles().x + tile.x] = all;
    }
}

// And over all tiles. After rounds that were left out it finds the same again.
@compute @workgroup_size(THREADS)
fn decide(@builtin(local_invocation_index) thread: u32) {
    let count = tiles().x * tiles().y;
    var own: Found;
    for (var tile = thread; tile < count; tile += THREADS) {
        own = both(own, found[tile]);
    }
    let all = over_group(own, thread);
    if thread == 0u && (all.largest == 0.0 || all.largest < CONVERGED * all.sum / all.count) {
        groups = array<u32, 3>(0u, 0u, 0u);
    }
}
