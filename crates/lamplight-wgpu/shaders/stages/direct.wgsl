// The direct light of lamps with exact light, and of suns (`stages/direct.rs` of the library): J of open cells, and
// E/2 of the faces of solid ones, four values per cell. In `w` 1 where there is such a face or cell. Of an open cell
// the first value is its light, and the next two its first moment.

#import methods/polar/penumbra
#import shared/angle
#import shared/class
#import shared/class_at
#import shared/cone
#import shared/cookie
#import shared/lamps
#import shared/layers
#import shared/moment
#import shared/normal
#import shared/reaching
#import shared/towards
#import shared/uniforms

struct Sun {
    // The way that its light travels.
    travels: vec2f,
    // tan(w/2) of its apparent width w, and w.
    slope: f32,
    width: f32,
    radiance: vec3f,
    // The layers that it lights, a bit each.
    mask: u32,
    // The factor on its first moment, by its elevation.
    moment_weight: f32,
}

struct Suns {
    count: u32,
    list: array<Sun>,
}

@group(0) @binding(4) var<storage, read> suns: Suns;
@group(0) @binding(5) var<storage, read_write> found: array<vec4f>;
@group(0) @binding(6) var masks: texture_2d<f32>;
@group(0) @binding(7) var cookies: texture_2d<f32>;

const PI: f32 = 3.1415927;
// Points across a lamp at which cosines are taken.
const POINTS: u32 = 16u;
// Points along a face, and their number where a lamp is near, where the edge of its cone may cross the face.
const ALONG_FACE: u32 = 3u;
const ALONG_NEAR_FACE: u32 = 12u;
const NEAR: f32 = 16.0;

// A place that receives light: an open cell, or a face of a solid one.
struct Place {
    exists: bool,
    slot: u32,
    is_face: bool,
    // Of a face; otherwise 0.
    normal: vec2f,
    // The layers of its cell.
    layers: u32,
}

// The place of a thread: cells, and in z the face. An open cell is in the place of the first.
fn place(id: vec3u) -> Place {
    let cell = vec2i(id.xy);
    let is_face = class_at(cell) == SOLID;
    let slot = 4u * index(id.xy) + id.z;
    let out = normal(id.z);
    let layers = layers_of(id.xy);
    if is_face {
        return Place(open(cell + out), slot, true, vec2f(out), layers);
    }
    return Place(open(cell) && id.z == 0u, slot, false, vec2f(0.0), layers);
}

// A point along a face, off its cell's centre: number `i` of `count`.
fn on_face(normal: vec2f, i: u32, count: u32) -> vec2f {
    let along = (f32(i) + 0.5) / f32(count) - 0.5;
    return (0.5 + OUTSIDE_OF_WALL) * normal + along * normal.yx;
}

fn disc_of(lamp: Lamp) -> LampDisc {
    return LampDisc(lamp.position, lamp.size);
}

// The mean of cosθ over the points of a lamp that are seen.
fn mean_cosine(lamp: Lamp, off: vec2f, normal: vec2f) -> f32 {
    let distance = length(off);
    var sum = 0.0;
    for (var i = 0u; i < POINTS; i++) {
        let at = across_part(stands, point(i, POINTS));
        let part = at * lamp.size / distance;
        let way = vec2f(-off.x - part * off.y, -off.y + part * off.x);
        let cosine = dot(normal, way) / length(way);
        if cosine > 0.0 && !is_hidden(at) {
            sum += cosine;
        }
    }
    return sum / f32(POINTS);
}

// The first moment of the light found so far at an open cell.
var<private> moment: array<vec3f, 2>;

fn add_to_moment(light: vec3f, direction: vec2f) {
    moment[0] += light * direction.x;
    moment[1] += light * direction.y;
}

// The light of a lamp at a place whose cell is at `off`.
fn light_of(lamp: Lamp, off: vec2f, place: Place) -> vec3f {
    let is_near = length(off) < NEAR;
    let points = select(1u, select(ALONG_FACE, ALONG_NEAR_FACE, is_near), place.is_face);
    // Of the lamp's light, per channel.
    var arrives = vec3f(0.0);
    var through_medium = false;
    for (var i = 0u; i < points; i++) {
        var at = off;
        if place.is_face {
            at += on_face(place.normal, i, points);
        }
        let falls = lamp_share(lamp, angle(at)) * falloff(lamp, length(at));
        // Behind the face no part of the lamp is seen.
        if falls > 0.0 && (!place.is_face || dot(place.normal, at) < lamp.size) {
            let picture = in_cookie(lamp, at);
            if all(picture == vec3f(0.0)) {
                continue;
            }
            hide_from(disc_of(lamp), at);
            through_medium = through_medium || meets_media;
            if place.is_face {
                arrives += falls * PI * mean_cosine(lamp, at, place.normal) * picture;
            } else {
                arrives += falls * seen() * picture;
            }
        }
    }
    var light = lamp.strength * arrives / f32(points);
    let before = off + place.normal;
    var direction = vec2f(0.0);
    let is_lit = any(arrives > vec3f(0.0));
    if MOMENT && is_lit && !place.is_face && any(off != vec2f(0.0)) {
        direction = towards(lamp, off, seen_middle());
    }
    if is_lit && through_medium && any(before != vec2f(0.0)) {
        light *= through_media_to_lamp(disc_of(lamp), before);
    }
    if MOMENT {
        add_to_moment(light, direction);
    }
    return light;
}

