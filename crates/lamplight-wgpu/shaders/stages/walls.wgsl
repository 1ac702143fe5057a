// The light that solid cells show: it sinks in from their faces, and emission shows on top. The library's
// `walls.rs` derives it, and its `pyramid.rs` the blurs.

#import shared/luminance
#import shared/moment
#import shared/normal
#import shared/solid
#import shared/uniforms

// The weight of an octave relative to the one before.
override OCTAVE: f32;
// The sum of weights behind a long straight wall, times d² + SOFTENING.
override STRAIGHT: f32;
override SOFTENING: f32;
// Weights of the six fine cells around a coarse one.
override KERNEL_0: f32;
override KERNEL_1: f32;
override KERNEL_2: f32;
// Weights in the mean along the surface, by the distance along an axis.
override ALONG_0: f32;
override ALONG_1: f32;
override ALONG_2: f32;
// 0: light sinks in, with emission on top. 1 and 2: a component of the first moment does, without emission.
override COMPONENT: u32;
// Light sinks no deeper, px.
override MAX_WALL_DEPTH: f32;
// Cells of a row whose flags share a word.
override CELLS_PER_WORD: u32;

// The flags of a solid cell: its open sides (left, right, upper, lower), that it is solid, that it emits. Cells beyond
// the grid have one of their own while a workgroup holds them.
const SIDES: u32 = 15u;
const SOLID: u32 = 16u;
const EMITS: u32 = 32u;
const BEYOND: u32 = 64u;

// A workgroup of a blur makes a tile of a level, and for it the level between and the cells or the level below, with as
// many beside the tile as the kernel reads: all are squares with these sides.
const LANES: u32 = 256u;
const TILE: u32 = 6u;
const BETWEEN: u32 = 2u * TILE + 4u;
// With a cell more to each side, whose flags are needed.
const CELLS: u32 = 2u * BETWEEN + 6u;
// Cells along a side of what the tile covers.
const COVERED: u32 = 4u * TILE;
// Held cells to each side of them.
const BESIDE: u32 = (CELLS - COVERED) / 2u;
// Cells along a side of a workgroup in which light sinks in, and of the first level that they are interpolated from.
const SUNK: u32 = 16u;
const REGION: u32 = SUNK / 2u + 2u;

// The level of the pyramid; the cells are level 0.
@group(0) @binding(2) var<uniform> step: u32;
@group(0) @binding(3) var emission: texture_2d<f32>;
// The light of cells with a face towards an open one.
@group(0) @binding(4) var<storage, read_write> surface: array<vec4f>;
// All levels from 1 on: irradiance and its weight.
@group(0) @binding(5) var<storage, read_write> irradiance: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> sunk_emission: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> light: array<vec4f>;
// The flags of solid cells, and 0 of others.
@group(0) @binding(8) var<storage, read_write> cell_flags: array<u32>;

var<workgroup> held_flags: array<u32, CELLS * CELLS>;
var<workgroup> held_irradiance: array<vec4f, BETWEEN * BETWEEN>;
var<workgroup> held_emission: array<vec4f, BETWEEN * BETWEEN>;
var<workgroup> coarse_irradiance: array<vec4f, REGION * REGION>;
var<workgroup> coarse_emission: array<vec4f, REGION * REGION>;
var<workgroup> row_flags: array<u32, SUNK>;
var<workgroup> any_flags: array<u32, 1>;

struct Sums {
    irradiance: vec4f,
    emission: vec4f,
}

fn open(at: vec2i) -> bool {
    return inside(at) && !solid(at);
}

// The place of a level in the buffers. The cells are level 0, which is not stored.
struct Level {
    start: u32,
    size: vec2u,
}

fn find_level(number: u32) -> Level {
    var level = Level(0u, frame.size);
    for (var k = 0u; k < number; k++) {
        level.start += select(level.size.x * level.size.y, 0u, k == 0u);
        level.size = (level.size + 1u) / 2u;
    }
    return level;
}

fn level_index(level: Level, at: vec2u) -> u32 {
    return level.start + at.y * level.size.x + at.x;
}

// Words of flags from a row to the next.
fn flag_words() -> u32 {
    return (frame.size.x + CELLS_PER_WORD - 1u) / CELLS_PER_WORD;
}

