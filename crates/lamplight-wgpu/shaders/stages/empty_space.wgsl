// Empty-space skipping: for each cell and quadrant the side of the largest square of equal cells that has
// the cell in its corner. A square of side 2^k consists of equal cells if its four quarters do; any other
// side is covered by four squares of the largest power of two that fits.
//
// Four quadrants per word, eight bits each. While powers are found: 1 + the power, 0 in cells that stop
// rays; in the end the side, and HAS_MEDIUM if the square is filled with a medium.

#import shared/class
#import shared/uniforms

override MAX_SKIP: u32;
override HAS_MEDIUM: u32;

@group(0) @binding(1) var<uniform> step: u32;
@group(0) @binding(2) var<storage, read> source: array<vec4f>;
@group(0) @binding(3) var<storage, read> extinction: array<vec4f>;
@group(0) @binding(4) var<storage, read> before: array<u32>;
@group(0) @binding(5) var<storage, read_write> after: array<u32>;

@compute @workgroup_size(8, 8)
fn begin(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    let cell_class = class_of(source[i]);
    // Rays stop at solid cells, at what changed, and at media if emission fades with distance.
    let fades = frame.fade_range > 0.0 && cell_class == MEDIUM;
    let stops = cell_class == SOLID || extinction[i].w > 0.0 || fades;
    after[i] = select(0x01010101u, 0u, stops);
}

// Returns whether the square of side 2^power at a cell consists of cells equal to the cell at i.
fn equal(i: u32, at: vec2i, shift: u32, power: u32) -> bool {
    let empty = class_of(source[i]) == EMPTY;
    // Everything beyond the grid is empty.
    if !inside(at) {
        return empty;
    }
    let j = index(vec2u(at));
    let same = all(source[i] == source[j]) && all(extinction[i] == extinction[j]);
    let fits = select(same, class_of(source[j]) == EMPTY, empty);
    return fits && ((before[j] >> shift) & 255u) > power;
}

// Returns whether four squares of side 2^power cover one of side 2^power + offset, all equal to the corner.
fn covered(i: u32, at: vec2i, towards: vec2i, shift: u32, power: u32, offset: i32) -> bool {
    return equal(i, at + vec2i(towards.x, 0) * offset, shift, power)
        && equal(i, at + vec2i(0, towards.y) * offset, shift, power)
        && equal(i, at + towards * offset, shift, power);
}

fn diagonal(quadrant: u32) -> vec2i {
    return select(vec2i(1), vec2i(-1), vec2<bool>((quadrant & 1u) == 1u, (quadrant & 2u) == 2u));
}

// From squares of side 2^(step − 1) to those of twice the side.
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
            && covered(i, vec2i(id.xy), diagonal(quadrant), shift, power, 1i << power) {
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
            if covered(i, vec2i(id.xy), diagonal(quadrant), shift, power, offset) {
                side = longer;
            }
        }
        side = min(side, MAX_SKIP) | select(0u, HAS_MEDIUM, class_of(source[i]) == MEDIUM);
        sides |= side << shift;
    }
    after[i] = sides;
}