@compute @workgroup_size(16, 16)
fn shine_lamps(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let place = place(id);
    var sum = vec3f(0.0);
    for (var first = 0u; first < lamps.count; first += 256u) {
        find_reaching(first, tile.xy, lane);
        for (var word = 0u; word < 8u; word++) {
            var left = atomicLoad(&reaching[word]);
            while left != 0u {
                let lamp = lamps.list[first + 32u * word + firstTrailingBit(left)];
                left &= left - 1u;
                if place.exists && (lamp.mask & place.layers) != 0u {
                    sum += light_of(lamp, vec2f(id.xy) + 0.5 - lamp.position, place);
                }
            }
        }
    }
    if outside(id.xy) {
        return;
    }
    if !MOMENT || place.is_face {
        found[place.slot] = vec4f(sum, f32(place.exists));
    } else if id.z == 0u {
        found[place.slot] = vec4f(sum, f32(place.exists));
        found[place.slot + 1u] = vec4f(moment[0], 0.0);
        found[place.slot + 2u] = vec4f(moment[1], 0.0);
        found[place.slot + 3u] = vec4f(0.0);
    }
}

// ∫cosθ dθ over the directions of a sun up to its point `at`, of those above the horizon of a face.
fn cosines_up_to(sun: Sun, normal: vec2f, at: f32) -> f32 {
    let ahead = -sun.travels;
    let way = ahead + at * sun.slope * vec2f(ahead.y, -ahead.x);
    let sine = (normal.x * way.y - normal.y * way.x) / length(way);
    return -select(sign(sine), sine, dot(normal, way) > 0.0);
}

// The angle, or the integral of cosines, between two points of a sun.
fn received(sun: Sun, place: Place, interval: vec2f) -> f32 {
    if place.is_face {
        let up_to = cosines_up_to(sun, place.normal, interval.y);
        return up_to - cosines_up_to(sun, place.normal, interval.x);
    }
    return angle(vec2f(1.0, interval.y * sun.slope)) - angle(vec2f(1.0, interval.x * sun.slope));
}

// The light of a sun at a point of a place: J, or E/2 of a face. A face that looks away receives none.
fn light_of_sun(sun: Sun, at: vec2f, place: Place) -> vec3f {
    if place.is_face && dot(place.normal, sun.travels) > sun.slope {
        return vec3f(0.0);
    }
    // Of the corners of the grid, that where light arrives first.
    let first = select(vec2f(0.0), vec2f(frame.size), sun.travels < vec2f(0.0));
    let fan = Fan(at, -sun.travels, FAR, sun.slope, max(dot(at - first, sun.travels), 0.0));
    hide_nothing();
    hide_behind_walls(fan);
    var arrives = received(sun, place, vec2f(-1.0, 1.0));
    for (var k = 0u; k < part_count; k++) {
        arrives -= received(sun, place, parts[k]);
    }
    if arrives <= 0.0 {
        return vec3f(0.0);
    }
    var direction = vec2f(0.0);
    if MOMENT && !place.is_face {
        // ∫cosφ dφ and ∫sinφ dφ over what is seen.
        let half = 0.5 * sun.width;
        var along = 2.0 * sin(half);
        var beside = 0.0;
        for (var k = 0u; k < part_count; k++) {
            let low = normalize(vec2f(1.0, parts[k].x * sun.slope));
            let high = normalize(vec2f(1.0, parts[k].y * sun.slope));
            along -= high.y - low.y;
            beside -= low.x - high.x;
        }
        let ahead = clamp(vec2f(along, beside) / arrives, vec2f(-1.0), vec2f(1.0));
        direction = ahead.x * -sun.travels + ahead.y * vec2f(-sun.travels.y, sun.travels.x);
        direction *= sun.moment_weight;
    }
    var light = sun.radiance * arrives * select(1.0 / TURN, 0.5, place.is_face);
    if meets_media {
        light *= through_media(fan, WHOLE);
    }
    if MOMENT {
        add_to_moment(light, direction);
    }
    return light;
}

@compute @workgroup_size(16, 16)
fn shine_suns(@builtin(global_invocation_id) id: vec3u) {
    let place = place(id);
    if !place.exists {
        return;
    }
    let points = select(1u, ALONG_FACE, place.is_face);
    var sum = vec3f(0.0);
    for (var i = 0u; i < points * suns.count; i++) {
        if (suns.list[i / points].mask & place.layers) == 0u {
            continue;
        }
        var at = vec2f(id.xy) + 0.5;
        if place.is_face {
            at += on_face(place.normal, i % points, points);
        }
        sum += light_of_sun(suns.list[i / points], at, place);
    }
    found[place.slot] += vec4f(sum / f32(points), 0.0);
    if MOMENT && !place.is_face {
        found[place.slot + 1u] += vec4f(moment[0], 0.0);
        found[place.slot + 2u] += vec4f(moment[1], 0.0);
    }
}
