// Rounds of light until the largest change is small against the mean.

// Largest change, ÷ the mean, at which rounds end.
override CONVERGED: f32;

// Of every tile, in the round before.
@group(0) @binding(1) var<storage, read> found: array<Found>;
// Workgroups of what a round runs,
@group(0) @binding(2) var<storage, read> table: array<u32>;
// and of the rounds to come: none when they have converged.
@group(0) @binding(3) var<storage, read_write> groups: array<u32>;

// Before the first round.
@compute @workgroup_size(THREADS)
fn begin(@builtin(local_invocation_index) thread: u32) {
    for (var i = thread; i < arrayLength(&groups); i += THREADS) {
        groups[i] = table[i];
    }
}

// After each round. After rounds that were left out nothing is looked at, and so nothing changes.
@compute @workgroup_size(THREADS)
fn decide(@builtin(local_invocation_index) thread: u32) {
    let count = select(tiles().x * tiles().y, 0u, groups[0] == 0u);
    var own: Found;
    for (var tile = thread; tile < count; tile += THREADS) {
        own = both(own, found[tile]);
    }
    let all = over_group(own, thread);
    if thread == 0u && all.largest <= CONVERGED * all.sum / max(all.count, 1.0) {
        for (var i = 0u; i < arrayLength(&groups); i++) {
            groups[i] = 0u;
        }
    }
}
