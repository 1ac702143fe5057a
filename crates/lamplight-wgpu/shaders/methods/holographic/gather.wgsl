// The final gather: pixels trace the few px to the plane ahead themselves, with one ray through the middle of
// each cone, or several if it contains an emitter (in the widest lattice, beside the axis, any matter), and take the light of the
// plane where those end.
//
// A workgroup takes some slabs that look at the same plane, whose light it unpacks once for all, some cones at a time.
// A lane per slab and cone finds what rays meet, from all rows of the tile. Most meet nothing, and are summed first; most
// others are stopped by dark walls. Each pixel traces what it has left afterwards, so that none waits for the cones of
// another.
//
// The same light is the irradiance of faces, and without PIXELS only that is found. Faces are shaded by the
// steps of their own wall: of light that comes down s px along the face for each px that it comes nearer, a
// step that begins k px beside the cell in front blocks the fraction `clamp(s − k, 0, 1)`.

#import methods/holographic/border
#import methods/holographic/light_pair
#import methods/holographic/point_rows
#import shared/moment

// Added to the sum of the weights at a ray's end, so that opaque cells let no light through, instead of 0 / 0.
override WEIGHT_EPSILON: f32;
// Cells beside the one in front of a face that are searched for a step.
override REACH: u32;
// False if only the faces of solid cells, and media that scatter, are lit.
override PIXELS: bool;
// Cones of a pixel.
override CONES: u32;
// True if pixels send several rays through the two cones beside the axis wherever there is matter.
override SPLITS_AT_MATTER: bool;
// Slabs of a workgroup.
override DEPTH: u32;
// Cones whose light it holds at a time, an even number; the rows of the plane of which it holds that, and those before
// its first row.
override HELD_CONES: u32;
override HELD_ROWS: u32;
override ROWS_BEFORE: u32;

@group(0) @binding(7) var<storage, read> cones: array<vec4f>;
@group(0) @binding(8) var<storage, read> shown_odd: array<u32>;
@group(0) @binding(9) var<storage, read> shown_even: array<u32>;
@group(0) @binding(10) var<storage, read_write> light: array<vec4f>;
@group(0) @binding(11) var<storage, read_write> irradiance: array<vec2u>;
@group(0) @binding(12) var albedo: texture_2d<f32>;
@group(0) @binding(13) var panorama: texture_2d<f32>;

// The distance of a step that does not exist, px: farther than any light comes down.
const FAR_AWAY: f32 = 1e9;
const TAU: f32 = 6.2831855;

// By slab and cone, three masks of the rows of the tile: MET and after it.
var<workgroup> meets: array<vec2u, 3u * CONES * DEPTH>;
// The rows from which the ray along the middle meets matter or ends beside it, or several rays are needed.
const MET: u32 = 0u;
// Those from which the ray along the middle is stopped by a dark wall.
const STOPPED: u32 = 1u;
// Those from which it has to be traced; in both of these: in place of it, several.
const TRACED: u32 = 2u;
// The light on the plane ahead, by cone and row.
var<workgroup> held: array<vec4u, HELD_CONES * HELD_ROWS>;
// 1 if the workgroup has anything to gather.
var<workgroup> needed: array<u32, 1>;

struct Pixel {
    // The first row of the tile, and the pixel's own.
    first_row: u32,
    slab: u32,
    row: u32,
    lane: u32,
    // Slabs to the plane.
    ahead: u32,
    // The first cone's entry in the table, and the entries of each.
    view: u32,
    size: u32,
}

// The table of cones as seen from `ahead` slabs before the plane: its first entry, and the entries of each.
fn view_of(ahead: u32) -> vec2u {
    let first = footprints[sweep.footprints + ahead - sweep.gather_length].x;
    return vec2u(first, FIRST_RAY + 2u * (sweep.rays + 1u) + ahead + 1u);
}

// A plane that is gathered from: the first entry of its light, and whether it is one of the lattice's.
struct PlaneLight {
    plane: u32,
    base: u32,
    odd: bool,
    stored: bool,
}

