// The light of a lamp at a pixel, read from its shadow map (`shadow_map.rs` of the library derives it).
//
// Loops avoid inlining the same call twice: compilers inline everything, and a grid traversal needs many
// registers.

#import methods/polar/shadow_ray

override SHADOW_FILTER: u32;
const NEAREST_RAY: u32 = 2u;
override NARROWEST: f32;
override WIDEST: f32;

// As shadow_bounds.wgsl makes them.
@group(0) @binding(5) var<storage, read> bounds: array<vec4u>;
// The first corner of each ray, and their number.
@group(0) @binding(6) var<storage, read> curves: array<vec2u>;
@group(0) @binding(7) var<storage, read> corners: array<vec4f>;
@group(0) @binding(8) var<storage, read> used: u32;

const JOINED: u32 = 256u;
const FACE_Y: u32 = 512u;
const FACE_PLACE: u32 = 10u;

// The mean place across the lamp of what was seen of it last.
var<private> seen_place: f32;

// The fraction of a lamp's light that arrives at a place `off` from it.
fn arriving(lamp: Lamp, off: vec2f, distance: f32) -> vec3f {
    var at = angle(off) * lamp.per_radian;
    at += select(0.0, f32(lamp.count), at < 0.0);
    let bound = bounds[lamp.first + wrapped(lamp, u32(at + 0.5))];
    var fraction = 1.0;
    seen_place = 0.0;
    if distance >= bitcast<f32>(bound.x) {
        if distance >= bitcast<f32>(bound.y) {
            return vec3f(0.0);
        }
        fraction = visible_fraction(lamp, off, at);
    }
    if fraction > 0.0 && lamp.cone.y >= 0.0 {
        fraction *= cone_at(lamp, at);
    }
    if fraction <= 0.0 {
        return vec3f(0.0);
    }
    if TRANSLUCENT && used > 0u {
        return fraction * transmittance_at(lamp, at, distance);
    }
    return vec3f(fraction);
}

fn length_of(off: vec2f) -> f32 {
    return sqrt(off.x * off.x + off.y * off.y);
}

fn wrapped(lamp: Lamp, ray: u32) -> u32 {
    return ray - select(0u, lamp.count, ray >= lamp.count);
}

fn cone_at(lamp: Lamp, at: f32) -> f32 {
    if SHADOW_FILTER == NEAREST_RAY {
        return in_cone(lamp, wrapped(lamp, u32(at + 0.5)), lamp.count);
    }
    let first = u32(at);
    let a = in_cone(lamp, wrapped(lamp, first), lamp.count);
    let b = in_cone(lamp, wrapped(lamp, first + 1u), lamp.count);
    return a + (b - a) * (at - f32(first));
}

// The fraction of the lamp that a pixel in the penumbra sees.
fn visible_fraction(lamp: Lamp, off: vec2f, at: f32) -> f32 {
    let nearest = u32(at + 0.5);
    let own = wrapped(lamp, nearest);
    let inverse = 1.0 / length_of(off);
    let beside_ray = f32(nearest) - at;
    let bound = bounds[lamp.first + own];
    let shadowed = bitcast<f32>(bound.z) > inverse;
    let behind = is_behind(lamp, bound.w, off);
    let window = bound.w & (JOINED - 1u);
    var seen = 0.0;
    var places = 0.0;
    for (var side = 0u; side < 2u; side++) {
        let forward = side == 0u;
        let aside = vec2f(-off.y, off.x) * select(-inverse, inverse, forward);
        let rim = lamp.spread / lamp.per_radian * aside;
        // The part β of the lamp up to which visibility is settled.
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
            let goes_on = wall && select(joined, before_joined, forward);
            var hidden_from = 1.0;
            wall = false;
            if above > 0.0 && !last_gap {
                hidden_from = hides_from(lamp, ray.w, off, rim);
                // A wall beside the pixel goes on past a corner, too.
                wall = hidden_from < 1.0 || (goes_on && middle >= 1.0);
            }
            if last_gap || (wall && !goes_on) {
                let to = select(max((middle - 0.5) / width, hidden_from), 1.0, last_gap);
                let part = gap(lamp, off, aside, done, to, shadowed, behind);
                seen += part;
                places += select(-0.5, 0.5, forward) * part * (2.0 * done + part);
            }
            if wall {
                done = max(max(done, (middle + 0.5) / width), hidden_from);
                if done >= 1.0 {
                    break;
                }
            }
            before_joined = joined;
            if forward {
                i = wrapped(lamp, i + 1u);
            } else {
                i = select(i, lamp.count, i == 0u) - 1u;
            }
        }
    }
    seen_place = select(0.0, places / seen, seen > 0.0);
    return 0.5 * seen;
}

// The place of the face that a ray hits, along its axis and from the lamp's centre; 0 if there is none.
fn face_place(lamp: Lamp, ray: u32) -> f32 {
    let place = ray >> FACE_PLACE;
    let center = select(lamp.position.x, lamp.position.y, (ray & FACE_Y) != 0u);
    return select(0.0, f32(place) - 1.0 - center, place > 0u);
}

