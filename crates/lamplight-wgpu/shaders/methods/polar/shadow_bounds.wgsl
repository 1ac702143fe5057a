// The bounds of each ray of the shadow maps, once all rays are traced: the distances between which a pixel
// near the ray is in its penumbra, and the rays to either side that it has to read (`shadow_map.rs` of the
// library).
//
// A workgroup takes 64 rays of one lamp and the rays whose penumbra may reach them.

#import shared/circle
#import shared/class_at
#import shared/ends
#import shared/hit
#import shared/lamps
#import shared/uniforms

override NEAREST: f32;
override NARROWEST: f32;
override WIDEST: f32;
// True if only the nearest ray counts.
override CRISP: bool;

@group(0) @binding(2) var<storage, read> hits: array<vec2u>;
// For each ray: the distance up to which pixels are lit, the one from which they are dark, 1/length (0 without
// a hit), and bits: 0 to 7 the window, 8 set if the solid cells of this ray and the next one touch, from 9 on
// the face that is hit.
@group(0) @binding(4) var<storage, read_write> bounds: array<vec4u>;

// WIDEST plus one.
const HALO: u32 = 65u;
const RAYS: u32 = 64u + 2u * HALO;

var<workgroup> lengths: array<f32, RAYS>;
var<workgroup> cells: array<u32, RAYS>;
// Half the width of the penumbra, in rays, where it is widest; negative without a hit.
var<workgroup> widest: array<f32, RAYS>;
var<workgroup> most: atomic<u32>;

fn inverse_of(length: f32) -> f32 {
    return select(1.0 / max(length, NEAREST), 0.0, length == FAR);
}

fn touch(a: u32, b: u32) -> bool {
    let apart = abs(vec2i(unpacked(a)) - vec2i(unpacked(b)));
    return a != NO_CELL && b != NO_CELL && all(apart <= vec2i(1));
}

// The face through which a ray enters the solid cell that it hits: bit 0 is set if it looks up or down, from bit
// 1 on its coordinate plus 1; 0 if the ray hits nothing or starts in the wall.
fn face_of(lamp: Lamp, ray: u32, hit: u32) -> u32 {
    if hit == NO_CELL {
        return 0u;
    }
    let direction = direction_of(ray, lamp.count);
    let edge = vec2f(unpacked(hit)) + max(-direction.sign, vec2f(0.0));
    let reached = (edge - lamp.position) * direction.inverse;
    let last = select(vec2i(1, 0), vec2i(0, 1), reached.y > reached.x);
    // Through a corner, a ray may enter beside another solid cell.
    let is_open = !ends(class_at(vec2i(unpacked(hit)) - last * vec2i(direction.sign)));
    let looks_up_or_down = (last.y == 1) == is_open;
    if select(reached.x, reached.y, looks_up_or_down) <= 0.0 {
        return 0u;
    }
    return select(2u * (u32(edge.x) + 1u), 2u * (u32(edge.y) + 1u) + 1u, looks_up_or_down);
}

// The distance from which a pixel near a ray sees nothing of the lamp: solid cells without a gap to either
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
    // Not a `RayThread`: browsers take all fields of a parameter that differs by thread to differ by thread,
    // and a barrier may stand only where the whole workgroup goes.
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let start = first_ray(group, groups);
    if start >= lamps.rays {
        return;
    }
    let lamp = lamps.list[lamp_of(start)];
    let n = lamp.count;
    let own = start - lamp.first + lane;
    // A penumbra covers no ray twice.
    let half_circle = (n - 1u) / 2u;
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
            atomicMax(&most, min(u32(widest[i] + 1.0), half_circle));
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
                if widest[i] >= 0.0 && min(u32(widest[i] + 1.0), half_circle) >= k {
                    lit = min(lit, lengths[i]);
                    window = k;
                }
            }
        }
        dark = dark_from(here);
    }
    let joined = select(0u, 256u, touch(cells[here], cells[here + 1u]));
    let face = face_of(lamp, own, cells[here]) << 9u;
    bounds[start + lane] =
        vec4u(bitcast<u32>(lit), bitcast<u32>(dark), bitcast<u32>(inverse_of(length)), window | joined | face);
}
