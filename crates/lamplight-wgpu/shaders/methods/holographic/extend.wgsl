// Extends intervals to longer ones (Freeman, Sannikov and Margel 2025), up to three levels at once:
// `T_{n+1}(p, 2k) = T_n(p, k) ⊕ T_n(p + v_n(k), k)`, and a ray between two others is the mean of the two
// bent paths. From level BENT on, even rays are bent a little too (`extend.rs` of the library). A workgroup
// makes, from the planes of the lowest level that one plane of the topmost spans, all rays between two rays
// k and k + 1 of the lowest. Levels between are held in workgroup memory, with a ray more to both sides where
// paths bend; of them only the planes of odd index are needed later and written.
//
// A lane is a row of a tile, or beside it: rays that spread and bend lead there. Waves share the rays between
// k and k + 1 or, if there is one level, each has its own k; so all lanes of one take the same branches.

#import methods/holographic/fetch_interval
#import methods/holographic/store_interval
#import methods/holographic/quadrant

// The lowest level whose intervals are extended to even rays over bent paths too.
override BENT: u32;
// Rows of a tile, and lanes before it.
override TILE: u32;
override BEFORE: u32;
// Lanes: rows of a tile and beside it.
override LANES: u32;
const WAVES_LOG2: u32 = 2u;
// True if levels are fused, false if there is one.
override FUSED: bool;
// Rays of a plane in workgroup memory, from ray −1 on: of the first level above the lowest, and of the second.
override RAYS_1: u32;
override RAYS_2: u32;
// Planes of the first level in workgroup memory.
override PLANES_1: u32;
// Pairs of words in workgroup memory, and the first of those that hold a third word.
override HELD: u32;
override FIRST_TINT: u32;

@group(0) @binding(2) var<storage, read_write> intervals: array<vec2u>;
@group(0) @binding(3) var<storage, read_write> tints: array<u32>;

// By level, plane, ray and lane; after all, their third words in the same order.
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
fn held_at(up: u32, plane: u32, ray: i32, place: i32) -> u32 {
    let line = select(plane * RAYS_1, PLANES_1 * RAYS_1 + plane * RAYS_2, up == 2u) + u32(ray + 1);
    return line * LANES + u32(place + i32(BEFORE));
}

fn stored(g: Group, plane: u32, ray: i32, row: i32) -> vec3u {
    let n = sweep.level;
    let p = (g.plane << sweep.levels) + plane;
    let rays = (2u << n) + 1u;
    let number = u32(g.ray + ray);
    if u32(row) >= sweep.rows || number >= rays || p >= planes(n) || p == 0u {
        return pack(nothing());
    }
    let odd = (p & 1u) == 1u;
    let slot = select(p / 2u - sweep.even_first, p / 2u - sweep.odd_first.x, odd);
    let base = select(sweep.even, sweep.odd.x, odd);
    return fetch_words(base + (slot * rays + number) * sweep.rows + u32(row));
}

// An interval of the level `up`, at a place of one of its planes. Rays and places count from the first of the
// group and the tile; some lie before it.
fn load(g: Group, up: u32, plane: u32, ray: i32, place: i32) -> Interval {
    if up == 0u {
        return unpack(stored(g, plane, ray, row_of(g, 0u, plane, place)));
    }
    let at = held_at(up, plane, ray, place);
    var words = vec3u(held[at], 0u);
    if WORDS == 3u {
        words.z = held[FIRST_TINT + at].x;
    }
    return unpack(words);
}

// The rays of a level that the group makes, from one to before another.
fn rays_made(g: Group, above: u32) -> vec2i {
    let top = above == sweep.levels;
    // The last ray is the next group's first.
    let last = g.ray + 2i == (2i << sweep.level) + 1i;
    // A path of an even ray bends to the rays on both sides.
    let bends = sweep.level + sweep.levels > BENT;
    let bends_next = above + 1u < sweep.levels && sweep.level + above >= BENT;
    let all = (1i << above) + 1i;
    return vec2i(select(0i, -1i, bends && !top), all + select(i32(bends_next), i32(last) - 1i, top));
}

