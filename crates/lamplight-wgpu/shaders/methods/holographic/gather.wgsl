// The final gather: pixels trace the few px to the plane ahead themselves, with one ray through the middle of
// each cone or, if the cone contains an emitter, several, and take the light of the plane where those end.
//
// With FACES the kernel finds the irradiance of faces instead of the light of pixels. Faces are shaded by the
// steps of their own wall: of light that comes down s px along the face for each px that it comes nearer, a
// step that begins k px beside the cell in front blocks the fraction `clamp(s − k, 0, 1)`.

#import methods/holographic/footprint
#import methods/holographic/sky
#import shared/moment

// Added to the sum of the weights at a ray's end, so that opaque cells let no light through, instead of 0 / 0.
override WEIGHT_EPSILON: f32;
// Cells beside the one in front of a face that are searched for a step.
override REACH: u32;
// True if the faces of solid cells, and media that scatter, are lit instead of pixels.
override FACES: bool;

@group(0) @binding(7) var<storage, read> cones: array<vec4f>;
@group(0) @binding(8) var<storage, read> radiance: array<vec2u>;
@group(0) @binding(9) var<storage, read_write> light: array<vec4f>;
@group(0) @binding(10) var<storage, read_write> irradiance: array<vec2u>;
@group(0) @binding(11) var albedo: texture_2d<f32>;

// The distance of a step that does not exist, px: farther than any light comes down.
const FAR_AWAY: f32 = 1e9;
const TAU: f32 = 6.2831855;

struct Pixel {
    slab: u32,
    row: u32,
    lane: u32,
    // Slabs to the plane, and the plane's index.
    ahead: u32,
    plane: u32,
}

// The light of a cone on the plane ahead.
fn far(pixel: Pixel, cone: u32, row: i32) -> vec3f {
    if row < 0 || row >= i32(sweep.rows) || pixel.plane >= planes(sweep.level) {
        return sky_in(cone);
    }
    // A plane of even index is a plane of the level above.
    let odd = (pixel.plane & 1u) == 1u;
    let slot = select(sweep.far - pixel.plane / 2u, sweep.far - (pixel.plane + 1u) / 2u, odd);
    let base = select(sweep.above, sweep.below, odd);
    let at = (slot * cone_count(sweep.level + 1u) + cone) * sweep.rows + u32(row);
    return unpack_rgb(radiance[base + at]);
}

// The transmittance of the cell at the end of a ray.
fn end_transmittance(pixel: Pixel, rows: i32) -> f32 {
    if !is(OCCUPIED, pixel.lane, i32(pixel.ahead), rows) {
        return 1.0;
    }
    if !is(MEDIUM, pixel.lane, i32(pixel.ahead), rows) {
        return 0.0;
    }
    let at = cell_of(pixel.slab + pixel.ahead, u32(i32(pixel.row) + rows));
    let tint_opacity = textureLoad(matter, at, 0);
    return (1.0 - tint_opacity.a) * tint_opacity.r;
}

// The light through a cone, whose entry begins at `at`: its angle and its cosines to the axis and to higher
// rows; rays of four words: first crossing, number of crossings, the row nearest to the end, and how far past
// its middle that is; a mask of two words per slab.
fn through(pixel: Pixel, cone: u32, at: u32, empty: bool) -> vec3f {
    let rays = at + 4u;
    let mask = rays + 4u * (sweep.rays + 1u);
    let meets = !empty && any_of(OCCUPIED, pixel.lane, mask, pixel.ahead + 1u);
    let emits = meets && any_of(EMITTING, pixel.lane, mask, pixel.ahead + 1u);
    let first = select(0u, 1u, emits);
    let count = select(1u, sweep.rays, emits);
    var sum = vec3f(0.0);
    for (var ray = first; ray < first + count; ray++) {
        let footprint = rays + 4u * ray;
        let row = bitcast<i32>(footprints[footprint + 2u]);
        let past = bitcast<f32>(footprints[footprint + 3u]);
        var near = nothing();
        // A quadratic B-spline over the rows before, at and after the nearest one.
        let sides = vec2f(0.5 - past, 0.5 + past);
        var weights = vec3f(0.5 * sides.x * sides.x, 0.75 - past * past, 0.5 * sides.y * sides.y);
        if meets {
            let crossings = footprints[footprint];
            near = march(pixel.slab, pixel.row, pixel.lane, crossings, footprints[footprint + 1u]);
            weights.x *= end_transmittance(pixel, row - 1);
            weights.y *= end_transmittance(pixel, row);
            weights.z *= end_transmittance(pixel, row + 1);
        }
        // A ray that has left the grid, perhaps over the end of a wall, takes no light from inside.
        let end = i32(pixel.row) + row;
        weights.x = select(weights.x, 0.0, end == i32(sweep.rows));
        weights.z = select(weights.z, 0.0, end == -1);
        var beyond = weights.x * far(pixel, cone, end - 1);
        beyond += weights.y * far(pixel, cone, end);
        beyond += weights.z * far(pixel, cone, end + 1);
        let all = WEIGHT_EPSILON + weights.x + weights.y + weights.z;
        sum += near.light * bitcast<f32>(footprints[at]) + near.transmittance * (beyond / all);
    }
    return sum / f32(count);
}

// A step of a wall beside the cell in front of a face: the radiance that leaves it, and in `w` its distance.
fn step(pixel: Pixel, slabs: i32, rows: i32, reach: u32, face: u32) -> vec4f {
    for (var away = 0u; away < reach; away++) {
        let to = vec2i(slabs, rows) * (i32(away) + 1);
        if is_solid(pixel.lane, to.x, to.y) {
            let cell = cell_of(u32(i32(pixel.slab) + to.x), u32(i32(pixel.row) + to.y));
            return vec4f(radiance_of(cell, true, face), f32(away));
        }
    }
    return vec4f(0.0, 0.0, 0.0, FAR_AWAY);
}