// The first bit of the flags of a cell in their word.
fn flag_shift(column: u32) -> u32 {
    return 32u / CELLS_PER_WORD * (column % CELLS_PER_WORD);
}

fn flags_at(at: vec2u) -> u32 {
    let word = cell_flags[at.y * flag_words() + at.x / CELLS_PER_WORD];
    return (word >> flag_shift(at.x)) & (SIDES | SOLID | EMITS);
}

// The place of what sinks in, of a cell.
fn value_index(i: u32) -> u32 {
    return COMPONENT * frame.size.x * frame.size.y + i;
}

// The emission of a solid cell with these flags.
fn emission_of(at: vec2u, flags: u32) -> vec3f {
    if COMPONENT > 0u || (flags & EMITS) == 0u {
        return vec3f(0.0);
    }
    return textureLoad(emission, at, 0).rgb;
}

// The flags of a cell that do not depend on others.
fn own_flags(at: vec2i) -> u32 {
    if !inside(at) {
        return BEYOND;
    }
    if !solid(at) {
        return 0u;
    }
    let emits = COMPONENT == 0u && any(textureLoad(emission, at, 0).rgb != vec3f(0.0));
    return SOLID | select(0u, EMITS, emits);
}

// The flags of the cells beside a held one.
fn beside(slot: u32) -> vec4u {
    return vec4u(
        held_flags[slot - 1u], held_flags[slot + 1u], held_flags[slot - CELLS], held_flags[slot + CELLS]
    );
}

// The flags of a held cell with its open sides.
fn flags_of(slot: u32) -> u32 {
    let own = held_flags[slot];
    if (own & SOLID) == 0u {
        return 0u;
    }
    return own | dot(vec4u(1u, 2u, 4u, 8u), vec4u(beside(slot) == vec4u(0u)));
}

// The sums of a held cell of the grid.
fn sums_of_cell(at: vec2u, slot: u32) -> Sums {
    let flags = flags_of(slot);
    if (flags & SIDES) != 0u {
        let length = sqrt(f32(countOneBits(flags & SIDES)));
        let arrives = light[value_index(index(at))].rgb;
        return Sums(length * vec4f(arrives, 1.0), length * vec4f(emission_of(at, flags), 1.0));
    }
    if (flags & EMITS) != 0u {
        // Emission sinks in from where such cells end.
        let dark = vec4u((beside(slot) & vec4u(EMITS | BEYOND)) == vec4u(0u));
        let length = sqrt(f32(dot(dark, vec4u(1u))));
        return Sums(vec4f(0.0), length * vec4f(emission_of(at, flags), 1.0));
    }
    return Sums();
}

// Weights of the coarse cells around a fine one, along an axis.
fn weights(x: u32) -> vec3f {
    let even = 2.0 * vec3f(KERNEL_1, KERNEL_2, KERNEL_0);
    return select(even, even.zyx, (x & 1u) != 0u);
}

// The first cell of a level, if it is not clamped, that the workgroup's cells are interpolated from.
fn region(number: u32, first_cell: vec2u) -> vec2i {
    var first = vec2i(first_cell);
    for (var k = 0u; k < number; k++) {
        first = (first >> vec2u(1u)) - 1;
    }
    return first;
}

// Cells along a side of the region of a level.
fn region_side(number: u32) -> u32 {
    var side = REGION;
    for (var k = 1u; k < number; k++) {
        side = side / 2u + 3u;
    }
    return side;
}

// The sums of a level, whose region is held, interpolated at a cell of the finer one.
fn interpolated(number: u32, first_cell: vec2u, at: vec2i) -> Sums {
    let columns = weights(u32(at.x));
    let rows = weights(u32(at.y));
    let side = region_side(number);
    let near = vec2u((at >> vec2u(1u)) - 1 - region(number, first_cell));
    var sum = Sums();
    for (var y = 0u; y < 3u; y++) {
        for (var x = 0u; x < 3u; x++) {
            let i = (near.y + y) * side + near.x + x;
            sum.irradiance += columns[x] * rows[y] * coarse_irradiance[i];
            sum.emission += columns[x] * rows[y] * coarse_emission[i];
        }
    }
    return sum;
}

