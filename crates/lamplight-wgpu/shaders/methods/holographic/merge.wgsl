// Merges the light of cones down from the far end of the grid, level by level (Freeman, Sannikov and Margel
// 2025). Cones overlap: the light of each is weighted by a quadratic B-spline over slope, and taken apart into
// halves, one for each of the rays beside it,
// `H_n(p, j) = ¼·R_n(p, j − 1) + ½·R_n(p, j) + ¼·R_n(p, j + 1)`. With s ∈ {0, 1}, j = 2i + s, k = i + s:
//
// planes of odd index: `R_n(p, i) = Σ_s A_{n+1}(j)·r(T_n(p, k)) + t(T_n(p, k))·H_{n+1}(p + v_n(k), j)`;
// planes of even index are planes of the level above: `R_n(p, i) = Σ_s H_{n+1}(p, j)`.
//
// crates/lamplight/src/methods/holographic/merge.rs says why.
//
// A workgroup makes two levels, n + 1 and n, from n + 2. Of the level between it makes a plane q, whose intervals it
// makes of those of level n, and from there the planes 2q − 1 and 2q of level n. The level between stays in workgroup
// memory as lines: a cone from all rows of the tile. Lines are slanted as the rays to the plane 2q − 1 are, a run of
// them by the same number of rows, so that few lanes read beside the tile. A lane is a row of a tile, or beside it;
// waves share the cones.

#import methods/holographic/bend
#import methods/holographic/border
#import methods/holographic/fetch_interval
#import methods/holographic/light_pair
#import methods/holographic/packed_rgb

// Cones that a thread makes if it makes one level, one after another.
override RUN: u32;
// Cones of the lower level that a workgroup makes of one plane.
override BLOCK: u32;
// Lines that a wave makes: for the lower level, and for the level that pixels gather from.
override LINES: u32;
override LINES_LAST: u32;
// Rows of a tile, and lanes before it.
override TILE: u32;
override BEFORE: u32;
const LANES: u32 = 64u;
const WAVES: i32 = 4;

@group(0) @binding(2) var<storage, read> cones: array<vec4f>;
@group(0) @binding(3) var<storage, read> intervals: array<vec2u>;
@group(0) @binding(4) var<storage, read> tints: array<u32>;
@group(0) @binding(5) var<storage, read_write> radiance: array<u32>;
@group(0) @binding(6) var panorama: texture_2d<f32>;
// Bound by `finish`: the light that pixels gather, on planes of odd index and of even index.
@group(0) @binding(7) var<storage, read_write> shown_odd: array<u32>;
@group(0) @binding(8) var<storage, read_write> shown_even: array<u32>;

// The lines: BLOCK cones need those of twice as many, and three to each side.
var<workgroup> lines: array<vec2u, (2u * BLOCK + 6u) * LANES>;

// The ray that stands for one that may lie beyond an edge of the quadrant, where none are made.
fn made(level: u32, ray: i32) -> i32 {
    return clamp(ray, 0, 2i << level);
}

// The rows by which a ray of a level rises from a plane to the next.
fn rise(level: u32, ray: i32) -> i32 {
    return made(level, ray) - (1i << level);
}

// Returns whether a cone of a level has light: the outermost have none.
fn is_lit(level: u32, cone: i32) -> bool {
    return cone > 0 && cone + 1 < i32(cone_count(level));
}

// The interval along a ray of the lowest level from a row of the plane p. A plane of even index is a plane of the level
// above: nothing lies between.
fn near(p: u32, ray: i32, row: i32) -> Interval {
    if (p & 1u) == 0u {
        return nothing();
    }
    return unpack(stored(p, made(sweep.level, ray), row));
}

// The light that arrives through a half cone, along an interval, of what is behind it.
fn along(interval: Interval, cone: u32, behind: vec3f) -> vec3f {
    return interval.transmittance * behind + interval.light * cones[cone].x;
}