fn plane_light(plane: u32) -> PlaneLight {
    // A plane of even index is a plane of the level above.
    let odd = (plane & 1u) == 1u;
    let slot = select(sweep.far - plane / 2u, sweep.far - (plane + 1u) / 2u, odd);
    let words = PAIR_WORDS * (shown_count(sweep.level + 1u) / 2u) * sweep.rows;
    let base = select(sweep.above, sweep.below, odd) + slot * words;
    return PlaneLight(plane, base, odd, plane < planes(sweep.level));
}

// The light of a pair of cones at a point of a plane. The first of all cones is not gathered from.
fn light_at(on: PlaneLight, pair: u32, point: i32) -> LightPair {
    if !on.stored || u32(point) >= sweep.rows {
        return pair_beyond(sweep.cones_above + 2u * pair + 1u, on.plane << sweep.level, point);
    }
    let at = on.base + PAIR_WORDS * pair * sweep.rows + u32(point);
    var words: vec3u;
    if on.odd {
        words = vec3u(shown_odd[at], shown_odd[at + sweep.rows], shown_odd[at + 2u * sweep.rows]);
    } else {
        words = vec3u(shown_even[at], shown_even[at + sweep.rows], shown_even[at + 2u * sweep.rows]);
    }
    return unpack_pair(words);
}

// The rows of the plane ahead: those that are open and those that points stand for.
struct PlaneRows {
    // Row of the grid of the first bit.
    first: i32,
    open: vec4u,
    in_points: vec4u,
}

fn plane_rows(pixel: Pixel) -> PlaneRows {
    let first = i32(pixel.first_row);
    let open = open_rows(own_slab + pixel.ahead, first);
    return PlaneRows(first - ASIDE, open, rows_in_points(open));
}

fn is_among(rows: vec4u, at: i32) -> bool {
    return has(select(rows.xy, rows.zw, at >= 64), u32(at) % 64u);
}

// Returns whether light of a row counts in the one after it: a point stands for each of them, and no border lies between.
fn is_joined(rows: PlaneRows, row: i32) -> bool {
    let end = i32(SPACING * sweep.rows);
    // Nothing comes back into the grid, and light within it is not mixed with that beyond.
    if row == -1 || row == end - 1 {
        return false;
    }
    let at = row - rows.first;
    return row < 0 || row >= end || (is_among(rows.in_points, at) && is_among(rows.in_points, at + 1));
}

// The share of its neighbour's light in the half of `width` rows that a row lies in: ¼ (Chaikin 1974) if the rows that
// touch are joined.
fn share_of_next(rows: PlaneRows, row: i32, width: i32) -> f32 {
    let first = row & ~(width - 1);
    let in_second = (row & (width >> 1u)) != 0;
    // Rows of the last point may lie beyond the grid.
    let is_beyond = first < i32(SPACING * sweep.rows) && first + (width >> 1u) >= i32(sweep.cell_rows);
    if in_second && is_beyond {
        return 1.0;
    }
    return select(0.0, 0.25, is_joined(rows, select(first - 1, first + width - 1, in_second)));
}

// The side of a row's point on which the nearest other lies.
fn nearest_side(row: i32) -> i32 {
    return select(-1, 1, (u32(row) & (SPACING >> 1u)) != 0u);
}