// The mean of a sum, faded by the depth that follows from its weight.
fn faded(sum: vec4f) -> vec3f {
    let end = frame.wall_depth + 1.0;
    if sum.w * (end * end + SOFTENING) <= STRAIGHT {
        return vec3f(0.0);
    }
    // Cells without a face lie at least 1 px behind one.
    let behind = sqrt(max(STRAIGHT / sum.w - SOFTENING, 1.0));
    let left = max(1.0 - behind / end, 0.0);
    return sum.rgb * (left * left * (3.0 - 2.0 * left) / sum.w);
}

// How much of another cell counts: a depth below 1 px leaves cells more to themselves.
fn shared_by_faces() -> f32 {
    return min(frame.wall_depth, 1.0);
}

// The mean light of a cell with a face and those nearby that face the same way.
fn along_surface(at: vec2u, flags: u32) -> vec3f {
    let along = vec3f(ALONG_0, ALONG_1, ALONG_2);
    var sum = vec4f(0.0);
    for (var y = -2; y <= 2; y++) {
        for (var x = -2; x <= 2; x++) {
            let other = vec2i(at) + vec2i(x, y);
            if !inside(other) {
                continue;
            }
            let other_flags = flags_at(vec2u(other));
            if (flags & other_flags & SIDES) != 0u {
                let share = select(shared_by_faces(), 1.0, x == 0 && y == 0);
                let sides = f32(countOneBits(other_flags & SIDES));
                let weight = sides * along[abs(x)] * along[abs(y)] * share;
                sum += weight * vec4f(surface[index(vec2u(other))].rgb, 1.0);
            }
        }
    }
    return sum.rgb / sum.w;
}

// Gives the faces of solid cells the first moment before them, scaled to their own light.
@compute @workgroup_size(8, 8)
fn turn_faces(@builtin(global_invocation_id) id: vec3u) {
    let at = vec2i(id.xy);
    if outside(id.xy) || !solid(at) {
        return;
    }
    var direction = vec2f(0.0);
    var count = 0.0;
    for (var side = 0u; side < 4u; side++) {
        if open(at + normal(side)) {
            let before = index(vec2u(at + normal(side)));
            let x = luminance(light[moment_index(0u, before)].rgb);
            let y = luminance(light[moment_index(1u, before)].rgb);
            direction += vec2f(x, y) / max(luminance(light[before].rgb), 1.17549435e-38);
            count += 1.0;
        }
    }
    let i = index(id.xy);
    let arrives = light[i].rgb / max(count, 1.0);
    light[moment_index(0u, i)] = vec4f(arrives * direction.x, 1.0);
    light[moment_index(1u, i)] = vec4f(arrives * direction.y, 1.0);
}

// The light of solid cells where nothing sinks in.
@compute @workgroup_size(8, 8)
fn show_faces(@builtin(global_invocation_id) id: vec3u) {
    let at = vec2i(id.xy);
    if outside(id.xy) || !solid(at) {
        return;
    }
    let exposed = open(at - vec2i(1, 0)) || open(at + vec2i(1, 0))
        || open(at - vec2i(0, 1)) || open(at + vec2i(0, 1));
    let i = value_index(index(id.xy));
    let arrives = select(vec3f(0.0), light[i].rgb, exposed);
    light[i] = vec4f(arrives + emission_of(id.xy, EMITS), 1.0);
}

// Weights of the fine cells around a coarse one.
fn kernel(x: u32, y: u32) -> f32 {
    let along = array(KERNEL_0, KERNEL_1, KERNEL_2, KERNEL_2, KERNEL_1, KERNEL_0);
    return along[x] * along[y];
}

// The number of levels, as `octaves` in the library's `walls.rs`.
fn octaves() -> u32 {
    var doublings = 0u;
    while f32(1u << doublings) < min(frame.wall_depth, MAX_WALL_DEPTH) + 1.0 {
        doublings++;
    }
    return doublings + 2u;
}

// The sums of a cell of a level, from the finer one, which is stored.
fn blurred(finer: Level, id: vec2i) -> Sums {
    let last = vec2i(finer.size) - 1;
    var sum = Sums();
    for (var y = 0u; y < 6u; y++) {
        for (var x = 0u; x < 6u; x++) {
            let at = clamp(2 * id + vec2i(vec2u(x, y)) - 2, vec2i(0), last);
            let i = level_index(finer, vec2u(at));
            sum.irradiance += kernel(x, y) * irradiance[i];
            sum.emission += kernel(x, y) * sunk_emission[i];
        }
    }
    return sum;
}

