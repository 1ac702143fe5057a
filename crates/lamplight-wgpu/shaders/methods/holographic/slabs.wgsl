// The cells as quadrants read them: five bits per cell, slab by slab along both axes, 32 rows per word. The
// irradiance that matter has from the gather before is cleared.

#import methods/holographic/packed_rgb
#import methods/holographic/quadrant
#import shared/uniforms

// The bits: anything but empty space; a medium; emission, or scattered radiance; a small source;
// emission.
override MATTER: u32;
override MEDIUM: u32;
override EMISSIVE: u32;
override SMALL: u32;
override PRIMARY: u32;
const BITS: u32 = 5u;
// Columns of a workgroup.
const COLUMNS: u32 = 64u;

@group(0) @binding(2) var emission: texture_2d<f32>;
@group(0) @binding(3) var matter: texture_2d<f32>;
@group(0) @binding(4) var<storage, read> scattered: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> cell_bits: array<u32>;
@group(0) @binding(6) var<storage, read_write> irradiance: array<vec2u>;

// By bit, the words of the columns.
var<workgroup> columns: array<u32, BITS * COLUMNS>;

fn emits_itself(at: vec2u) -> bool {
    return any(textureLoad(emission, at, 0).rgb != vec3f(0.0));
}

fn scatters(at: vec2u) -> bool {
    var scatters = false;
    for (var face = 0u; face < 4u && sweep.indirect == 1u; face++) {
        scatters = scatters || any(unpack_rgb(scattered[4u * index(at) + face]) != vec3f(0.0));
    }
    return scatters;
}

// Returns whether there is a cell that emits.
fn is_emitting(at: vec2i) -> bool {
    if any(at < vec2i(0)) || outside(vec2u(at)) {
        return false;
    }
    return any(textureLoad(matter, at, 0) != vec4f(1.0, 1.0, 1.0, 0.0)) && (emits_itself(vec2u(at)) || scatters(vec2u(at)));
}

// The number of cells in a row that emit, from the one after another on, up to `most`.
fn emitting_after(at: vec2i, step: vec2i, most: i32) -> i32 {
    var count = 0;
    while count < most && is_emitting(at + (count + 1) * step) {
        count++;
    }
    return count;
}

// Returns whether a cell that emits is part of a source at most four points of the lattice wide and high, with nothing
// solid around it. The emitting cells are counted along its row and its column, and again across the middle of each of these
// runs, so that a disc is small as a whole or not at all.
fn is_small(at: vec2u) -> bool {
    let most = 4i << sweep.spacing_level;
    var is_small = is_alone(at);
    var through = vec2i(at);
    for (var turn = 0u; turn < 4u && is_small; turn++) {
        // Its row, across the middle of that; its column, across the middle of that.
        through = select(through, vec2i(at), turn == 2u);
        let step = select(vec2i(0, 1), vec2i(1, 0), turn == 0u || turn == 3u);
        let before = emitting_after(through, -step, most);
        let after = emitting_after(through, step, most);
        is_small = before + after < most;
        through += ((before + after) / 2 - before) * step;
    }
    return is_small;
}

fn is_solid(at: vec2i) -> bool {
    let inside = all(at >= vec2i(0)) && !outside(vec2u(at));
    return inside && textureLoad(matter, at, 0).a >= 1.0;
}

// Returns whether none of the eight cells around this one is solid.
fn is_alone(at: vec2u) -> bool {
    var alone = true;
    for (var i = 0; i < 9; i++) {
        alone = alone && (i == 4 || !is_solid(vec2i(at) + vec2i(i % 3, i / 3) - 1));
    }
    return alone;
}

// The place of a word of a bit in a slab along an axis. Those of the axis along x come first.
fn put(bit: u32, axis: u32, slab: u32, word: u32, bits: u32) {
    let slabs = frame.size[axis];
    let words = (frame.size + 31u) / 32u;
    let in_slab = words[1u - axis];
    if slab < slabs && word < in_slab {
        let first = axis * BITS * frame.size.x * words.y;
        cell_bits[first + (bit * slabs + slab) * in_slab + word] = bits;
    }
}

// Returns the bits of a cell, and clears the irradiance of matter.
fn bits_of(at: vec2u) -> u32 {
    let tint_opacity = textureLoad(matter, at, 0);
    if all(tint_opacity == vec4f(1.0, 1.0, 1.0, 0.0)) {
        return 0u;
    }
    for (var face = 0u; face < 4u; face++) {
        irradiance[4u * index(at) + face] = vec2u(0u);
    }
    let own = emits_itself(at);
    let emitting = own || scatters(at);
    let small = emitting && is_small(at);
    return (1u << MATTER)
        | (u32(tint_opacity.a < 1.0) << MEDIUM)
        | (u32(emitting) << EMISSIVE)
        | (u32(small) << SMALL)
        | (u32(own) << PRIMARY);
}

// A workgroup reads 64 columns of 32 cells: a word of each column, and from these two words of each row.
@compute @workgroup_size(COLUMNS)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    select_quadrant(0u);
    let column = COLUMNS * group.x + lane;
    var own: array<u32, BITS>;
    for (var row = 0u; row < 32u; row++) {
        let at = vec2u(column, 32u * group.y + row);
        if !outside(at) {
            let bits = bits_of(at);
            for (var bit = 0u; bit < BITS; bit++) {
                own[bit] |= ((bits >> bit) & 1u) << row;
            }
        }
    }
    for (var bit = 0u; bit < BITS; bit++) {
        columns[bit * COLUMNS + lane] = own[bit];
        put(bit, 0u, column, group.y, own[bit]);
    }
    workgroupBarrier();
    let row = lane % 32u;
    let first = lane - row;
    var occupied = 0u;
    for (var bit = 0u; bit < BITS; bit++) {
        var bits = 0u;
        // Where a cell is empty it has none of the others.
        for (var i = 0u; i < 32u && (bit == MATTER || occupied != 0u); i++) {
            bits |= ((columns[bit * COLUMNS + first + i] >> row) & 1u) << i;
        }
        occupied = select(occupied, bits, bit == MATTER);
        put(bit, 1u, 32u * group.y + row, 2u * group.x + first / 32u, bits);
    }
}
