// What a pixel reads from a lamp's fan: `Fan` of the library (`fan.rs`, which says why).
//
// Loops stand where the same call would stand twice: compilers write out every call, and a walk
// through the grid takes many registers.

override EDGES: u32;
const NEAREST_RAY: u32 = 2u;
override NARROWEST: f32;
override WIDEST: f32;

// Made by polar_bounds.wgsl.
@group(0) @binding(5) var<storage, read> bounds: array<vec4u>;
// First knot of each ray, and how many it has.
@group(0) @binding(6) var<storage, read> stretches: array<vec2u>;
@group(0) @binding(7) var<storage, read> knots: array<vec4f>;
@group(0) @binding(8) var<storage, read> used: u32;

const JOINED: u32 = 256u;

// Share of a lamp's light that gets to a place beside it.
fn arriving(lamp: Lamp, off: vec2f, distance: f32) -> vec3f {
    var at = angle(off) * lamp.per_radian;
    at += select(0.0, f32(lamp.count), at < 0.0);
    let bound = bounds[lamp.first + wrapped(lamp, u32(at + 0.5))];
    var share = 1.0;
    if distance >= bitcast<f32>(bound.x) {
        if distance >= bitcast<f32>(bound.y) {
            return vec3f(0.0);
        }
        share = partly_seen(lamp, off, at);
    }
    if share > 0.0 && lamp.cone.y >= 0.0 {
        share *= cone_at(lamp, at);
    }
    if share <= 0.0 {
        return vec3f(0.0);
    }
    if TRANSLUCENT && used > 0u {
        return share * through(lamp, at, distance);
    }
    return vec3f(share);
}

fn length_of(off: vec2f) -> f32 {
    return sqrt(off.x * off.x + off.y * off.y);
}

fn wrapped(lamp: Lamp, ray: u32) -> u32 {
    return ray - select(0u, lamp.count, ray >= lamp.count);
}

fn cone_at(lamp: Lamp, at: f32) -> f32 {
    if EDGES == NEAREST_RAY {
        return in_cone(lamp, wrapped(lamp, u32(at + 0.5)), lamp.count);
    }
    let first = u32(at);
    let a = in_cone(lamp, wrapped(lamp, first), lamp.count);
    let b = in_cone(lamp, wrapped(lamp, first + 1u), lamp.count);
    return a + (b - a) * (at - f32(first));
}

// Share of the lamp that a pixel between its ray's bounds sees.
fn partly_seen(lamp: Lamp, off: vec2f, at: f32) -> f32 {
    let nearest = u32(at + 0.5);
    let own = wrapped(lamp, nearest);
    let inverse = 1.0 / length_of(off);
    let beside_ray = f32(nearest) - at;
    let bound = bounds[lamp.first + own];
    let shadowed = bitcast<f32>(bound.z) > inverse;
    let window = bound.w & (JOINED - 1u);
    var seen = 0.0;
    for (var side = 0u; side < 2u; side++) {
        let forward = side == 0u;
        // β up to which is settled.
        var done = 0.0;
        var wall = false;
        var i = own;
        var before_joined = false;
        for (var k = 0u; k <= window + 1u; k++) {
            let ray = bounds[lamp.first + i];
            let joined = (ray.w & JOINED) != 0u;
            let above = bitcast<f32>(ray.z) - inverse;
            let width = clamp(lamp.spread * above, NARROWEST, WIDEST);
            let middle = select(-beside_ray, beside_ray, forward) + f32(k);
            let last_gap = k > window;
            let blocks = above > 0.0 && !last_gap;
            if last_gap || (blocks && !(wall && select(joined, before_joined, forward))) {
                let to = select((middle - 0.5) / width, 1.0, last_gap);
                seen += gap(lamp, off, done, to, shadowed, forward);
            }
            if blocks {
                done = max(done, (middle + 0.5) / width);
                if done >= 1.0 {
                    break;
                }
            }
            wall = blocks;
            before_joined = joined;
            if forward {
                i = wrapped(lamp, i + 1u);
            } else {
                i = select(i, lamp.count, i == 0u) - 1u;
            }
        }
    }
    return 0.5 * seen;
}