// The sums of a cell of the first level, from the held flags, the first of which is that of `first`.
fn blurred_cells(first: vec2i, id: vec2i) -> Sums {
    let near = vec2u(2 * id - 2 - first);
    var any_near = 0u;
    for (var y = 0u; y < 6u; y++) {
        for (var x = 0u; x < 6u; x++) {
            any_near |= held_flags[(near.y + y) * CELLS + near.x + x];
        }
    }
    // Away from walls there is nothing to add.
    let rows = select(0u, 6u, (any_near & SOLID) != 0u);
    let last = vec2i(frame.size) - 1;
    var sum = Sums();
    for (var y = 0u; y < rows; y++) {
        for (var x = 0u; x < 6u; x++) {
            let at = clamp(2 * id + vec2i(vec2u(x, y)) - 2, vec2i(0), last);
            let slot = vec2u(at - first);
            let there = sums_of_cell(vec2u(at), slot.y * CELLS + slot.x);
            sum.irradiance += kernel(x, y) * there.irradiance;
            sum.emission += kernel(x, y) * there.emission;
        }
    }
    return sum;
}

fn store(level: Level, id: vec2u, sums: Sums) {
    let i = level_index(level, id);
    irradiance[i] = sums.irradiance;
    sunk_emission[i] = sums.emission;
}

// The first cell of the level between that a workgroup holds.
fn first_between(tile: vec2u) -> vec2i {
    return 2 * vec2i(TILE * tile) - 2;
}

// The cell of the level between that is held at a slot. It may lie beyond the level.
fn cell_between(tile: vec2u, slot: u32) -> vec2i {
    return first_between(tile) + vec2i(vec2u(slot % BETWEEN, slot / BETWEEN));
}

// Holds the sums of a cell of the level between, and stores them if the tile covers it.
fn keep_between(level: Level, tile: vec2u, slot: u32, sums: Sums) {
    held_irradiance[slot] = sums.irradiance;
    held_emission[slot] = sums.emission;
    let id = vec2u(cell_between(tile, slot));
    if all(id / (2u * TILE) == tile) && all(id < level.size) {
        store(level, id, sums);
    }
}

// Makes the tile of a level from the one between.
fn make_tile(between: Level, level: Level, tile: vec2u, lane: u32) {
    for (var slot = lane; slot < TILE * TILE; slot += LANES) {
        let id = TILE * tile + vec2u(slot % TILE, slot / TILE);
        if any(id >= level.size) {
            continue;
        }
        var sum = Sums();
        for (var y = 0u; y < 6u; y++) {
            for (var x = 0u; x < 6u; x++) {
                let at = 2 * vec2i(id) + vec2i(vec2u(x, y)) - 2;
                let held = vec2u(clamp(at, vec2i(0), vec2i(between.size) - 1) - first_between(tile));
                let i = held.y * BETWEEN + held.x;
                sum.irradiance += kernel(x, y) * held_irradiance[i];
                sum.emission += kernel(x, y) * held_emission[i];
            }
        }
        store(level, id, sum);
    }
}

// Keeps the flags of the cells that the tile covers, and the light of those with a face.
fn keep_surface(first: vec2u, lane: u32) {
    let words = COVERED / CELLS_PER_WORD;
    for (var i = lane; i < words * COVERED; i += LANES) {
        let own = vec2u(CELLS_PER_WORD * (i % words), i / words);
        let at = first + own;
        if outside(at) {
            continue;
        }
        var word = 0u;
        for (var k = 0u; k < CELLS_PER_WORD; k++) {
            let flags = flags_of((own.y + BESIDE) * CELLS + own.x + k + BESIDE);
            word |= flags << flag_shift(k);
            if (flags & SIDES) != 0u {
                let cell = index(at + vec2u(k, 0u));
                surface[cell] = light[value_index(cell)];
            }
        }
        cell_flags[at.y * flag_words() + at.x / CELLS_PER_WORD] = word;
    }
}