// The light of two half cones of a level above in a row of a plane: the ends of a cone of the level below and of the next,
// which share a ray. The outermost cones have none: what is read in their place is dropped.
fn far(level: u32, plane: u32, cone: i32, row: i32) -> LightPair {
    let slot = (sweep.far - plane) * cone_count(level) / 2u + u32(cone);
    let at = sweep.above + PAIR_WORDS * slot * sweep.rows + u32(row);
    // The second of the pair before, and the first of its own. Loads that no branch holds back wait for memory together.
    let before = vec2u(radiance[at - sweep.rows], radiance[at - 2u * sweep.rows]);
    let own = vec2u(radiance[at], radiance[at + sweep.rows]);
    if u32(row) >= sweep.rows || plane >= planes(level) {
        return pair_beyond(sweep.cones_above + u32(2 * cone - 1), plane << level, row);
    }
    return LightPair(unpack_light(before.x, before.y >> 16u), unpack_light(own.x, own.y & 0xffffu));
}

// The light of two half cones along the ray between their cones.
fn along_ray(interval: Interval, cone: i32, behind: LightPair) -> LightPair {
    let first = sweep.cones_above + u32(2 * cone - 1);
    return LightPair(along(interval, first, behind.first), along(interval, first + 1u, behind.second));
}

// Stores the light of a half cone of the lowest level: one of even index is kept until that after it is there.
fn put(kept: ptr<function, vec3f>, p: u32, cone: i32, row: i32, light: vec3f) {
    if (cone & 1) == 0 {
        *kept = light;
        return;
    }
    let words = pack_pair(LightPair(*kept, light), u32(cone / 2), u32(row));
    let slot = (sweep.below_far - p) * cone_count(sweep.level) / 2u + u32(cone / 2);
    let at = sweep.below + PAIR_WORDS * slot * sweep.rows + u32(row);
    radiance[at] = words.x;
    radiance[at + sweep.rows] = words.y;
    radiance[at + 2u * sweep.rows] = words.z;
}

// The halves of a level alone, from the level above.
@compute @workgroup_size(64)
fn once(@builtin(workgroup_id) id: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let z = select_quadrant(id.z);
    let n = sweep.level;
    let row = i32(LANES * id.x + local.x);
    let p = sweep.first + z;
    let first = i32(id.y * RUN);
    let end = min(first + i32(RUN), i32(cone_count(n)));
    if row >= i32(sweep.rows) || z >= sweep.planes {
        return;
    }
    let odd = (p & 1u) == 1u;
    // Halves take light from a cone to each side.
    var kept: vec3f;
    var low = vec3f(0.0);
    var before = vec3f(0.0);
    var own = vec3f(0.0);
    for (var i = 0; i < i32(RUN) + 3; i++) {
        // A ray lies between a cone and the next.
        let cone = first - 2 + i;
        let ray = cone + 1 - BEYOND;
        let behind = far(n + 1u, (p + 1u) / 2u, cone, row + select(0, rise(n, ray), odd));
        let halves = along_ray(near(p, ray, row), cone, behind);
        let after = select(vec3f(0.0), low + halves.first, is_lit(n, cone));
        if cone > first && cone <= end {
            put(&kept, p, cone - 1, row, 0.5 * own + 0.25 * (before + after));
        }
        low = halves.second;
        before = own;
        own = after;
    }
}

// A workgroup's share of two levels.
struct Share {
    // The plane of the level between.
    q: u32,
    // The first line's cone, and lines that a wave makes.
    first: i32,
    run: i32,
    // The ray of the lowest level by which the first run is slanted; the next is by `run / 2` more.
    ray: i32,
    // The row of the lane: of the grid, on the plane 2q − 1, and in the tile.
    row: i32,
    place: i32,
}

// Rows by which a run of lines is shifted.
fn shift_of(s: Share, run: i32) -> i32 {
    return rise(sweep.level, s.ray + run * s.run / 2);
}

// The place in a run of lines of a lane's own row `away`.
fn in_run(s: Share, run: i32, away: i32) -> i32 {
    return s.place + away - shift_of(s, run);
}

