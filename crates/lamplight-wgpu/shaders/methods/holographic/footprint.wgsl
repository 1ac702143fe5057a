// Rays along footprints, which are the same from every row, through the cells near a tile of 64 rows.

#import methods/holographic/packed_rgb
#import methods/holographic/quadrant
#import shared/absorptance
#import shared/interval
#import shared/transmittance
#import shared/uniforms

// The bits of a cell, as slabs.wgsl makes them.
override MATTER: u32;
override MEDIUM: u32;
override EMISSIVE: u32;
// The bit that is read as the last of four: that of small sources for bundles, that of own light for pixels.
override FOURTH: u32;
const LAST: u32 = 3u;

const TILE: u32 = 64u;
// Slabs that a tile reads: one behind, its own, and those ahead.
const SLABS: u32 = 33u;
// Words of 32 rows: a tile and 32 rows to either side.
const ACROSS: u32 = 4u;
const ASIDE: i32 = 32;

// In entries of two words, as tables.rs makes them.
@group(0) @binding(2) var<storage, read> footprints: array<vec2u>;
@group(0) @binding(3) var<storage, read> cell_bits: array<u32>;
@group(0) @binding(4) var emission: texture_2d<f32>;
@group(0) @binding(5) var matter: texture_2d<f32>;
@group(0) @binding(6) var<storage, read> scattered: array<vec2u>;

// By bit and slab, ACROSS words.
var<workgroup> near: array<vec4u, 4u * SLABS>;

// The slab of a lane, counted from the first of the workgroup.
var<private> own_slab: u32 = 0u;

// The bits of 32 rows of a slab from a multiple of 32 on.
fn word_of(bit: u32, slab: u32, word: u32) -> u32 {
    if slab >= sweep.cell_depth || word >= sweep.cell_words {
        return 0u;
    }
    let place = select(slab, sweep.cell_depth - 1u - slab, sweep.reversed == 1u);
    return cell_bits[sweep.cell_bits + (bit * sweep.cell_depth + place) * sweep.cell_words + word];
}

// Fetches the bits around 64 rows, from the slab behind `slab` to the one `ahead` of it. A lane fetches a bit of a slab,
// since parts of a vector must not be written by several.
fn fetch(local: u32, lanes: u32, slab: u32, row: i32, ahead: u32) {
    // Rounded down, below 0 too.
    let word = u32((row - ASIDE) >> 5u);
    let shift = u32(row) & 31u;
    for (var i = local; i < 4u * (ahead + 2u); i += lanes) {
        let bit = i % 4u;
        let away = i / 4u;
        let at = slab + away - 1u;
        var words: array<u32, 5>;
        for (var across = 0u; across <= ACROSS; across++) {
            words[across] = word_of(select(bit, FOURTH, bit == LAST), at, word + across);
        }
        let own = vec4u(words[0], words[1], words[2], words[3]);
        let next = vec4u(words[1], words[2], words[3], words[4]);
        // WGSL has no shift by 32.
        let rest = select(next << vec4u(32u - shift), vec4u(0u), shift == 0u);
        near[bit * SLABS + away] = (own >> vec4u(shift)) | rest;
    }
}

// Returns whether the cell `slabs` and `rows` from a lane's has a bit.
fn is(bit: u32, lane: u32, slabs: i32, rows: i32) -> bool {
    let row = u32(i32(lane) + rows + ASIDE);
    let word = near[bit * SLABS + own_slab + u32(slabs + 1)][row / 32u];
    return ((word >> (row % 32u)) & 1u) == 1u;
}

fn is_solid(lane: u32, slabs: i32, rows: i32) -> bool {
    return is(MATTER, lane, slabs, rows) && !is(MEDIUM, lane, slabs, rows);
}

// Returns whether a row of the tile is among those with a bit.
fn has(rows: vec2u, lane: u32) -> bool {
    return ((select(rows.x, rows.y, lane >= 32u) >> (lane % 32u)) & 1u) == 1u;
}

// The rows of the tile whose cell in a slab of the workgroup is solid.
fn solid_rows(slab: u32) -> vec2u {
    return near[MATTER * SLABS + slab + 1u].yz & ~near[MEDIUM * SLABS + slab + 1u].yz;
}

// The bits of all rows of the tile, if `words` are those of rows from 32 before the tile on, shifted by `rows`.
fn shifted(words: vec4u, rows: u32) -> vec2u {
    let from_word = select(words.xyz, words.yzw, rows >= 32u);
    let shift = rows & 31u;
    // WGSL has no shift by 32.
    let rest = select(from_word.yz << vec2u(32u - shift), vec2u(0u), shift == 0u);
    return (from_word.xy >> vec2u(shift)) | rest;
}