// Finds the surface, and makes the first two levels.
@compute @workgroup_size(LANES)
fn blur_surface(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let first = COVERED * tile.xy;
    let first_held = vec2i(first) - vec2i(vec2u(BESIDE));
    for (var i = lane; i < CELLS * CELLS; i += LANES) {
        held_flags[i] = own_flags(first_held + vec2i(vec2u(i % CELLS, i / CELLS)));
    }
    workgroupBarrier();
    keep_surface(first, lane);
    let level = find_level(1u);
    for (var slot = lane; slot < BETWEEN * BETWEEN; slot += LANES) {
        keep_between(level, tile.xy, slot, blurred_cells(first_held, cell_between(tile.xy, slot)));
    }
    workgroupBarrier();
    make_tile(level, find_level(2u), tile.xy, lane);
}

// Makes two levels, the first of which is `step`, from the finer one.
@compute @workgroup_size(LANES)
fn blur(@builtin(workgroup_id) tile: vec3u, @builtin(local_invocation_index) lane: u32) {
    let level = find_level(step);
    let finer = find_level(step - 1u);
    for (var slot = lane; slot < BETWEEN * BETWEEN; slot += LANES) {
        keep_between(level, tile.xy, slot, blurred(finer, cell_between(tile.xy, slot)));
    }
    workgroupBarrier();
    make_tile(level, find_level(step + 1u), tile.xy, lane);
}

// The flags of all cells in a row of a workgroup in which light sinks in, and 0 beyond the grid.
fn flags_of_row(first: vec2u) -> u32 {
    var flags = 0u;
    for (var x = 0u; x < SUNK; x += CELLS_PER_WORD) {
        let at = first + vec2u(x, 0u);
        if !outside(at) {
            flags |= cell_flags[at.y * flag_words() + at.x / CELLS_PER_WORD];
        }
    }
    return flags;
}

// Adds each level to the finer one, around the workgroup's cells, and lets the sum sink into them. If the number of
// levels is odd, the coarsest is not stored.
@compute @workgroup_size(SUNK, SUNK)
fn sink(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let first_cell = SUNK * tile.xy;
    if lane < SUNK {
        row_flags[lane] = flags_of_row(first_cell + vec2u(0u, lane));
    }
    workgroupBarrier();
    if lane == 0u {
        var flags = 0u;
        for (var row = 0u; row < SUNK; row++) {
            flags |= row_flags[row];
        }
        any_flags[0] = flags;
    }
    if workgroupUniformLoad(&any_flags[0]) == 0u {
        return;
    }
    let count = octaves();
    for (var number = count; number > 0u; number--) {
        let level = find_level(number);
        let side = region_side(number);
        // Lanes make at most one cell each. Loops let a software GPU pass over idle lanes.
        let cells = side * side;
        var sums = Sums();
        for (var slot = lane; slot < cells; slot += SUNK * SUNK) {
            let unclamped = region(number, first_cell) + vec2i(vec2u(slot % side, slot / side));
            let at = clamp(unclamped, vec2i(0), vec2i(level.size) - 1);
            if number == count && (count & 1u) != 0u {
                sums = blurred(find_level(number - 1u), at);
            } else {
                let own = level_index(level, vec2u(at));
                sums = Sums(irradiance[own], sunk_emission[own]);
            }
            if number < count {
                let coarser = interpolated(number + 1u, first_cell, at);
                sums.irradiance += OCTAVE * coarser.irradiance;
                sums.emission += OCTAVE * coarser.emission;
            }
        }
        workgroupBarrier();
        if lane < cells {
            coarse_irradiance[lane] = sums.irradiance;
            coarse_emission[lane] = sums.emission;
        }
        workgroupBarrier();
    }
    // This asks the matter, not the flags: where a shader reads `emission` but not the matter, which is bound before it,
    // Mesa's software GPU (22.3) keeps a new variant of it in every frame.
    if outside(id.xy) || !solid(vec2i(id.xy)) {
        return;
    }
    let flags = flags_at(id.xy);
    var arrives: vec3f;
    var glow: vec3f;
    let sum = interpolated(1u, first_cell, vec2i(id.xy));
    if (flags & SIDES) == 0u {
        arrives = faded(sum.irradiance);
        glow = faded(sum.emission);
    } else {
        arrives = along_surface(id.xy, flags);
        glow = shared_by_faces() * sum.emission.rgb / sum.emission.w;
    }
    light[value_index(index(id.xy))] = vec4f(arrives + max(emission_of(id.xy, flags), glow), 1.0);
}
