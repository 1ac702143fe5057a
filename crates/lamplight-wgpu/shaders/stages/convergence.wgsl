// Ends bounces once the largest change is small against the mean scattered radiance.

#import shared/change

// Largest change ÷ mean at which bounces end.
override CONVERGED: f32;

// The change of each tile in the bounce before.
@group(0) @binding(1) var<storage, read> changes: array<Change>;
// Workgroups of each dispatch of a bounce.
@group(0) @binding(2) var<storage, read> table: array<u32>;
// Workgroups of the bounces to come: 0 once light has converged.
@group(0) @binding(3) var<storage, read_write> groups: array<u32>;

// Runs before the first bounce.
@compute @workgroup_size(THREADS)
fn begin(@builtin(local_invocation_index) lane: u32) {
    for (var i = lane; i < arrayLength(&groups); i += THREADS) {
        groups[i] = table[i];
    }
}

// Runs after each bounce. After bounces that were skipped it reads nothing, and so changes nothing.
@compute @workgroup_size(THREADS)
fn decide(@builtin(local_invocation_index) lane: u32) {
    let count = select(tiles().x * tiles().y, 0u, groups[0] == 0u);
    var own: Change;
    for (var tile = lane; tile < count; tile += THREADS) {
        own = both(own, changes[tile]);
    }
    let all = over_group(own, lane);
    if lane == 0u && all.largest <= CONVERGED * all.sum / max(all.count, 1.0) {
        for (var i = 0u; i < arrayLength(&groups); i++) {
            groups[i] = 0u;
        }
    }
}
