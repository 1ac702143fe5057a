// Merges the light of cones down from the far end of the grid (Freeman, Sannikov and Margel 2025), up to
// four levels at once. With s ∈ {0, 1}, j = 2i + s, k = i + s:
//
// planes of odd index: `R_n(p, i) = Σ_s A_{n+1}(j)·r(T_n(p, k)) + t(T_n(p, k))·R_{n+1}(p + v_n(k), j)`;
// planes of even index are planes of the level above: `R_n(p, i) = Σ_s R_{n+1}(p, j)`.
//
// A workgroup makes one cone of the lowest level, on all planes between one plane of the topmost and the
// one before it. Levels between are held in workgroup memory.

#import methods/holographic/interval
#import methods/holographic/packed_rgb
#import methods/holographic/sweep

// Rows of a tile.
override TILE: u32;
// Light of two levels in workgroup memory, at most: planes × cones × rows.
override HELD: u32;

// For each cone of each level: its angle, and the weights of the sky above, below and ahead: ∫ dθ,
// ∫ |sin θ| dθ of both signs, ∫ cos θ dθ.
@group(0) @binding(2) var<storage, read> cones: array<vec4f>;
@group(0) @binding(3) var<storage, read> intervals: array<u32>;
@group(0) @binding(4) var<storage, read_write> radiance: array<vec2u>;

// The third level, whose place the first then takes, and the second.
var<workgroup> held: array<vec2u, HELD>;

struct Group {
    // The plane of the topmost level, the cone of the lowest, the first row.
    plane: u32,
    cone: u32,
    row: i32,
    // Rows from one plane of the lowest level to the next, along the cone's lower edge.
    shift: i32,
}

fn width(up: u32) -> u32 {
    return TILE + (1u << up) - 1u;
}

fn place_of(up: u32, plane: u32, cone: u32, place: u32) -> u32 {
    let before = select(0u, width(3u) << sweep.levels, up == 2u);
    return before + ((plane << up) + cone) * width(up) + place;
}

// The table's entry for a cone of the level `up`.
fn entry(up: u32, cone: u32) -> vec4f {
    return cones[select(sweep.cones[up & 3u], sweep.cones_top, up == sweep.levels) + cone];
}

// An interval from a row of the plane p, whose index is odd.
fn interval(up: u32, p: u32, ray: u32, row: u32) -> Interval {
    let rays = (2u << (sweep.level + up)) + 1u;
    let slot = p / 2u - sweep.odd_first[up];
    let at = sweep.odd[up] + (slot * rays + ray) * WORDS * sweep.rows + row;
    var words = vec3u(intervals[at], intervals[at + sweep.rows], 0u);
    if WORDS == 3u {
        words.z = intervals[at + 2u * sweep.rows];
    }
    return unpack(words);
}

// The light of a cone of the level `up` at a place of a plane, counted back from the group's.
fn load(g: Group, up: u32, plane: u32, cone: u32, place: u32) -> vec3f {
    if up < sweep.levels {
        return unpack_rgb(held[place_of(up, plane, cone, place)]);
    }
    let number = (g.cone << up) + cone;
    let row = g.row + i32(place);
    if row < 0 || row >= i32(sweep.rows) || g.plane >= planes(sweep.level + up) {
        return sky_in(entry(up, number));
    }
    let slot = (sweep.far - g.plane) * (2u << (sweep.level + up)) + number;
    return unpack_rgb(radiance[sweep.above + slot * sweep.rows + u32(row)]);
}

fn make(g: Group, up: u32, plane: u32, cone: u32, place: u32) -> vec3f {
    let p = (g.plane << (sweep.levels - up)) - plane;
    let number = (g.cone << up) + cone;
    let row = g.row - i32(plane << up) * g.shift + i32(place);
    if row < 0 || row >= i32(sweep.rows) || p >= planes(sweep.level + up) {
        return sky_in(entry(up, number));
    }
    var light = vec3f(0.0);
    for (var s = 0u; s < 2u; s++) {
        if (plane & 1u) == 0u {
            light += load(g, up + 1u, plane / 2u, 2u * cone + s, place);
        } else {
            let near = interval(up, p, number + s, u32(row));
            let far = load(g, up + 1u, plane / 2u, 2u * cone + s, place + cone + s);
            light += near.light * entry(up + 1u, 2u * number + s).x + near.transmittance * far;
        }
    }
    return light;
}

@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) id: vec3u, @builtin(local_invocation_index) local: u32) {
    let shift = i32(id.y) - (1i << sweep.level);
    // Planes are slanted; `slant` is the offset in rows of the last one.
    let slant = ((1i << sweep.levels) - 1i) * max(-shift, 0i);
    let row = i32(id.x * TILE) - (slant + i32(TILE) - 1i) / i32(TILE) * i32(TILE);
    let g = Group(sweep.first + id.z, id.y, row, shift);
    for (var up = sweep.levels - 1u; up > 0u; up--) {
        let wide = width(up);
        for (var i = local; i < wide << sweep.levels; i += 256u) {
            let number = i / wide;
            let cone = number & ((1u << up) - 1u);
            held[i + place_of(up, 0u, 0u, 0u)] =
                pack_rgb(make(g, up, number >> up, cone, i % wide));
        }
        workgroupBarrier();
    }
    for (var i = local; i < TILE << sweep.levels; i += 256u) {
        let plane = i / TILE;
        let p = (g.plane << sweep.levels) - plane;
        let row = g.row - i32(plane) * g.shift + i32(i % TILE);
        let slot = sweep.below_far - p;
        if row < 0 || row >= i32(sweep.rows) || slot >= sweep.below_planes || p >= planes(sweep.level) {
            continue;
        }
        let light = make(g, 0u, plane, 0u, i % TILE);
        let at = (slot * (2u << sweep.level) + g.cone) * sweep.rows + u32(row);
        radiance[sweep.below + at] = pack_rgb(light);
    }
}

// The level that pixels gather from, on planes of odd index: its cones are half as wide, those of the level
// above. The middle of each lies at a quarter between the rays on both sides of it.
@compute @workgroup_size(64)
fn finish(@builtin(global_invocation_id) id: vec3u) {
    let p = 2u * (sweep.first + id.z) - 1u;
    if id.x >= sweep.rows || p >= planes(sweep.level) {
        return;
    }
    let count = 4u << sweep.level;
    let above = (p + 1u) / 2u;
    var light = vec3f(0.0);
    for (var s = 0u; s < 2u; s++) {
        let ray = id.y / 2u + s;
        let weight = select(0.25, 0.75, s == (id.y & 1u));
        let near = interval(0u, p, ray, id.x);
        let row = i32(id.x) + i32(ray) - (1i << sweep.level);
        let cone = entry(1u, id.y);
        var far = sky_in(cone);
        if row >= 0 && row < i32(sweep.rows) && above < planes(sweep.level + 1u) {
            let slot = (sweep.far - above) * count + id.y;
            far = unpack_rgb(radiance[sweep.above + slot * sweep.rows + u32(row)]);
        }
        light += near.light * (cone.x * weight) + near.transmittance * weight * far;
    }
    let slot = (sweep.below_far - p) / 2u;
    radiance[sweep.below + (slot * count + id.y) * sweep.rows + id.x] = pack_rgb(light);
}