// The light of a line's cone in the row `away` from the lane's.
fn held(s: Share, line: i32, away: i32) -> vec3f {
    let place = in_run(s, line / s.run, away) + i32(BEFORE);
    return unpack_rgb(lines[u32(line) * LANES + u32(place)]);
}

// Intervals of the level between from one row of its plane, ray by ray, each made of the lowest level's and rounded as
// if it had been stored.
struct Remade {
    // The ray of the lowest level, and its intervals from the row beside it.
    k: i32,
    before: Interval,
    own: Interval,
    after: Interval,
}

fn remake(r: ptr<function, Remade>, q: u32, ray: i32, row: i32) -> Interval {
    let n = sweep.level;
    let number = made(n + 1u, ray);
    let k = number >> 1u;
    let p = 2u * q;
    if k != (*r).k {
        (*r).before = (*r).own;
        (*r).own = (*r).after;
        (*r).after = unpack(stored(p, k + 1, row));
        (*r).k = k;
    }
    let end = row + k - (1i << n);
    var found: Interval;
    if (number & 1) == 0 {
        found = then((*r).own, unpack(stored(p + 1u, k, end)));
        if bends(n, u32(number), row) {
            let low = then((*r).before, unpack(stored(p + 1u, k + 1, end - 1)));
            let high = then((*r).after, unpack(stored(p + 1u, k - 1, end + 1)));
            found = bent(found, low, high);
        }
    } else {
        let low = then((*r).own, unpack(stored(p + 1u, k + 1, end)));
        let high = then((*r).after, unpack(stored(p + 1u, k, end + 1)));
        found = mean(low, high);
    }
    return unpack(pack(found));
}

// Makes a wave's lines, up to `end`, from a row of the plane between.
fn make_lines(s: Share, wave: i32, end: i32, lane: u32) {
    let u = sweep.level + 1u;
    let begin = s.first + wave * s.run;
    let to = s.first + min((wave + 1) * s.run, end);
    let row = s.row + shift_of(s, wave);
    let odd = (s.q & 1u) == 1u;
    let plane = (s.q + 1u) / 2u;
    let inside = u32(row) < sweep.rows && s.q < planes(u);
    if INFLOW && !inside {
        // `halves_before` finds what enters there.
        return;
    }
    var remade: Remade;
    let start = made(u, begin - BEYOND) >> 1u;
    if odd && inside {
        remade.own = unpack(stored(2u * s.q, start - 1, row));
        remade.after = unpack(stored(2u * s.q, start, row));
        remade.k = start - 1;
    }
    var low = vec3f(0.0);
    for (var ray = begin - BEYOND; ray <= to - BEYOND; ray++) {
        // A ray lies between a cone and the next.
        let cone = ray + BEYOND - 1;
        var interval = nothing();
        // Beyond the grid there is nothing.
        var behind = row;
        if odd && inside {
            interval = remake(&remade, s.q, ray, row);
            behind += rise(u, ray);
        }
        let halves = along_ray(interval, cone, far(u + 1u, plane, cone, behind));
        if cone >= begin {
            let light = select(vec3f(0.0), low + halves.first, is_lit(u, cone));
            lines[u32(cone - s.first) * LANES + lane] = pack_rgb(light);
        }
        low = halves.second;
    }
}

// The share of a workgroup, whose tiles begin so that they cover all rows of both planes that it leads to.
fn share_of(q: u32, tile: u32, lane: u32, first: i32, run: u32, ray: i32) -> Share {
    var s = Share(q, first, i32(run), ray, 0, i32(lane) - i32(BEFORE));
    s.row = i32(tile * TILE) - max(shift_of(s, WAVES - 1), 0) + s.place;
    return s;
}

// Returns whether there are rows of the grid in the tile, on either plane.
fn reaches(s: Share) -> bool {
    let row = s.row - s.place;
    let low = row + min(shift_of(s, 0), 0);
    let high = row + i32(TILE) + max(shift_of(s, WAVES - 1), 0);
    return low < i32(sweep.rows) && high > 0;
}

