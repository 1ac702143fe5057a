// Extends intervals to longer ones (Freeman, Sannikov and Margel 2025), up to three levels at once:
// `T_{n+1}(p, 2k) = T_n(p, k) ⊕ T_n(p + v_n(k), k)`, and a ray between two others is the mean of the two
// bent paths. From level BENT on, even rays are bent a little too (`extend.rs` of the library). A workgroup
// makes, from the planes of the lowest level that one plane of the topmost spans, all rays between two rays
// k and k + 1 of the lowest. Levels between are held in workgroup memory, each with a ray more to both sides
// and rows beside the tile, for bent paths; of them only the planes of odd index are needed later and
// written.

#import methods/holographic/interval
#import methods/holographic/sweep

// The lowest level whose intervals are extended to even rays over bent paths too.
override BENT: u32;
// Rows of a tile.
override TILE: u32;
// Rows to each side of a tile.
override BESIDE: u32;
// Words of two levels in workgroup memory, at most.
override HELD: u32;

@group(0) @binding(2) var<storage, read_write> intervals: array<u32>;

// By level, word, plane, ray and row.
var<workgroup> held: array<u32, HELD>;

// Rows of a plane of the level `up` above the lowest. Later planes are wider, because rays spread.
fn width(up: u32, plane: u32) -> u32 {
    return TILE + 2u * BESIDE + (plane << up);
}

// Rays of a level in workgroup memory, with one to each side.
fn rays_held(up: u32) -> u32 {
    return (1u << up) + 3u;
}

// The first interval of a plane of a level in workgroup memory, behind the planes before it.
fn begin(up: u32, plane: u32) -> u32 {
    return rays_held(up) * (plane * (TILE + 2u * BESIDE) + ((plane * (plane - 1u) / 2u) << up));
}

// Intervals of a level in workgroup memory.
fn size(up: u32) -> u32 {
    return begin(up, 1u << (sweep.levels - up));
}

// The first place of a word of a level in workgroup memory.
fn word(up: u32, number: u32) -> u32 {
    let below = select(0u, WORDS * size(1u), up == 2u);
    return below + number * size(up);
}

struct Group {
    // The plane of the topmost level, the ray of the lowest, the first row.
    plane: u32,
    ray: i32,
    row: i32,
    // Rows from one plane of the lowest level to the next along the ray.
    shift: i32,
}

// The row of the grid at a place in a plane.
fn row_of(g: Group, up: u32, plane: u32, place: i32) -> i32 {
    return g.row + i32(plane << up) * g.shift + place;
}

fn stored(g: Group, plane: u32, ray: i32, row: i32) -> vec3u {
    let n = sweep.level;
    let p = (g.plane << sweep.levels) + plane;
    if row < 0 || row >= i32(sweep.rows) || p >= planes(n) || p == 0u {
        return pack(nothing());
    }
    let odd = (p & 1u) == 1u;
    let slot = select(p / 2u - sweep.even_first, p / 2u - sweep.odd_first.x, odd);
    let base = select(sweep.even, sweep.odd.x, odd);
    let rays = (2u << n) + 1u;
    let at = base + (slot * rays + u32(g.ray + ray)) * WORDS * sweep.rows + u32(row);
    var words = vec3u(intervals[at], intervals[at + sweep.rows], 0u);
    if WORDS == 3u {
        words.z = intervals[at + 2u * sweep.rows];
    }
    return words;
}

// An interval of the level `up`, at a place of one of its planes. Rays and places count from the first of the
// group and the tile; some lie before it.
fn load(g: Group, up: u32, plane: u32, ray: i32, place: i32) -> Interval {
    if up == 0u {
        return unpack(stored(g, plane, ray, row_of(g, 0u, plane, place)));
    }
    let at = begin(up, plane) + u32(ray + 1) * width(up, plane) + u32(place + i32(BESIDE));
    var words = vec3u(held[word(up, 0u) + at], held[word(up, 1u) + at], 0u);
    if WORDS == 3u {
        words.z = held[word(up, 2u) + at];
    }
    return unpack(words);
}

