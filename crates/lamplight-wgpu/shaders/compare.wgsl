// What surfaces send on, compared with what they sent on in the round before.

@group(0) @binding(1) var<uniform> step: u32;
// Light that surfaces send on in this round, by face, 0 in the fourth place where there is none;
@group(0) @binding(2) var<storage, read> received: array<vec4f>;
// and in the round before, which it replaces.
@group(0) @binding(3) var<storage, read_write> sent: array<vec4f>;
@group(0) @binding(4) var<storage, read_write> found: array<Found>;

@compute @workgroup_size(SIDE, SIDE)
fn main(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) thread: u32,
) {
    var own: Found;
    if !outside(id.xy) {
        let first = 4u * index(id.xy);
        for (var slot = first; slot < first + 4u; slot++) {
            let now = received[slot];
            // Before the first round nothing was sent.
            let old = select(sent[slot].rgb, vec3f(0.0), step == 0u);
            sent[slot] = now;
            if now.w > 0.0 {
                own = both(own, changed(old, now.rgb));
            }
        }
    }
    let all = over_group(own, thread);
    if thread == 0u {
        found[place(tile)] = all;
    }
}