// What is seen between two β. Who is in the shadow of the lamp's middle has to look whether the light
// that gets past its wall is not stopped by another that the lamp's middle does not see.
fn gap(lamp: Lamp, off: vec2f, from_: f32, to: f32, shadowed: bool, forward: bool) -> f32 {
    let width = min(to, 1.0) - from_;
    if width > 0.0 && (!shadowed || arrives(lamp, off, from_ + 0.5 * width, forward)) {
        return width;
    }
    return 0.0;
}

// Whether nothing stands between a pixel's side and the part β of the lamp, or between that and the
// lamp's middle.
fn arrives(lamp: Lamp, off: vec2f, part: f32, forward: bool) -> bool {
    let turn = select(-1.0, 1.0, forward) / length_of(off);
    let aside = vec2f(-off.y, off.x) * turn;
    let size = part * lamp.spread / lamp.per_radian;
    let lamp_part = lamp.position + size * aside;
    // Half a px aside is within the pixel, whatever the direction.
    let here = lamp.position + off + 0.5 * aside;
    let round_the_grid = within(lamp.position) && !within(lamp_part);
    if round_the_grid {
        return false;
    }
    for (var i = 0u; i < 2u; i++) {
        if !sees(select(here, lamp.position, i == 1u), lamp_part) {
            return false;
        }
    }
    return true;
}

fn within(at: vec2f) -> bool {
    return all(at >= vec2f(0.0)) && all(at < vec2f(frame.size));
}

fn sees(from_: vec2f, to: vec2f) -> bool {
    let off = to - from_;
    let length = length_of(off);
    let along = off / max(length, LEAST);
    let sign = select(vec2f(1.0), vec2f(-1.0), along < vec2f(0.0));
    return walk(from_, way(abs(along), sign), length, false, false).cell == NO_CELL;
}

// Share of light that fog and glass let through to a pixel.
fn through(lamp: Lamp, at: f32, distance: f32) -> vec3f {
    let first = select(u32(at), u32(at + 0.5), EDGES == NEAREST_RAY);
    let rays = select(2u, 1u, EDGES == NEAREST_RAY);
    var let_through: array<vec3f, 2>;
    for (var i = 0u; i < rays; i++) {
        let_through[i] = along_ray(lamp, wrapped(lamp, first + i), distance);
    }
    if rays == 1u {
        return let_through[0];
    }
    return let_through[0] + (let_through[1] - let_through[0]) * (at - f32(first));
}

fn along_ray(lamp: Lamp, ray: u32, distance: f32) -> vec3f {
    let stretch = stretches[lamp.first + ray];
    if stretch.y == 0u {
        return vec3f(1.0);
    }
    if stretch.x >= arrayLength(&knots) {
        return sought_anew(lamp, ray, distance);
    }
    // The first knot that is not nearer than the pixel.
    let end = stretch.x + stretch.y;
    var low = stretch.x;
    var high = end;
    while low < high {
        let middle = (low + high) / 2u;
        if knots[middle].w < distance {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    if low == stretch.x {
        return vec3f(1.0);
    }
    let known = knots[low - 1u];
    if low == end {
        return exp(known.xyz);
    }
    return exp(between(known, knots[low], distance));
}

var<private> sought: f32;
var<private> nearer: Knot;
var<private> found: bool;

fn keep(knot: Knot, number: u32) {
    if found {
        return;
    }
    if knot.w < sought {
        nearer = knot;
        return;
    }
    found = true;
    if number > 0u {
        nearer = Knot(between(nearer, knot, sought), sought);
    }
}

// The same for a ray whose knots found no room: walks it anew.
fn sought_anew(lamp: Lamp, ray: u32, distance: f32) -> vec3f {
    sought = distance;
    nearer = Knot(0.0);
    found = false;
    begin_knots(lamp);
    _ = send(lamp, ray);
    end_knots();
    return exp(nearer.xyz);
}