// Returns whether the face that a ray hits lies behind a pixel, as seen from the lamp's centre.
fn is_behind(lamp: Lamp, ray: u32, off: vec2f) -> bool {
    let place = face_place(lamp, ray);
    return (place - select(off.x, off.y, (ray & FACE_Y) != 0u)) * place > 0.0;
}

// The part β of the lamp from which on the face that a ray hits may hide it from a pixel; `rim` is the part β = 1.
fn hides_from(lamp: Lamp, ray: u32, off: vec2f, rim: vec2f) -> f32 {
    if !is_behind(lamp, ray, off) {
        return 0.0;
    }
    let along = select(rim.x, rim.y, (ray & FACE_Y) != 0u);
    return 1.0 / max(along / face_place(lamp, ray), MIN_POSITIVE);
}

// The visible part of the lamp between two β. A point that is occluded from the lamp's centre may still see
// part of the disc past the occluder, unless a second occluder, which the centre cannot see, covers it.
fn gap(lamp: Lamp, off: vec2f, aside: vec2f, low: f32, high: f32, shadowed: bool, behind: bool) -> f32 {
    let width = min(high, 1.0) - low;
    if width > 0.0 && (!shadowed || arrives(lamp, off, aside, low + 0.5 * width, behind)) {
        return width;
    }
    return 0.0;
}

// Returns whether nothing lies between a pixel's side and the part β of the lamp, nor between that part and
// the lamp's centre; or, if the face that the ray hits is behind the pixel, between the pixel and the lamp's centre: what
// a ray beside a face misses may still stand there. A loop has one copy of the walk for the three lines.
fn arrives(lamp: Lamp, off: vec2f, aside: vec2f, part: f32, behind: bool) -> bool {
    let size = part * lamp.spread / lamp.per_radian;
    let lamp_part = lamp.position + size * aside;
    let pixel = lamp.position + off;
    // Half a px aside is within the pixel, whatever the direction.
    let here = pixel + 0.5 * aside;
    let around_the_grid = within(lamp.position) && !within(lamp_part);
    for (var i = select(1u, 0u, behind); i < 3u; i++) {
        let to_center = i == 0u;
        if !to_center && around_the_grid {
            return false;
        }
        let start = select(select(here, lamp.position, i == 2u), pixel, to_center);
        let arrived = sees(start, select(lamp_part, lamp.position, to_center));
        if arrived == to_center {
            return to_center;
        }
    }
    return true;
}

fn within(at: vec2f) -> bool {
    return all(at >= vec2f(0.0)) && all(at < vec2f(frame.size));
}

fn sees(start: vec2f, end: vec2f) -> bool {
    let off = end - start;
    let length = length_of(off);
    let along = off / max(length, MIN_POSITIVE);
    let sign = select(vec2f(1.0), vec2f(-1.0), along < vec2f(0.0));
    return traverse(start, direction(abs(along), sign), length, false, false).cell == NO_CELL;
}

// The transmittance of media between the lamp and a pixel.
fn transmittance_at(lamp: Lamp, at: f32, distance: f32) -> vec3f {
    let first = select(u32(at), u32(at + 0.5), SHADOW_FILTER == NEAREST_RAY);
    let rays = select(2u, 1u, SHADOW_FILTER == NEAREST_RAY);
    // Not in an array, since one that is indexed in a loop lies in memory.
    var before = vec3f(0.0);
    var own = vec3f(0.0);
    for (var i = 0u; i < rays; i++) {
        before = own;
        own = along_ray(lamp, wrapped(lamp, first + i), distance);
    }
    return select(before + (own - before) * (at - f32(first)), own, rays == 1u);
}

fn along_ray(lamp: Lamp, ray: u32, distance: f32) -> vec3f {
    let curve = curves[lamp.first + ray];
    if curve.y == 0u {
        return vec3f(1.0);
    }
    if curve.x >= arrayLength(&corners) {
        return traced_again(lamp, ray, distance);
    }
    // Binary search for the first corner that is not nearer than the pixel.
    let end = curve.x + curve.y;
    var low = curve.x;
    var high = end;
    while low < high {
        let middle = (low + high) / 2u;
        if corners[middle].w < distance {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    if low == curve.x {
        return vec3f(1.0);
    }
    let near = corners[low - 1u];
    if low == end {
        return exp(-near.xyz);
    }
    return exp(-between(near, corners[low], distance));
}

var<private> wanted: f32;
var<private> nearer: Corner;
var<private> found: bool;

fn keep(corner: Corner, number: u32) {
    if found {
        return;
    }
    if corner.w < wanted {
        nearer = corner;
        return;
    }
    found = true;
    if number > 0u {
        nearer = Corner(between(nearer, corner, wanted), wanted);
    }
}

// The transmittance along a ray whose curve found no room in the store.
fn traced_again(lamp: Lamp, ray: u32, distance: f32) -> vec3f {
    wanted = distance;
    nearer = Corner(0.0);
    found = false;
    begin_curve(lamp);
    _ = trace(lamp, ray);
    end_curve();
    return exp(-nearer.xyz);
}
