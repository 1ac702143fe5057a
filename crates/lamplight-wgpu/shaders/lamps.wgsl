// Lamps as `lamps.rs` hands them over.

struct Lamp {
    position: vec2f,
    // px that its rays go within the grid.
    reach: f32,
    range: f32,
    // Colour times intensity.
    strength: vec3f,
    size: f32,
    falloff: u32,
    // Its first ray among those of all lamps, and how many it has.
    first: u32,
    count: u32,
    per_radian: f32,
    // Direction of the cone, half its angle (negative: no cone), and how much of that is soft.
    cone: vec3f,
    // Radius of the lamp in rays × px, 0 for edges that are not soft.
    spread: f32,
}

struct Lamps {
    count: u32,
    // Of all lamps, with what fills up the last workgroup of each.
    rays: u32,
    list: array<Lamp>,
}

@group(0) @binding(1) var<storage, read> lamps: Lamps;

// What rays keep that met nothing. FAR stands for infinity, which a shader may not rely on.
const FAR: f32 = 0x1.fffffep+127;
const NO_CELL: u32 = 0xffffffffu;

const TURN: f32 = 6.2831855;
const LINEAR: u32 = 0u;
const SMOOTH: u32 = 1u;

// The lamp of a ray.
fn lamp_of(ray: u32) -> u32 {
    var low = 0u;
    var high = lamps.count;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if lamps.list[middle].first <= ray {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

// A ray among those of all lamps, and what it is of its lamp.
struct LampRay {
    place: u32,
    lamp: u32,
    number: u32,
    // Not so beyond the last ray of a lamp, and of all.
    is_one: bool,
}

// The ray of a thread, 64 a workgroup.
fn ray_of(group: vec3u, groups: vec3u, lane: u32) -> LampRay {
    let place = (group.y * groups.x + group.x) * 64u + lane;
    if place >= lamps.rays {
        return LampRay();
    }
    let lamp = lamp_of(place);
    let number = place - lamps.list[lamp].first;
    return LampRay(place, lamp, number, number < lamps.list[lamp].count);
}

// Share of a lamp's light that arrives at a distance in the open: linear; smooth; or that of a disc,
// `asin(size/d)/π`, under the window of Karis (2013).
fn falloff(lamp: Lamp, distance: f32) -> f32 {
    let u = distance / lamp.range;
    let square = u * u;
    switch lamp.falloff {
        case LINEAR: {
            return max(1.0 - u, 0.0);
        }
        case SMOOTH: {
            let v = max(1.0 - square, 0.0);
            return v * v;
        }
        default: {
            let window = max(1.0 - square * square, 0.0);
            let sine = lamp.size / max(distance, lamp.size);
            let seen = angle(vec2f(sqrt(max(1.0 - sine * sine, 0.0)), sine)) * 0.31830989;
            return seen * window * window;
        }
    }
}

// Share of a lamp's light that leaves along ray `i` of `n`: smoothstep over the soft edge.
fn in_cone(lamp: Lamp, i: u32, n: u32) -> f32 {
    if lamp.cone.y < 0.0 {
        return 1.0;
    }
    var turned = TURN * (f32(i) / f32(n)) - lamp.cone.x;
    // The direction is at most a turn and a little to either side.
    turned += select(0.0, TURN, turned < 0.0);
    turned += select(0.0, TURN, turned < 0.0);
    turned -= select(0.0, TURN, turned >= TURN);
    let within = lamp.cone.y - min(turned, TURN - turned);
    if within < 0.0 {
        return 0.0;
    }
    if within >= lamp.cone.z {
        return 1.0;
    }
    let t = within / lamp.cone.z;
    return t * t * (3.0 - 2.0 * t);
}
