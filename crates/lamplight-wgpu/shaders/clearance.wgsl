// Clear squares: for each cell and quadrant the side of the largest square of one kind of matter
// that has the cell in its corner. A square of side 2^k is of one kind where its four quarters are;
// any other side is covered by four squares of the largest power of two that fits.
//
// Four quadrants to a word, eight bits each. While powers are found: 1 + the power, 0 in closed
// cells; in the end the side, and MATTER where there is some.

override LONGEST: u32;
override MATTER: u32;

@group(0) @binding(1) var<uniform> step: u32;
@group(0) @binding(2) var<storage, read> source: array<vec4f>;
@group(0) @binding(3) var<storage, read> logs: array<vec4f>;
@group(0) @binding(4) var<storage, read> before: array<u32>;
@group(0) @binding(5) var<storage, read_write> after: array<u32>;

@compute @workgroup_size(8, 8)
fn begin(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    // Rays stop at walls, at what changed, and at fog where light fades with distance.
    let fades = frame.fade_range > 0.0 && source[i].w == MEDIUM;
    let closed = source[i].w == SOLID || logs[i].w > 0.0 || fades;
    after[i] = select(0x01010101u, 0u, closed);
}

// Whether the square of side 2^power at a cell is all like the cell at i.
fn like(i: u32, at: vec2i, shift: u32, power: u32) -> bool {
    let clear = source[i].w == CLEAR;
    // Outside of the grid all is clear.
    if !inside(at) {
        return clear;
    }
    let j = index(vec2u(at));
    let same = all(source[i] == source[j]) && all(logs[i] == logs[j]);
    let kind = select(same, source[j].w == CLEAR, clear);
    return kind && ((before[j] >> shift) & 255u) > power;
}

// Whether four squares of side 2^power cover one of side 2^power + offset, all like the corner.
fn covered(i: u32, at: vec2i, way: vec2i, shift: u32, power: u32, offset: i32) -> bool {
    return like(i, at + vec2i(way.x, 0) * offset, shift, power)
        && like(i, at + vec2i(0, way.y) * offset, shift, power)
        && like(i, at + way * offset, shift, power);
}

fn way(quadrant: u32) -> vec2i {
    return select(vec2i(1), vec2i(-1), vec2<bool>((quadrant & 1u) == 1u, (quadrant & 2u) == 2u));
}

// Step by step from squares of side 1 to those twice as long.
@compute @workgroup_size(8, 8)
fn double(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    let power = step - 1u;
    var powers = before[i];
    for (var quadrant = 0u; quadrant < 4u; quadrant++) {
        let shift = 8u * quadrant;
        if ((powers >> shift) & 255u) == power + 1u
            && covered(i, vec2i(id.xy), way(quadrant), shift, power, 1i << power) {
            powers += 1u << shift;
        }
    }
    after[i] = powers;
}

// From powers to sides.
@compute @workgroup_size(8, 8)
fn finish(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    var sides = 0u;
    for (var quadrant = 0u; quadrant < 4u; quadrant++) {
        let shift = 8u * quadrant;
        let powers = (before[i] >> shift) & 255u;
        if powers == 0u {
            continue;
        }
        let power = powers - 1u;
        var side = 1u << power;
        for (var more = side >> 1u; more > 0u; more >>= 1u) {
            let longer = side + more;
            let offset = i32(longer) - (1i << power);
            if covered(i, vec2i(id.xy), way(quadrant), shift, power, offset) {
                side = longer;
            }
        }
        side = min(side, LONGEST) | select(0u, MATTER, source[i].w == MEDIUM);
        sides |= side << shift;
    }
    after[i] = sides;
}
