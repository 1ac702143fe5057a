// The à-trous wavelet transform (Dammertz et al. 2010), whose range of light follows the variance of the
// noise (Schied et al. 2017). The library's `denoise.rs` derives it.

#import shared/luminance
#import shared/moment
#import shared/normal
#import shared/uniforms

override MAX_SKIP: u32;
override MARGIN: f32;
// B-spline weights, by distance in taps.
override KERNEL_0: f32;
override KERNEL_1: f32;
override KERNEL_2: f32;
// The range of light, in standard deviations of the noise, and that in the first pass and along walls.
override DEVIATIONS: f32;
override WIDE_DEVIATIONS: f32;
// The weight of a difference in transmittance.
override TRANSMITTANCE: f32;
// The widest spread of taps along walls, px.
override WALL_SPREAD: i32;
// The distance along walls from which the noise is known, px.
override WALL_REACH: i32;
// True if `near` holds distances instead of squares of empty space.
override BY_DISTANCE: bool;

// Keeps a range above 0: the smallest positive normal number.
const MIN_POSITIVE: f32 = 1.17549435e-38;

@group(0) @binding(1) var<uniform> step: u32;
@group(0) @binding(2) var matter: texture_2d<f32>;
@group(0) @binding(3) var<storage, read> near: array<u32>;
@group(0) @binding(4) var<storage, read> traced: array<vec2f>;
// Light and the variance of its luminance; then the first moment, if it is found.
@group(0) @binding(5) var<storage, read> before: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> after: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> light: array<vec4f>;

fn open(at: vec2i) -> bool {
    return textureLoad(matter, at, 0).a < 1.0;
}

// Returns whether the line between two centres lies in space that is known to be empty.
fn skips(at: vec2i, offset: vec2i) -> bool {
    let field = near[index(vec2u(at))];
    if BY_DISTANCE {
        return length(vec2f(offset)) < bitcast<f32>(field) - MARGIN;
    }
    let shift = select(0u, 8u, offset.x < 0) + select(0u, 16u, offset.y < 0);
    return u32(max(abs(offset.x), abs(offset.y))) < ((field >> shift) & MAX_SKIP);
}

// Returns whether the line between the centres of two cells meets no solid cell. A corner between two solid
// cells blocks it.
fn sees(start: vec2i, offset: vec2i) -> bool {
    if skips(start, offset) {
        return true;
    }
    let count = abs(offset);
    let towards = sign(offset);
    var at = start;
    var done = vec2i(0);
    while any(done != count) {
        let next = (1 + 2 * done.x) * count.y - (1 + 2 * done.y) * count.x;
        if next == 0 && !open(at + vec2i(towards.x, 0)) && !open(at + vec2i(0, towards.y)) {
            return false;
        }
        let steps = vec2i(vec2<bool>(next <= 0, next >= 0));
        at += towards * steps;
        done += steps;
        if !open(at) {
            return false;
        }
    }
    return true;
}

// The transmittance of a px of a cell.
fn transmittance(at: vec2i) -> vec3f {
    let tint_opacity = textureLoad(matter, at, 0);
    return (1.0 - tint_opacity.a) * tint_opacity.rgb;
}

// The weight of a cell in the light of another by the transmittance of both.
fn likeness(own: vec3f, other: vec3f) -> f32 {
    let difference = abs(own - other);
    return exp(-TRANSMITTANCE * max(difference.r, max(difference.g, difference.b)));
}

// The weight of a tap by its position and matter, for a cell of this transmittance; 0 if it lies outside or is not visible.
fn tap(at: vec2i, own: vec3f, place: vec2i, spread: i32) -> f32 {
    let offset = place * spread;
    if !inside(at + offset) || !sees(at, offset) {
        return 0.0;
    }
    let weights = vec3f(KERNEL_0, KERNEL_1, KERNEL_2);
    return weights[abs(place.x)] * weights[abs(place.y)] * likeness(own, transmittance(at + offset));
}

// The sides to which a solid cell is open, a bit each: left, right, upper, lower; none of another cell.
fn open_sides(at: vec2i) -> u32 {
    var sides = 0u;
    for (var side = 0u; side < 4u && !open(at); side++) {
        let beside = at + normal(side);
        sides |= select(0u, 1u << side, inside(beside) && open(beside));
    }
    return sides;
}

// The direction along a wall in which a cell is blurred, if it is open to the left and the right only or above and below only.
fn direction_along(sides: u32) -> vec2i {
    let horizontal = (sides & 12u) != 0u;
    return select(vec2i(0), select(vec2i(0, 1), vec2i(1, 0), horizontal), ((sides & 3u) != 0u) != horizontal);
}