// The halves on the plane 2q − 1, from a cone on.
fn halves_before(s: Share, first: i32) {
    let n = sweep.level;
    let p = 2u * s.q - 1u;
    if u32(s.row) >= sweep.rows || p >= planes(n) {
        return;
    }
    let end = min(first + i32(BLOCK / 2u), i32(cone_count(n)));
    var kept: vec3f;
    var low = vec3f(0.0);
    var before = vec3f(0.0);
    var own = vec3f(0.0);
    for (var ray = first - 1 - BEYOND; ray < end + 2 - BEYOND; ray++) {
        // A ray lies between a cone and the next, and in front of four lines.
        let cone = ray + BEYOND - 1;
        let interval = near(p, ray, s.row);
        let away = rise(n, ray);
        let line = 2 * ray - s.first;
        let middle = array(held(s, line + 1, away), held(s, line + 2, away));
        // Lines end at the border.
        var entering: LightPair;
        let enters = INFLOW && (u32(s.row + away) >= sweep.rows || s.q >= planes(n + 1u));
        if enters {
            let half = sweep.cones_between + u32(2 * cone - 1);
            entering = pair_beyond(half, s.q << (n + 1u), s.row + away);
        }
        if cone >= first - 1 {
            var after = vec3f(0.0);
            if is_lit(n, cone) {
                let lines = 0.5 * middle[0] + 0.25 * (held(s, line, away) + middle[1]);
                let behind = select(lines, entering.first, enters);
                after = low + along(interval, sweep.cones_between + u32(2 * cone - 1), behind);
            }
            if cone > first {
                put(&kept, p, cone - 1, s.row, 0.5 * own + 0.25 * (before + after));
            }
            before = own;
            own = after;
        }
        if cone < end && is_lit(n, cone + 1) {
            let lines = 0.5 * middle[1] + 0.25 * (middle[0] + held(s, line + 3, away));
            let behind = select(lines, entering.second, enters);
            low = along(interval, sweep.cones_between + u32(2 * cone), behind);
        }
    }
}

// The halves on the plane 2q, which is the plane q. Cones go along the same row as far as few lanes read beside the tile.
fn halves_on(s: Share, first: i32) {
    let n = sweep.level;
    let p = 2u * s.q;
    if p >= planes(n) {
        return;
    }
    let block = (s.first + 5) / 2;
    let end = min(first + i32(BLOCK / 2u), i32(cone_count(n)));
    let together = s.run / 2;
    for (var begin = first; begin < end; begin += together - (begin - block) % together) {
        let run = (begin - block) / together;
        let to = min(end, block + (run + 1) * together);
        let away = rise(n, s.ray + run * together + together / 2);
        let row = s.row + away;
        // A cone is made of four lines, two of which are the next one's too.
        let line = 2 * begin - 5 - s.first;
        var low = array(held(s, line, away), held(s, line + 1, away));
        var kept: vec3f;
        var before = vec3f(0.0);
        var own = vec3f(0.0);
        for (var cone = begin - 1; cone <= to; cone++) {
            let line = 2 * cone - 1 - s.first;
            let high = array(held(s, line, away), held(s, line + 1, away));
            let after = 0.75 * (low[1] + high[0]) + 0.25 * (low[0] + high[1]);
            if cone > begin && u32(row) < sweep.rows {
                put(&kept, p, cone - 1, row, 0.5 * own + 0.25 * (before + after));
            }
            low = high;
            before = own;
            own = after;
        }
    }
}

@compute @workgroup_size(64, 4)
fn main(@builtin(workgroup_id) id: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let z = select_quadrant(id.z);
    let block = i32(id.y * BLOCK);
    let s = share_of(sweep.first + z, id.x, local.x, 2 * block - 5, LINES, block - BEYOND);
    // Browsers reject a barrier after a return that depends on the quadrant.
    let makes = z < sweep.planes && block < i32(cone_count(sweep.level)) && reaches(s);
    if makes {
        make_lines(s, i32(local.y), i32(2u * BLOCK + 6u), local.x);
    }
    workgroupBarrier();
    // Rows beside the tile are those of others.
    if makes && u32(s.place) < TILE {
        let first = block + i32(local.y & 1u) * i32(BLOCK / 2u);
        if local.y < 2u {
            halves_before(s, first);
        } else {
            halves_on(s, first);
        }
    }
}

