// Extends intervals to longer ones (Freeman, Sannikov and Margel 2025), one or two levels at once:
// `T_{n+1}(p, 2k) = T_n(p, k) ⊕ T_n(p + v_n(k), k)`, and a ray between two others is the mean of the two
// bent paths. From level BENT on, even rays are bent a little too (bend.wgsl). A workgroup makes, from the planes
// of the lowest level that one plane of the topmost spans, all rays between the rays k and k + WIDTH of the lowest.
// The level between is held in workgroup memory, with a ray more to both sides where paths bend, and is never
// stored: merge.wgsl makes it again.
//
// A lane is a row of a tile, or beside it: rays that spread and bend lead there. Waves share the rays of the
// group or, if there is one level, each has a group of its own; so all lanes of one take the same branches.

#import methods/holographic/bend
#import methods/holographic/fetch_interval
#import methods/holographic/store_interval

// Levels that are made: 1 or 2.
override LEVELS: u32;
// Rows of a tile, and lanes before it.
override TILE: u32;
override BEFORE: u32;
// Lanes: rows of a tile and beside it.
override LANES: u32;
const WAVES_LOG2: u32 = 2u;
// Rays of the lowest level from one group to the next.
override WIDTH: u32;
// Pairs of words in workgroup memory, and the first of those that hold a third word.
override HELD: u32;
override FIRST_TINT: u32;

@group(0) @binding(2) var<storage, read> intervals: array<vec2u>;
@group(0) @binding(3) var<storage, read> tints: array<u32>;
@group(0) @binding(4) var<storage, read_write> made: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> made_tints: array<u32>;

// By plane, ray from −1 on, and lane; after all, their third words in the same order.
var<workgroup> held: array<vec2u, HELD>;

struct Group {
    // The plane of the topmost level, the ray of the lowest, the first row of the tile.
    plane: u32,
    ray: i32,
    row: i32,
    // Rows from one plane of the lowest level to the next along the ray.
    shift: i32,
    // The row of the lane, counted from the first of the tile.
    place: i32,
}

// The row of the grid at a place in a plane.
fn row_of(g: Group, up: u32, plane: u32, place: i32) -> i32 {
    return g.row + i32(plane << up) * g.shift + place;
}

// The index in workgroup memory of a place on a ray of a plane.
fn held_at(plane: u32, ray: i32, place: i32) -> u32 {
    let line = plane * (2u * WIDTH + 2u) + u32(ray + 1);
    return line * LANES + u32(place + i32(BEFORE));
}

// An interval of the level `up`, at a place of one of its planes. Rays and places count from the first of the
// group and the tile; some lie before it.
fn load(g: Group, up: u32, plane: u32, ray: i32, place: i32) -> Interval {
    if up == 0u {
        return unpack(stored((g.plane << LEVELS) + plane, g.ray + ray, row_of(g, 0u, plane, place)));
    }
    let at = held_at(plane, ray, place);
    var words = vec3u(held[at], 0u);
    if WORDS == 3u {
        words.z = held[FIRST_TINT + at].x;
    }
    return unpack(words);
}

// The rays of a level that the group makes, from one to before another.
fn rays_made(g: Group, above: u32) -> vec2i {
    let all = i32(WIDTH) << above;
    if above < LEVELS {
        // A path of an even ray bends to the rays on both sides.
        return vec2i(select(0i, -1i, sweep.level + above >= BENT), all + 1i);
    }
    // The last ray is the next group's first.
    return vec2i(0i, all + i32(g.ray + i32(WIDTH) == (2i << sweep.level)));
}

// Holds an interval of the level between, or stores one of the topmost.
fn put(g: Group, above: u32, plane: u32, ray: i32, found: Interval) {
    let n = sweep.level + above;
    let row = row_of(g, above, plane, g.place);
    let all = (2u << n) + 1u;
    let number = u32((g.ray << above) + ray);
    let inside = u32(row) < sweep.rows && number < all;
    var words = pack(nothing());
    if inside {
        words = pack(found);
    }
    if above < LEVELS {
        let at = held_at(plane, ray, g.place);
        held[at] = words.xy;
        if WORDS == 3u {
            held[FIRST_TINT + at] = vec2u(words.z, 0u);
        }
    } else if inside && u32(g.place) < TILE {
        // Rows beside the tile are those of others.
        let base = select(sweep.even_top, sweep.odd_top, (g.plane & 1u) == 1u);
        let slot = g.plane / 2u - sweep.stored_top;
        store_words(base + (slot * all + number) * sweep.rows + u32(row), words);
    }
}

// Makes the planes of the group at the level above `up`: planes and runs of rays are shared out to waves.
fn make(g: Group, up: u32, wave: u32) {
    let above = up + 1u;
    let planes_log2 = LEVELS - above;
    let plane = select(0u, wave & ((1u << planes_log2) - 1u), LEVELS == 2u);
    let part = select(0i, i32(wave >> planes_log2), LEVELS == 2u);
    let parts_log2 = select(0u, WAVES_LOG2 - planes_log2, LEVELS == 2u);
    let rays = rays_made(g, above);
    // Pairs of the rays 2k and 2k + 1.
    let begin = rays.x >> 1u;
    let to = (rays.y + 1i) >> 1u;
    let run = (to - begin + (1i << parts_log2) - 1i) >> parts_log2;
    let first = begin + part * run;
    let near = 2u * plane;
    let place = g.place;
    let row = row_of(g, above, plane, place);
    var before = load(g, up, near, first - 1i, place);
    var own = load(g, up, near, first, place);
    for (var k = first; k < min(first + run, to); k++) {
        let after = load(g, up, near, k + 1i, place);
        var even = then(own, load(g, up, near + 1u, k, place + k));
        if bends(sweep.level + up, u32((g.ray << above) + 2i * k), row) {
            let low = then(before, load(g, up, near + 1u, k + 1i, place + k - 1i));
            let high = then(after, load(g, up, near + 1u, k - 1i, place + k + 1i));
            even = bent(even, low, high);
        }
        if 2i * k >= rays.x {
            put(g, above, plane, 2i * k, even);
        }
        if 2i * k + 1i < rays.y {
            let low = then(own, load(g, up, near + 1u, k + 1i, place + k));
            let high = then(after, load(g, up, near + 1u, k, place + k + 1i));
            put(g, above, plane, 2i * k + 1i, mean(low, high));
        }
        before = own;
        own = after;
    }
}

@compute @workgroup_size(LANES, 4)
fn main(@builtin(workgroup_id) id: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let z = select_quadrant(id.z);
    // If there is one level, each wave is a group.
    let ray = i32(WIDTH * select((id.y << WAVES_LOG2) + local.y, id.y, LEVELS == 2u));
    let place = i32(local.x) - i32(BEFORE);
    let g = Group(sweep.first + z, ray, i32(id.x * TILE), ray - (1i << sweep.level), place);
    // Browsers reject a barrier after a return that depends on the quadrant.
    let makes = z < sweep.planes && ray < (2i << sweep.level);
    if makes {
        make(g, 0u, local.y);
    }
    if LEVELS == 2u {
        workgroupBarrier();
        if makes {
            make(g, 1u, local.y);
        }
    }
}