// Returns whether a cell belongs to a wall that is open to these sides.
fn continues(at: vec2i, sides: u32) -> bool {
    return inside(at) && open_sides(at) == sides;
}

// The variance of a solid cell, smoothed along its wall.
fn variance_along_wall(at: vec2i) -> f32 {
    let sides = open_sides(at);
    let along = direction_along(sides);
    var sum = traced[index(vec2u(at))].x;
    var weight = 1.0;
    for (var way = -1; way <= 1 && any(along != vec2i(0)); way += 2) {
        for (var away = 1; away <= WALL_REACH && continues(at + way * away * along, sides); away++) {
            sum += traced[index(vec2u(at + way * away * along))].x;
            weight += 1.0;
        }
    }
    return sum / weight;
}

// The light of a solid cell, blurred along its wall.
fn light_along_wall(at: vec2i, spread: i32) -> vec3f {
    let here = before[index(vec2u(at))];
    let sides = open_sides(at);
    let along = direction_along(sides);
    let range = WIDE_DEVIATIONS * sqrt(here.w) + MIN_POSITIVE;
    let weights = vec3f(KERNEL_0, KERNEL_1, KERNEL_2);
    var sum = KERNEL_0 * here.rgb;
    var weight = KERNEL_0;
    for (var way = -1; way <= 1 && any(along != vec2i(0)); way += 2) {
        for (var away = 1; away <= 2 * spread && continues(at + way * away * along, sides); away++) {
            if away % spread == 0 {
                let there = before[index(vec2u(at + way * away * along))].rgb;
                let w = weights[away / spread] * exp(-abs(luminance(there) - luminance(here.rgb)) / range);
                sum += w * there;
                weight += w;
            }
        }
    }
    return sum / weight;
}

// Smooths the variance, itself an estimate from few rays, over the visible taps.
@compute @workgroup_size(8, 8)
fn begin(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let at = vec2i(id.xy);
    let i = index(id.xy);
    var sum = 0.0;
    var weight = MIN_POSITIVE;
    if open(at) {
        let own = transmittance(at);
        for (var y = -2; y <= 2; y++) {
            for (var x = -2; x <= 2; x++) {
                let w = tap(at, own, vec2i(x, y), 1);
                if w > 0.0 {
                    sum += w * traced[index(vec2u(at + vec2i(x, y)))].x;
                    weight += w;
                }
            }
        }
    }
    after[i] = vec4f(light[i].rgb, select(variance_along_wall(at), sum / weight, open(at)));
    if MOMENT {
        let x = moment_index(0u, i);
        let y = moment_index(1u, i);
        after[x] = light[x];
        after[y] = light[y];
    }
}

@compute @workgroup_size(8, 8)
fn blur(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let at = vec2i(id.xy);
    let i = index(id.xy);
    let here = before[i];
    let spread = 1i << (step - 1u);
    if !open(at) {
        after[i] = here;
        if spread <= WALL_SPREAD {
            after[i] = vec4f(light_along_wall(at, spread), here.w);
        }
        if MOMENT {
            after[moment_index(0u, i)] = before[moment_index(0u, i)];
            after[moment_index(1u, i)] = before[moment_index(1u, i)];
        }
        return;
    }
    let own = transmittance(at);
    let range = select(DEVIATIONS, WIDE_DEVIATIONS, spread == 1) * sqrt(here.w) + MIN_POSITIVE;
    var sum = vec4f(0.0);
    var moment_x = vec4f(0.0);
    var moment_y = vec4f(0.0);
    var weight = 0.0;
    for (var y = -2; y <= 2; y++) {
        for (var x = -2; x <= 2; x++) {
            let kernel = tap(at, own, vec2i(x, y), spread);
            if kernel == 0.0 {
                continue;
            }
            let other = at + vec2i(x, y) * spread;
            let there = before[index(vec2u(other))];
            let difference = abs(luminance(there.rgb) - luminance(here.rgb)) / range;
            let w = kernel * exp(-difference);
            sum += vec4f(w, w, w, w * w) * there;
            weight += w;
            if MOMENT {
                moment_x += w * before[moment_index(0u, index(vec2u(other)))];
                moment_y += w * before[moment_index(1u, index(vec2u(other)))];
            }
        }
    }
    after[i] = sum / vec4f(weight, weight, weight, weight * weight);
    if MOMENT {
        after[moment_index(0u, i)] = moment_x / weight;
        after[moment_index(1u, i)] = moment_y / weight;
    }
}

@compute @workgroup_size(8, 8)
fn finish(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    light[i] = vec4f(before[i].rgb, 1.0);
    if MOMENT {
        light[moment_index(0u, i)] = before[moment_index(0u, i)];
        light[moment_index(1u, i)] = before[moment_index(1u, i)];
    }
}