// The lines of a wave in a row beyond the border.
fn make_lines_beyond(s: Share, wave: i32, row: i32, lane: u32) {
    let u = sweep.level + 1u;
    for (var line = wave * s.run; line < (wave + 1) * s.run; line++) {
        var light = vec3f(0.0);
        if is_lit(u, s.first + line) {
            light = beyond(sweep.cones_between + u32(s.first + line), s.q << u, row);
        }
        lines[u32(line) * LANES + lane] = pack_rgb(light);
    }
}

// The light that pixels gather from the plane 2q − 1 through a line's cone.
fn finished(s: Share, line: i32, low: Interval, high: Interval) -> vec3f {
    let cone = s.first + line;
    let ray = cone / 2 - BEYOND / 2;
    let weight = select(0.25, 0.75, (cone & 1) == 0);
    let angle = sweep.cones_between + u32(cone);
    let at_low = along(low, angle, held(s, line, rise(sweep.level, ray)));
    let at_high = along(high, angle, held(s, line, rise(sweep.level, ray + 1)));
    return weight * at_low + (1.0 - weight) * at_high;
}

// The light that pixels gather: that of the plane q, and of the plane 2q − 1 of the level below. There cones are half as
// wide, those of the level above. The middle of each lies at a quarter between the rays on both sides of it; two cones
// share these.
@compute @workgroup_size(64, 4)
fn finish(@builtin(workgroup_id) id: vec3u, @builtin(local_invocation_id) local: vec3u) {
    let z = select_quadrant(id.z);
    let n = sweep.level;
    // The outermost cones have no light.
    let shown = shown_count(n + 1u);
    let before = id.y * u32(WAVES) * LINES_LAST;
    let s = share_of(sweep.first + z, id.x, local.x, i32(before) + 1, LINES_LAST, i32(before / 2u));
    let wave = i32(local.y);
    let row = s.row + shift_of(s, wave);
    let makes = z < sweep.planes && before < shown && reaches(s);
    if makes {
        if u32(row) < sweep.rows && s.q < planes(n + 1u) {
            make_lines(s, wave, WAVES * s.run, local.x);
        } else {
            make_lines_beyond(s, wave, row, local.x);
        }
    }
    workgroupBarrier();
    if !makes || u32(s.place) >= TILE {
        return;
    }
    let p = 2u * s.q - 1u;
    let lines = min(WAVES * s.run, i32(shown - before));
    for (var line = 2 * wave; line < lines; line += 2 * WAVES) {
        let pair = (before + u32(line)) / 2u;
        let away = shift_of(s, line / s.run);
        let row = u32(s.row + away);
        if row < sweep.rows && s.q < planes(n + 1u) {
            let words = pack_pair(LightPair(held(s, line, away), held(s, line + 1, away)), pair, row);
            let slot = (sweep.below_far / 2u - s.q) * shown / 2u + pair;
            let at = sweep.between + PAIR_WORDS * slot * sweep.rows + row;
            shown_even[at] = words.x;
            shown_even[at + sweep.rows] = words.y;
            shown_even[at + 2u * sweep.rows] = words.z;
        }
        if u32(s.row) < sweep.rows && p < planes(n) {
            let ray = (s.first + line) / 2 - BEYOND / 2;
            let middle = near(p, ray + 1, s.row);
            let first = finished(s, line, near(p, ray, s.row), middle);
            let second = finished(s, line + 1, middle, near(p, ray + 2, s.row));
            let words = pack_pair(LightPair(first, second), pair, u32(s.row));
            let slot = (sweep.below_far - p) / 2u * shown / 2u + pair;
            let at = sweep.below + PAIR_WORDS * slot * sweep.rows + u32(s.row);
            shown_odd[at] = words.x;
            shown_odd[at + sweep.rows] = words.y;
            shown_odd[at + 2u * sweep.rows] = words.z;
        }
    }
}