// The weights of points in the light of a row of the plane: its own, the nearest other, and that on the other side.
fn weights_of_points(rows: PlaneRows, row: i32) -> vec3f {
    if SPACING == 2u {
        let share = share_of_next(rows, row, 2);
        return vec3f(1.0 - share, share, 0.0);
    }
    let offset = row & 3;
    let side = nearest_side(row);
    let is_outer = offset == 0 || offset == 3;
    var share = share_of_next(rows, row, 2);
    let at = row - rows.first;
    if is_among(rows.open, at) && !is_among(rows.in_points, at) {
        // No point stands for it; it has the light of the point beside it, if that stands for the row there.
        if !is_among(rows.in_points, at + side) {
            return vec3f(0.0);
        }
        share = 1.0;
    }
    // Its half of the point, and the half beside it: across the border of the point, or in its middle.
    let own = share_of_next(rows, row, 4);
    let beside = share_of_next(rows, row + select(-side, side, is_outer), 4);
    let of_own = (1.0 - share) * (1.0 - own);
    let of_next = (1.0 - share) * own;
    return select(
        vec3f(of_own + share * (1.0 - beside), of_next, share * beside),
        vec3f(of_own + share * beside, of_next + share * (1.0 - beside), 0.0),
        is_outer,
    );
}

// Holds the light of some cones, from one on, on the plane ahead.
fn hold(pixel: Pixel, plane: u32, first_cone: u32, lane: u32) {
    let on = plane_light(plane);
    let rows = plane_rows(pixel);
    let count = min(HELD_CONES, CONES - first_cone) / 2u * HELD_ROWS;
    for (var i = lane; i < count; i += TILE * DEPTH) {
        let pair = first_cone / 2u + i / HELD_ROWS;
        let row = i32(pixel.first_row + i % HELD_ROWS) - i32(ROWS_BEFORE);
        // Rounded down, below 0 too.
        let point = row >> firstTrailingBit(SPACING);
        var light = light_at(on, pair, point);
        if SPACING > 1u {
            let weights = weights_of_points(rows, row);
            let side = nearest_side(row);
            light.first *= weights.x;
            light.second *= weights.x;
            if weights.y > 0.0 {
                let next = light_at(on, pair, point + side);
                light.first += weights.y * next.first;
                light.second += weights.y * next.second;
            }
            if weights.z > 0.0 {
                let other = light_at(on, pair, point - side);
                light.first += weights.z * other.first;
                light.second += weights.z * other.second;
            }
        }
        let at = (2u * pair - first_cone) * HELD_ROWS + i % HELD_ROWS;
        held[at] = bitcast<vec4u>(vec4f(light.first, 0.0));
        held[at + HELD_ROWS] = bitcast<vec4u>(vec4f(light.second, 0.0));
    }
}

// The light of a held cone on the plane ahead, in the rows before, at and after one, times their weights.
fn far(pixel: Pixel, cone: u32, row: i32, weights: vec3f) -> vec3f {
    let at = (cone % HELD_CONES) * HELD_ROWS + u32(row - i32(pixel.first_row) + i32(ROWS_BEFORE));
    var sum = vec3f(0.0);
    for (var i = 0u; i < 3u; i++) {
        sum += weights[i] * bitcast<vec4f>(held[at + i - 1u]).rgb;
    }
    return sum;
}

// A quadratic B-spline over the rows before, at and after the one nearest to a ray's end. A ray that has left the
// grid, perhaps over the end of a wall, takes no light from inside.
fn weights_at(end: i32, past: f32) -> vec3f {
    let sides = vec2f(0.5 - past, 0.5 + past);
    let low = select(0.5 * sides.x * sides.x, 0.0, end == i32(sweep.cell_rows));
    let high = select(0.5 * sides.y * sides.y, 0.0, end == -1);
    return vec3f(low, 0.75 - past * past, high);
}

// Those weights times the transmittance of the cells there.
fn weights_behind(pixel: Pixel, rows: i32, past: f32) -> vec3f {
    var weights = weights_at(i32(pixel.row) + rows, past);
    var in_media = 0u;
    for (var i = 0; i < 3; i++) {
        if is(MATTER, pixel.lane, i32(pixel.ahead), rows + i - 1) {
            let medium = is(MEDIUM, pixel.lane, i32(pixel.ahead), rows + i - 1);
            weights[i] = select(0.0, weights[i], medium);
            in_media |= u32(medium) << u32(i);
        }
    }
    // Cells are read only where there is a medium.
    while in_media != 0u {
        let i = firstTrailingBit(in_media);
        let row = i32(pixel.row) + rows + i32(i) - 1;
        let tint_opacity = textureLoad(matter, cell_of(pixel.slab + pixel.ahead, u32(row)), 0);
        // A component that is found while the shader runs would be written in memory.
        let passes = (1.0 - tint_opacity.a) * tint_opacity.r;
        weights = select(weights, passes * weights, vec3u(0u, 1u, 2u) == vec3u(i));
        in_media &= in_media - 1u;
    }
    return weights;
}

