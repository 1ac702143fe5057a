// Pass A of `polar`, once all rays are known: between which distances a pixel on a ray has to look
// closer, and at how many rays to either side (`Fan::bound` of the library).
//
// A workgroup is 64 rays of one lamp and those that may throw a penumbra on them.

override NEAREST: f32;
override NARROWEST: f32;
override WIDEST: f32;
// Whether only the nearest ray counts.
override CRISP: bool;

@group(0) @binding(2) var<storage, read> hits: array<vec2u>;
// Of each ray: lit before, dark from, 1/length (0 where it met nothing), and the window with 256 where
// this ray's wall and the next ray's touch.
@group(0) @binding(3) var<storage, read_write> bounds: array<vec4u>;

// WIDEST and one.
const HALO: u32 = 65u;
const RAYS: u32 = 64u + 2u * HALO;

var<workgroup> lengths: array<f32, RAYS>;
var<workgroup> cells: array<u32, RAYS>;
// Half width of the penumbra, in rays, where it is widest; negative where there is none.
var<workgroup> widest: array<f32, RAYS>;
var<workgroup> most: atomic<u32>;

fn inverse_of(length: f32) -> f32 {
    return select(1.0 / max(length, NEAREST), 0.0, length == FAR);
}

fn touch(a: u32, b: u32) -> bool {
    let apart = abs(vec2i(vec2u(a & 0xffffu, a >> 16u)) - vec2i(vec2u(b & 0xffffu, b >> 16u)));
    return a != NO_CELL && b != NO_CELL && all(apart <= vec2i(1));
}

// The distance from which a pixel on a ray sees nothing of the lamp: walls without a gap to either
// side, as far as its penumbra reaches.
fn dark_from(own: u32) -> f32 {
    var far = 0.0;
    for (var side = 0u; side < 2u; side++) {
        for (var k = 0u; k < HALO; k++) {
            let i = select(own - k, own + k, side == 0u);
            if widest[i] < 0.0 {
                return FAR;
            }
            far = max(far, lengths[i]);
            if f32(k) >= widest[i] {
                break;
            }
            if !touch(cells[i], cells[select(i - 1u, i + 1u, side == 0u)]) {
                return FAR;
            }
        }
    }
    return far;
}

@compute @workgroup_size(64)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let start = (group.y * groups.x + group.x) * 64u;
    if start >= lamps.rays {
        return;
    }
    let lamp = lamps.list[lamp_of(start)];
    let n = lamp.count;
    let own = start - lamp.first + lane;
    // A penumbra covers no ray twice.
    let half_way = (n - 1u) / 2u;
    for (var i = lane; i < RAYS; i += 64u) {
        let ray = (start - lamp.first + i + HALO * (n - 1u)) % n;
        let hit = hits[lamp.first + ray];
        let length = bitcast<f32>(hit.x);
        lengths[i] = length;
        cells[i] = hit.y;
        widest[i] = -1.0;
        if length != FAR {
            let wide = lamp.spread * (inverse_of(length) - 1.0 / lamp.reach);
            widest[i] = clamp(wide, NARROWEST, WIDEST);
            atomicMax(&most, min(u32(widest[i] + 1.0), half_way));
        }
    }
    workgroupBarrier();
    if own >= n {
        return;
    }
    let here = lane + HALO;
    let length = lengths[here];
    var lit = length;
    var dark = length;
    var window = 0u;
    if !CRISP {
        let reach = atomicLoad(&most);
        for (var k = 1u; k <= reach; k++) {
            for (var side = 0u; side < 2u; side++) {
                let i = select(here - k, here + k, side == 0u);
                if widest[i] >= 0.0 && min(u32(widest[i] + 1.0), half_way) >= k {
                    lit = min(lit, lengths[i]);
                    window = k;
                }
            }
        }
        dark = dark_from(here);
    }
    let joined = select(0u, 256u, touch(cells[here], cells[here + 1u]));
    bounds[start + lane] =
        vec4u(bitcast<u32>(lit), bitcast<u32>(dark), bitcast<u32>(inverse_of(length)), window | joined);
}
