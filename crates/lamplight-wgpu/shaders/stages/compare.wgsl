// Replaces the scattered radiance by that of the next bounce, and measures the change.

#import shared/change
#import shared/uniforms

@group(0) @binding(1) var<uniform> step: u32;
// Scattered radiance of this bounce, by face; in `w` 0 where nothing scatters.
@group(0) @binding(2) var<storage, read> next: array<vec4f>;
// That of the bounce before.
@group(0) @binding(3) var<storage, read_write> scattered: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> changes: array<Change>;

@compute @workgroup_size(SIDE, SIDE)
fn main(thread: TileThread) {
    var own: Change;
    if !outside(thread.id.xy) {
        let first = 4u * index(thread.id.xy);
        for (var slot = first; slot < first + 4u; slot++) {
            let now = next[slot];
            // Before the first bounce there is no scattered radiance.
            let old = select(scattered[slot].rgb, vec3f(0.0), step == 0u);
            scattered[slot] = now;
            if now.w > 0.0 {
                own = both(own, change_of(old, now.rgb));
            }
        }
    }
    let all = over_group(own, thread.lane);
    if thread.lane == 0u {
        changes[tile_index(thread.tile)] = all;
    }
}