// The rows of the slab `begin` of a workgroup from which any cell of a mask has a bit. The mask begins at `mask`, with an
// entry per slab: rows from −32 to −1, and from 0 to 31.
fn meeting(bit: u32, mask: u32, begin: u32, slabs: u32) -> vec2u {
    var met = vec2u(0u);
    for (var slab = 0u; slab < slabs; slab++) {
        let ones = near[bit * SLABS + begin + slab + 1u];
        if all(ones == vec4u(0u)) {
            continue;
        }
        let cells = footprints[mask + slab];
        for (var side = 0u; side < 2u; side++) {
            var left = select(cells.x, cells.y, side == 1u);
            while left != 0u {
                met |= shifted(ones, 32u * side + firstTrailingBit(left));
                left &= left - 1u;
            }
        }
    }
    return met;
}

// The rows of the slab `begin` of a workgroup, among `rows`, from which a ray is stopped by a dark wall, and those from
// which it has to be traced, since it meets light or a medium first. From the others it passes.
fn first_met(crossings: vec2u, begin: u32, rows: vec2u) -> vec4u {
    var stopped = vec2u(0u);
    var traced = vec2u(0u);
    var open = rows;
    for (var i = crossings.x; i < crossings.x + crossings.y && any(open != vec2u(0u)); i++) {
        let crossing = footprints[i].x;
        let at = begin + slabs_to(crossing) + 1u;
        let away = u32(rows_to(crossing) + ASIDE);
        let hit = open & shifted(near[MATTER * SLABS + at], away);
        if any(hit != vec2u(0u)) {
            let dark = ~shifted(near[MEDIUM * SLABS + at] | near[EMISSIVE * SLABS + at], away);
            stopped |= hit & dark;
            traced |= hit & ~dark;
            open &= ~hit;
        }
    }
    return vec4u(stopped, traced);
}

// The radiance that leaves a cell by the face that a ray meets: 0 ahead, 1 from lower rows, 2 from higher
// ones.
fn radiance_of(at: vec2u, solid: bool, face: u32) -> vec3f {
    var light = textureLoad(emission, at, 0).rgb;
    if sweep.indirect == 1u {
        let front = select(2u * sweep.axis, 2u * sweep.axis + 1u, sweep.reversed == 1u);
        let side = 2u * (1u - sweep.axis) + face - 1u;
        let met = select(select(side, front, face == 0u), 0u, !solid);
        light += unpack_rgb(scattered[4u * index(at) + met]);
    }
    return light;
}

// Slabs and rows from the start of a ray to a cell that it crosses.
fn slabs_to(crossing: u32) -> u32 {
    return crossing & 255u;
}

fn rows_to(crossing: u32) -> i32 {
    return i32((crossing >> 8u) & 255u) - 128;
}

// Returns whether a cell that a ray crosses has a bit.
fn is_crossed(bit: u32, lane: u32, crossing: u32) -> bool {
    return is(bit, lane, i32(slabs_to(crossing)), rows_to(crossing));
}

// The interval of a ray from a lane's row. `crossings` are the first of them and their number. Lanes search for their
// next cell together and then read it together, since to read a cell takes much longer than to pass it.
fn march(slab: u32, row: u32, lane: u32, crossings: vec2u) -> Interval {
    var interval = nothing();
    let end = crossings.x + crossings.y;
    for (var i = crossings.x; i < end; i++) {
        var entry = footprints[i];
        while !is_crossed(MATTER, lane, entry.x) {
            i++;
            if i == end {
                return interval;
            }
            entry = footprints[i];
        }
        let at = cell_of(slab + slabs_to(entry.x), u32(i32(row) + rows_to(entry.x)));
        let solid = !is_crossed(MEDIUM, lane, entry.x);
        var transmittance = vec3f(0.0);
        var absorbed = vec3f(1.0);
        if !solid {
            let depth = extinction_of(textureLoad(matter, at, 0)) * bitcast<f32>(entry.y);
            transmittance = exp(-depth);
            absorbed = absorptance(depth);
        }
        if is_crossed(EMISSIVE, lane, entry.x) {
            interval.light +=
                interval.transmittance * absorbed * radiance_of(at, solid, entry.x >> 16u);
        }
        interval.transmittance *= transmittance;
        if all(interval.transmittance == vec3f(0.0)) {
            break;
        }
    }
    return interval;
}