// Stores an interval of a level where it is needed.
fn put(g: Group, above: u32, plane: u32, ray: i32, made: Interval) {
    let n = sweep.level + above;
    let top = above == sweep.levels;
    let row = row_of(g, above, plane, g.place);
    let all = (2u << n) + 1u;
    let number = u32((g.ray << above) + ray);
    let inside = u32(row) < sweep.rows && number < all;
    var words = pack(nothing());
    if inside {
        words = pack(made);
    }
    if !top {
        let at = held_at(above, plane, ray, g.place);
        held[at] = words.xy;
        if WORDS == 3u {
            held[FIRST_TINT + at] = vec2u(words.z, 0u);
        }
    }
    // Rows beside the tile and rays beside the group are those of others.
    let end = (1i << above) + i32(number + 1u == all);
    let own = u32(g.place) < TILE && ray >= 0 && ray < end;
    let p = (g.plane << (sweep.levels - above)) + plane;
    let odd = (p & 1u) == 1u;
    if inside && own && p > 0u && p < planes(n) && (odd || top) {
        let odd_at = select(sweep.odd[above & 3u], sweep.odd_top, top);
        let odd_first = select(sweep.odd_first[above & 3u], sweep.odd_top_first, top);
        let slot = p / 2u - select(sweep.even_top_first, odd_first, odd);
        let base = select(sweep.even_top, odd_at, odd);
        store_words(base + (slot * all + number) * sweep.rows + u32(row), words);
    }
}

// Makes the planes of the group at the level above `up`: planes and runs of rays are shared out to waves.
fn make(g: Group, up: u32, wave: u32) {
    let above = up + 1u;
    let n = sweep.level + above;
    let planes_log2 = sweep.levels - above;
    let plane = select(0u, wave & ((1u << planes_log2) - 1u), FUSED);
    let part = select(0i, i32(wave >> planes_log2), FUSED);
    let parts_log2 = select(0u, WAVES_LOG2 - planes_log2, FUSED);
    let rays = rays_made(g, above);
    // Pairs of the rays 2k and 2k + 1.
    let begin = rays.x >> 1u;
    let to = (rays.y + 1i) >> 1u;
    let run = (to - begin + (1i << parts_log2) - 1i) >> parts_log2;
    let first = begin + part * run;
    let near = 2u * plane;
    let place = g.place;
    let row = row_of(g, above, plane, place);
    let at_border = row == 0 || row + 1 == i32(sweep.rows);
    var before = load(g, up, near, first - 1i, place);
    var own = load(g, up, near, first, place);
    for (var k = first; k < min(first + run, to); k++) {
        let after = load(g, up, near, k + 1i, place);
        let straight = load(g, up, near + 1u, k, place + k);
        var even = then(own, straight);
        let number = u32((g.ray << above) + 2i * k);
        let all = (2u << n) + 1u;
        // Along a border of the grid, bent paths would leave it and come back.
        let bends = number > 0u && number + 1u < all && !(at_border && 2u * number + 1u == all);
        if sweep.level + up >= BENT && bends {
            let low = then(before, load(g, up, near + 1u, k + 1i, place + k - 1i));
            let high = then(after, load(g, up, near + 1u, k - 1i, place + k + 1i));
            even = mean(even, mean(even, mean(low, high)));
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
    let plane = sweep.first + z;
    let place = i32(local.x) - i32(BEFORE);
    if !FUSED {
        let ray = i32((id.y << WAVES_LOG2) + local.y);
        if z < sweep.planes && ray < (2i << sweep.level) {
            make(Group(plane, ray, i32(id.x * TILE), ray - (1i << sweep.level), place), 0u, local.y);
        }
        return;
    }
    let shift = i32(id.y) - (1i << sweep.level);
    // Planes are slanted; `slant` is the offset in rows of the last one that is written.
    let slant = ((1i << sweep.levels) - 2i) * max(shift, 0i);
    let row = i32(id.x * TILE) - slant;
    let g = Group(plane, i32(id.y), row, shift, place);
    // Rays less steep than the steepest need fewer tiles.
    var reaches = false;
    for (var plane = 0; plane < 1i << sweep.levels; plane += 2) {
        let first = row + plane * shift;
        reaches = reaches || (first < i32(sweep.rows) && first + i32(TILE) > 0);
    }
    // Browsers reject a barrier after a return that depends on the quadrant.
    let levels = select(0u, sweep.levels, reaches && z < sweep.planes && id.y < (2u << sweep.level));
    // Levels are constants, so that each only has the code that it needs.
    if levels > 0u {
        make(g, 0u, local.y);
    }
    workgroupBarrier();
    if levels > 1u {
        make(g, 1u, local.y);
    }
    workgroupBarrier();
    if levels > 2u {
        make(g, 2u, local.y);
    }
}