// The entry of a cone: its cosines to the axis and to higher rows; its angle; rays of two entries: crossings;
// the row nearest to the end, and how far past its middle that is; a mask with an entry per slab.
const FIRST_RAY: u32 = 2u;

// The light through a cone in which there is nothing.
fn through_nothing(pixel: Pixel, cone: u32) -> vec3f {
    let end_past = footprints[pixel.view + cone * pixel.size + FIRST_RAY + 1u];
    let end = i32(pixel.row) + bitcast<i32>(end_past.x);
    let weights = weights_at(end, bitcast<f32>(end_past.y));
    return far(pixel, cone, end, weights) / (WEIGHT_EPSILON + weights.x + weights.y + weights.z);
}

// The light through a cone in which there is matter, along its middle or by several rays; `traced`: they meet it.
fn through(pixel: Pixel, cone: u32, traced: bool, several: bool) -> vec3f {
    let entry = pixel.view + cone * pixel.size;
    let angle = bitcast<f32>(footprints[entry + 1u].x);
    let first = select(0u, 1u, several);
    let count = select(1u, sweep.rays, several);
    var sum = vec3f(0.0);
    for (var ray = first; ray < first + count; ray++) {
        let crossings = footprints[entry + FIRST_RAY + 2u * ray];
        let end_past = footprints[entry + FIRST_RAY + 2u * ray + 1u];
        let row = bitcast<i32>(end_past.x);
        var near = nothing();
        if traced {
            near = march(pixel.slab, pixel.row, pixel.lane, crossings);
        }
        let weights = weights_behind(pixel, row, bitcast<f32>(end_past.y));
        let all = WEIGHT_EPSILON + weights.x + weights.y + weights.z;
        sum += near.light * angle + near.transmittance * (far(pixel, cone, i32(pixel.row) + row, weights) / all);
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

// Where a pixel keeps the light of the quadrants so far: behind the irradiance of faces, in half of the bytes of light.
fn sum_index(i: u32) -> u32 {
    return 4u * frame.size.x * frame.size.y + i;
}

// Adds to a component of a pixel's first moment; the first quadrant overwrites it.
fn add_moment(component: u32, i: u32, integral: vec3f) {
    let at = moment_index(component, i);
    let before = select(light[at].rgb, vec3f(0.0), sweep.turn == 0u);
    light[at] = vec4f(before + integral * (1.0 / TAU), 1.0);
}

// The light that a pixel gathers.
struct Gathered {
    sum: vec3f,
    // ∫ L ω dω along the axis, and across it.
    along: vec3f,
    across: vec3f,
    // The irradiance of faces ahead, and towards higher and lower rows.
    on_front: vec3f,
    on_high: vec3f,
    on_low: vec3f,
}

// The steps of walls beside the faces that a pixel is in front of.
struct Steps {
    in_front: vec4f,
    above: vec4f,
    below: vec4f,
}

// Adds the light through a cone. `faces`: the pixel is in front of faces.
fn add(gathered: ptr<function, Gathered>, pixel: Pixel, cone: u32, found: vec3f, faces: bool, steps: Steps) {
    (*gathered).sum += found;
    if MOMENT || faces {
        let entry = pixel.view + cone * pixel.size;
        let cosines = bitcast<vec2f>(footprints[entry]);
        if MOMENT {
            (*gathered).along += cosines.x * found;
            (*gathered).across += cosines.y * found;
        }
        if faces {
            let angle = bitcast<f32>(footprints[entry + 1u].x);
            let along = cosines.x;
            let aside = abs(cosines.y);
            let to_side = aside * shade(found, angle, along / aside, steps.in_front);
            if cosines.y > 0.0 {
                (*gathered).on_high += to_side;
                (*gathered).on_front += along * shade(found, angle, aside / along, steps.above);
            } else {
                (*gathered).on_low += to_side;
                (*gathered).on_front += along * shade(found, angle, aside / along, steps.below);
            }
        }
    }
}

// Finds the masks of cones: a lane per slab and cone, for all rows of the tile.
fn find_met(ahead: u32, lane: u32) {
    for (var i = lane; i < CONES * DEPTH; i += TILE * DEPTH) {
        let slab = i / CONES;
        let view = view_of(ahead - slab);
        let entry = view.x + (i % CONES) * view.y;
        // Solid cells gather nothing.
        let rows = ~solid_rows(slab);
        let mask = entry + FIRST_RAY + 2u * (sweep.rays + 1u);
        let is_beside_axis = i % CONES == CONES / 2u || i % CONES + 1u == CONES / 2u;
        let split_at = select(LAST, MATTER, SPLITS_AT_MATTER && is_beside_axis);
        let several = rows & meeting(split_at, mask, slab, ahead - slab + 1u);
        // The ray along the middle, from the rows that need no other.
        let met = first_met(footprints[entry + FIRST_RAY], slab, rows & ~several);
        let stopped = several | met.xy;
        let traced = several | met.zw;
        let end = u32(bitcast<i32>(footprints[entry + FIRST_RAY + 1u].x) + ASIDE);
        let ends = near[MATTER * SLABS + ahead + 1u];
        let beside = shifted(ends, end - 1u) | shifted(ends, end) | shifted(ends, end + 1u);
        meets[3u * i + MET] = stopped | traced | (rows & beside);
        meets[3u * i + STOPPED] = stopped;
        meets[3u * i + TRACED] = traced;
    }
}

// Returns whether there is matter near the tile, from the slab behind it to the one `ahead` of its first.
fn is_any_near(ahead: u32) -> bool {
    var any_near = vec4u(0u);
    for (var away = 0u; away < ahead + 2u; away++) {
        any_near |= near[MATTER * SLABS + away];
    }
    return any(any_near != vec4u(0u));
}

@compute @workgroup_size(64, DEPTH)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(local_invocation_index) index_in_group: u32,
) {
    select_quadrant(group.z);
    // Slabs of a workgroup begin behind a plane, at the shortest distance to the next; the first may lie before the grid.
    let first_slab = DEPTH * (sweep.first + group.y) + 1u - sweep.gather_length;
    let apart = SPACING << sweep.level;
    let plane = (first_slab + sweep.gather_length + apart - 1u) / apart;
    let farthest = plane * apart - first_slab;
    let first_row = TILE * group.x;
    let lane = local.x;
    own_slab = local.y;
    let ahead = farthest - local.y;
    let view = view_of(ahead);
    let pixel = Pixel(first_row, first_slab + local.y, first_row + lane, lane, ahead, view.x, view.y);
    fetch(index_in_group, TILE * DEPTH, first_slab, i32(first_row), max(farthest, REACH + DEPTH - 1u));
    workgroupBarrier();
    if !PIXELS {
        if index_in_group == 0u {
            // Matter beside the slabs may have faces there.
            needed[0] = u32(is_any_near(DEPTH));
        }
        if workgroupUniformLoad(&needed[0]) == 0u {
            return;
        }
    }
    let empty = !is_any_near(farthest);
    if !empty {
        find_met(farthest, index_in_group);
    }
    let inside = pixel.row < sweep.cell_rows && pixel.slab < sweep.cell_depth;
    let solid = is_solid(lane, 0, 0);
    let faces = is_solid(lane, -1, 0) || is_solid(lane, 0, -1) || is_solid(lane, 0, 1);
    var scatters = inside && is(MEDIUM, lane, 0, 0);
    if scatters {
        scatters = any(textureLoad(albedo, cell_of(pixel.slab, pixel.row), 0).rgb != vec3f(0.0));
    }
    let gathers = inside && !solid && (PIXELS || faces || scatters);
    var gathered: Gathered;
    var steps: Steps;
    if gathers && faces {
        steps.in_front = step(pixel, 1, 0, REACH, 0u);
        steps.above = step(pixel, 0, 1, 1u, 1u);
        steps.below = step(pixel, 0, -1, 1u, 2u);
    }
    for (var first = 0u; first < CONES; first += HELD_CONES) {
        if first > 0u {
            // All have read the cones before.
            workgroupBarrier();
        }
        hold(pixel, plane, first, index_in_group);
        workgroupBarrier();
        if gathers {
            let end = min(first + HELD_CONES, CONES);
            if empty {
                for (var cone = first; cone < end; cone++) {
                    add(&gathered, pixel, cone, through_nothing(pixel, cone), false, steps);
                }
            } else {
                var left = 0u;
                for (var cone = first; cone < end; cone++) {
                    let at = 3u * (local.y * CONES + cone);
                    if !has(meets[at + MET], lane) {
                        add(&gathered, pixel, cone, through_nothing(pixel, cone), faces, steps);
                    } else if has(meets[at + TRACED], lane) || !has(meets[at + STOPPED], lane) {
                        left |= 1u << (cone - first);
                    } else if faces {
                        // Steps may shine on them through it.
                        add(&gathered, pixel, cone, vec3f(0.0), faces, steps);
                    }
                }
                while left != 0u {
                    let cone = first + firstTrailingBit(left);
                    let at = 3u * (local.y * CONES + cone);
                    let traced = has(meets[at + TRACED], lane);
                    let several = traced && has(meets[at + STOPPED], lane);
                    add(&gathered, pixel, cone, through(pixel, cone, traced, several), faces, steps);
                    left &= left - 1u;
                }
            }
        }
    }
    if !inside {
        return;
    }
    let i = index(cell_of(pixel.slab, pixel.row));
    if solid && PIXELS && sweep.turn == 0u {
        light[i] = vec4f(0.0, 0.0, 0.0, 1.0);
        if MOMENT {
            light[moment_index(0u, i)] = vec4f(0.0);
            light[moment_index(1u, i)] = vec4f(0.0);
        }
    }
    if !gathers {
        return;
    }
    if PIXELS {
        let at = sum_index(i);
        let before = select(unpack_rgb(irradiance[at]), vec3f(0.0), sweep.turn == 0u);
        let sum = before + gathered.sum * (1.0 / TAU);
        if sweep.turn == LAST_TURN {
            light[i] = vec4f(sum, 1.0);
        } else {
            irradiance[at] = pack_rgb(sum);
        }
        if MOMENT {
            // Ahead is the other way where light comes from lower slabs; rows are the same.
            let along = select(1.0, -1.0, sweep.reversed == 1u) * gathered.along;
            add_moment(0u, i, select(gathered.across, along, sweep.axis == 0u));
            add_moment(1u, i, select(along, gathered.across, sweep.axis == 0u));
        }
    }
    if faces {
        // Faces are left, right, top, bottom; each looks towards the light.
        let back = sweep.reversed == 1u;
        let front_face = 2u * sweep.axis + select(1u, 0u, back);
        let side_face = 2u * (1u - sweep.axis);
        receive(pixel, -1, 0, front_face, gathered.on_front);
        receive(pixel, 0, -1, side_face + 1u, gathered.on_high);
        receive(pixel, 0, 1, side_face, gathered.on_low);
    }
    if scatters {
        irradiance[4u * i] = pack_rgb(unpack_rgb(irradiance[4u * i]) + gathered.sum * (1.0 / TAU));
    }
}
