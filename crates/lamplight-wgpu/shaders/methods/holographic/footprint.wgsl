// Rays along footprints, which are the same from every row, through the cells near a tile of 64 rows.

#import methods/holographic/packed_rgb
#import methods/holographic/sweep
#import shared/absorptance
#import shared/interval
#import shared/transmittance
#import shared/uniforms

// The bits of a cell, as slabs.wgsl makes them.
override OCCUPIED: u32;
override MEDIUM: u32;
override EMITTING: u32;
override SMALL: u32;

const TILE: u32 = 64u;
// Slabs that a tile reads: one behind, its own, and those ahead.
const SLABS: u32 = 33u;
// Words of 32 rows: a tile and 32 rows to either side.
const ACROSS: u32 = 4u;
const ASIDE: i32 = 32;

@group(0) @binding(2) var<storage, read> footprints: array<u32>;
@group(0) @binding(3) var<storage, read> cell_bits: array<u32>;
@group(0) @binding(4) var emission: texture_2d<f32>;
@group(0) @binding(5) var matter: texture_2d<f32>;
@group(0) @binding(6) var<storage, read> scattered: array<vec2u>;

// By bit, slab and word.
var<workgroup> near: array<u32, 4u * SLABS * ACROSS>;
var<workgroup> any_near: atomic<u32>;

// The bits of 32 rows of a slab from a multiple of 32 on.
fn word_of(bit: u32, slab: u32, word: u32) -> u32 {
    let words = (sweep.rows + 31u) / 32u;
    if slab >= sweep.depth || word >= words {
        return 0u;
    }
    let place = select(slab, sweep.depth - 1u - slab, sweep.reversed == 1u);
    return cell_bits[sweep.cell_bits + (bit * sweep.depth + place) * words + word];
}

// Fetches the bits around 64 rows, from the slab behind `slab` to the one `ahead` of it.
fn fetch(local: u32, lanes: u32, slab: u32, row: i32, ahead: u32) {
    for (var i = local; i < 4u * (ahead + 2u) * ACROSS; i += lanes) {
        let bit = i / ((ahead + 2u) * ACROSS);
        let away = i / ACROSS % (ahead + 2u);
        let first = row + 32 * (i32(i % ACROSS) - 1);
        let at = slab + away - 1u;
        // Rounded down, below 0 too.
        let word = u32(first >> 5u);
        let shift = u32(first) & 31u;
        var found = word_of(bit, at, word) >> shift;
        if shift != 0u {
            found |= word_of(bit, at, word + 1u) << (32u - shift);
        }
        near[(bit * SLABS + away) * ACROSS + i % ACROSS] = found;
        if found != 0u {
            atomicOr(&any_near, 1u);
        }
    }
}

// Returns whether the cell `slabs` and `rows` from a lane's has a bit.
fn is(bit: u32, lane: u32, slabs: i32, rows: i32) -> bool {
    let row = u32(i32(lane) + rows + ASIDE);
    let word = near[(bit * SLABS + u32(slabs + 1)) * ACROSS + row / 32u];
    return ((word >> (row % 32u)) & 1u) == 1u;
}

fn is_solid(lane: u32, slabs: i32, rows: i32) -> bool {
    return is(OCCUPIED, lane, slabs, rows) && !is(MEDIUM, lane, slabs, rows);
}

// Returns whether any cell of a mask has a bit. The mask begins at `mask`, with two words per slab.
fn any_of(bit: u32, lane: u32, mask: u32, slabs: u32) -> bool {
    let word = lane / 32u;
    let shift = lane % 32u;
    var met = 0u;
    for (var slab = 0u; slab < slabs; slab++) {
        let at = (bit * SLABS + slab + 1u) * ACROSS + word;
        // Rows from 32 below the lane's to 31 above it. WGSL has no shift by 32.
        let high = select(near[at + 1u] << (32u - shift), 0u, shift == 0u);
        let higher = select(near[at + 2u] << (32u - shift), 0u, shift == 0u);
        met |= ((near[at] >> shift) | high) & footprints[mask + 2u * slab];
        met |= ((near[at + 1u] >> shift) | higher) & footprints[mask + 2u * slab + 1u];
    }
    return met != 0u;
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

// The interval of a ray from a lane's row, over `count` crossings of two words from `first` on.
fn march(slab: u32, row: u32, lane: u32, first: u32, count: u32) -> Interval {
    var interval = nothing();
    for (var i = first; i < first + 2u * count; i += 2u) {
        let crossing = footprints[i];
        let slabs = i32(crossing & 255u);
        let rows = i32((crossing >> 8u) & 255u) - 128;
        if !is(OCCUPIED, lane, slabs, rows) {
            continue;
        }
        let at = cell_of(slab + u32(slabs), u32(i32(row) + rows));
        let solid = !is(MEDIUM, lane, slabs, rows);
        var transmittance = vec3f(0.0);
        var absorbed = vec3f(1.0);
        if !solid {
            let depth = extinction_of(textureLoad(matter, at, 0)) * bitcast<f32>(footprints[i + 1u]);
            transmittance = exp(-depth);
            absorbed = absorptance(depth);
        }
        if is(EMITTING, lane, slabs, rows) {
            interval.light +=
                interval.transmittance * absorbed * radiance_of(at, solid, crossing >> 16u);
        }
        interval.transmittance *= transmittance;
        if all(interval.transmittance == vec3f(0.0)) {
            break;
        }
    }
    return interval;
}