// The interval along one ray of a plane and another of the next.
fn path(g: Group, up: u32, plane: u32, first: i32, second: i32, place: i32) -> Interval {
    let near = load(g, up, plane, first, place);
    return then(near, load(g, up, plane + 1u, second, place + first));
}

// The mean of two bent paths.
fn bent(g: Group, up: u32, plane: u32, k: i32, other: i32, place: i32) -> Interval {
    return mean(path(g, up, plane, k, other, place), path(g, up, plane, other, k, place));
}

// Makes the planes of the group at the level above `up`, ray by ray.
fn make(g: Group, up: u32, local: u32) {
    let above = up + 1u;
    let n = sweep.level + above;
    let all = (2i << n) + 1i;
    let top = above == sweep.levels;
    let last = g.ray + 2i == (2i << sweep.level) + 1i;
    // The topmost level is not held, and needs nothing beside the group and the tile.
    let beside = select(i32(BESIDE), 0i, top);
    let beyond = select(1i, 0i, top);
    for (var plane = 0u; plane < 1u << (sweep.levels - above); plane++) {
        let p = (g.plane << (sweep.levels - above)) + plane;
        let wide = width(above, plane) - select(0u, 2u * BESIDE, top);
        let rays = rays_held(above) - select(0u, 2u, top);
        for (var i = local; i < rays * wide; i += 256u) {
            let ray = i32(i / wide) - beyond;
            let place = i32(i % wide) - beside;
            let row = row_of(g, above, plane, place);
            let number = (g.ray << above) + ray;
            let inside = row >= 0 && row < i32(sweep.rows) && number >= 0 && number < all;
            var made = nothing();
            if inside {
                let k = (ray + 2i) / 2i - 1i;
                if (ray & 1i) == 1i {
                    made = bent(g, up, 2u * plane, k, k + 1i, place);
                } else {
                    made = path(g, up, 2u * plane, k, k, place);
                    // Along a border of the grid, bent paths would leave it and come back.
                    let at_border = 2i * number + 1i == all && (row == 0 || row + 1 == i32(sweep.rows));
                    if sweep.level + up >= BENT && number > 0 && number + 1 < all && !at_border {
                        made = mean(made, mean(made, bent(g, up, 2u * plane, k - 1i, k + 1i, place)));
                    }
                }
            }
            let words = pack(made);
            if !top {
                let at = begin(above, plane) + i;
                held[word(above, 0u) + at] = words.x;
                held[word(above, 1u) + at] = words.y;
                if WORDS == 3u {
                    held[word(above, 2u) + at] = words.z;
                }
            }
            // The last ray is the next group's first, and rows beyond the tile are the next tile's.
            let odd = (p & 1u) == 1u;
            let end = select(0i, 1i, last) + (1i << above);
            let own = place >= 0 && place < i32(TILE) && ray >= 0 && ray < end;
            if inside && own && p > 0u && p < planes(n) && (odd || top) {
                let odd_at = select(sweep.odd[above & 3u], sweep.odd_top, top);
                let odd_first = select(sweep.odd_first[above & 3u], sweep.odd_top_first, top);
                let slot = p / 2u - select(sweep.even_top_first, odd_first, odd);
                let base = select(sweep.even_top, odd_at, odd);
                let at = base + (slot * u32(all) + u32(number)) * WORDS * sweep.rows + u32(row);
                intervals[at] = words.x;
                intervals[at + sweep.rows] = words.y;
                if WORDS == 3u {
                    intervals[at + 2u * sweep.rows] = words.z;
                }
            }
        }
    }
}

@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) id: vec3u, @builtin(local_invocation_index) local: u32) {
    let shift = i32(id.y) - (1i << sweep.level);
    // Planes are slanted; `slant` is the offset in rows of the last one that is written.
    let slant = ((1i << sweep.levels) - 2i) * max(shift, 0i);
    let row = i32(id.x * TILE) - (slant + i32(TILE) - 1i) / i32(TILE) * i32(TILE);
    let g = Group(sweep.first + id.z, i32(id.y), row, shift);
    for (var up = 0u; up < sweep.levels; up++) {
        make(g, up, local);
        workgroupBarrier();
    }
}