// The light through a cone that a step occludes in part.
fn shade(light: vec3f, angle: f32, slope: f32, step: vec4f) -> vec3f {
    return mix(light, step.rgb * angle, clamp(slope - step.w, 0.0, 1.0));
}

// Adds to the irradiance of a face of the cell `slabs` and `rows` from the pixel.
fn receive(pixel: Pixel, slabs: i32, rows: i32, face: u32, light: vec3f) {
    if is_solid(pixel.lane, slabs, rows) {
        let cell = cell_of(u32(i32(pixel.slab) + slabs), u32(i32(pixel.row) + rows));
        let at = 4u * index(cell) + face;
        irradiance[at] = pack_rgb(unpack_rgb(irradiance[at]) + light);
    }
}

// Adds to a component of a pixel's first moment; the first quadrant overwrites it.
fn add_moment(component: u32, i: u32, integral: vec3f) {
    let at = moment_index(component, i);
    let before = select(light[at].rgb, vec3f(0.0), sweep.first_quadrant == 1u);
    light[at] = vec4f(before + integral * (1.0 / TAU), 1.0);
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let slab = sweep.first + group.y;
    let plane = (slab + sweep.gather_length + (1u << sweep.level) - 1u) >> sweep.level;
    let ahead = (plane << sweep.level) - slab;
    let pixel = Pixel(slab, TILE * group.x + lane, lane, ahead, plane);
    fetch(lane, TILE, slab, i32(TILE * group.x), max(ahead, REACH));
    workgroupBarrier();
    let empty = atomicLoad(&any_near) == 0u;
    if pixel.row >= sweep.rows || (FACES && empty) {
        return;
    }
    let i = index(cell_of(slab, pixel.row));
    if is_solid(lane, 0, 0) {
        if !FACES && sweep.first_quadrant == 1u {
            light[i] = vec4f(0.0, 0.0, 0.0, 1.0);
            if MOMENT {
                light[moment_index(0u, i)] = vec4f(0.0);
                light[moment_index(1u, i)] = vec4f(0.0);
            }
        }
        return;
    }
    var scatters = false;
    if FACES {
        let front = is_solid(lane, -1, 0) || is_solid(lane, 0, -1) || is_solid(lane, 0, 1);
        scatters = is(MEDIUM, lane, 0, 0)
            && any(textureLoad(albedo, cell_of(slab, pixel.row), 0).rgb != vec3f(0.0));
        if !front && !scatters {
            return;
        }
    }
    let count = cone_count(sweep.level + 1u) - 2u;
    let size = 4u + 4u * (sweep.rays + 1u) + 2u * (ahead + 1u);
    let view = footprints[sweep.footprints + ahead - sweep.gather_length];
    var sum = vec3f(0.0);
    // ∫ L ω dω along the axis, and across it.
    var moment_along = vec3f(0.0);
    var moment_across = vec3f(0.0);
    var on_front = vec3f(0.0);
    var on_high = vec3f(0.0);
    var on_low = vec3f(0.0);
    var in_front = vec4f(0.0);
    var above = vec4f(0.0);
    var below = vec4f(0.0);
    if FACES {
        in_front = step(pixel, 1, 0, REACH, 0u);
        above = step(pixel, 0, 1, 1u, 1u);
        below = step(pixel, 0, -1, 1u, 2u);
    }
    for (var cone = 0u; cone < count; cone++) {
        let at = view + cone * size;
        // The outermost cones have no light.
        let found = through(pixel, cone + 1u, at, empty);
        sum += found;
        if MOMENT {
            moment_along += bitcast<f32>(footprints[at + 1u]) * found;
            moment_across += bitcast<f32>(footprints[at + 2u]) * found;
        }
        if FACES {
            let angle = bitcast<f32>(footprints[at]);
            let along = bitcast<f32>(footprints[at + 1u]);
            let across = bitcast<f32>(footprints[at + 2u]);
            let aside = abs(across);
            let to_side = aside * shade(found, angle, along / aside, in_front);
            if across > 0.0 {
                on_high += to_side;
                on_front += along * shade(found, angle, aside / along, above);
            } else {
                on_low += to_side;
                on_front += along * shade(found, angle, aside / along, below);
            }
        }
    }
    if !FACES {
        let before = select(light[i].rgb, vec3f(0.0), sweep.first_quadrant == 1u);
        light[i] = vec4f(before + sum * (1.0 / TAU), 1.0);
        if MOMENT {
            // Ahead is the other way where light comes from lower slabs; rows are the same.
            let along = select(1.0, -1.0, sweep.reversed == 1u) * moment_along;
            add_moment(0u, i, select(moment_across, along, sweep.axis == 0u));
            add_moment(1u, i, select(along, moment_across, sweep.axis == 0u));
        }
        return;
    }
    // Faces are left, right, top, bottom; each looks towards the light.
    let back = sweep.reversed == 1u;
    let front_face = 2u * sweep.axis + select(1u, 0u, back);
    let side_face = 2u * (1u - sweep.axis);
    receive(pixel, -1, 0, front_face, on_front);
    receive(pixel, 0, -1, side_face + 1u, on_high);
    receive(pixel, 0, 1, side_face, on_low);
    if scatters {
        irradiance[4u * i] = pack_rgb(unpack_rgb(irradiance[4u * i]) + sum * (1.0 / TAU));
    }
}
