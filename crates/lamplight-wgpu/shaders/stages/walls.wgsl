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

// The flags of a solid cell: its open sides (left, right, upper, lower), that it is solid, that it emits.
const SIDES: u32 = 15u;
const SOLID: u32 = 16u;
const EMITS: u32 = 32u;
const COARSEST_LANES: u32 = 256u;

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

// The number of sides of a cell inside a wall towards cells that do not emit.
fn dark_sides(at: vec2u) -> u32 {
    let offsets = array(vec2i(-1, 0), vec2i(1, 0), vec2i(0, -1), vec2i(0, 1));
    var count = 0u;
    for (var side = 0u; side < 4u; side++) {
        let beside = vec2i(at) + offsets[side];
        if inside(beside) && (flags_at(vec2u(beside)) & EMITS) == 0u {
            count++;
        }
    }
    return count;
}

// The sums of one cell of the grid.
fn sums_of_cell(at: vec2u) -> Sums {
    let flags = flags_at(at);
    if (flags & SIDES) != 0u {
        let length = sqrt(f32(countOneBits(flags & SIDES)));
        return Sums(length * vec4f(surface[index(at)].rgb, 1.0), length * vec4f(emission_of(at, flags), 1.0));
    }
    if (flags & EMITS) != 0u {
        let length = sqrt(f32(dark_sides(at)));
        return Sums(vec4f(0.0), length * vec4f(emission_of(at, flags), 1.0));
    }
    return Sums();
}

// Weights of the coarse cells around a fine one, along an axis.
fn weights(x: u32) -> vec3f {
    let even = 2.0 * vec3f(KERNEL_1, KERNEL_2, KERNEL_0);
    return select(even, even.zyx, (x & 1u) != 0u);
}

// The sums of a level, interpolated at a cell of the finer one.
fn interpolated(level: Level, at: vec2u) -> Sums {
    let last = vec2i(level.size) - 1;
    let columns = weights(at.x);
    let rows = weights(at.y);
    var sum = Sums();
    for (var y = 0; y < 3; y++) {
        for (var x = 0; x < 3; x++) {
            let coarse = clamp(vec2i(at / 2u) + vec2i(x, y) - 1, vec2i(0), last);
            let i = level_index(level, vec2u(coarse));
            sum.irradiance += columns[x] * rows[y] * irradiance[i];
            sum.emission += columns[x] * rows[y] * sunk_emission[i];
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

// Finds the flags of the cells of a word, and keeps the light of those with a face.
@compute @workgroup_size(8, 8)
fn find_flags(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= flag_words() || id.y >= frame.size.y {
        return;
    }
    var word = 0u;
    let first = CELLS_PER_WORD * id.x;
    let end = min(first + CELLS_PER_WORD, frame.size.x);
    for (var x = first; x < end; x++) {
        let cell = vec2u(x, id.y);
        let at = vec2i(cell);
        if !solid(at) {
            continue;
        }
        let sides = select(0u, 1u, open(at - vec2i(1, 0))) | select(0u, 2u, open(at + vec2i(1, 0)))
            | select(0u, 4u, open(at - vec2i(0, 1))) | select(0u, 8u, open(at + vec2i(0, 1)));
        let emits = COMPONENT == 0u && any(textureLoad(emission, cell, 0).rgb != vec3f(0.0));
        word |= (SOLID | sides | select(0u, EMITS, emits)) << flag_shift(x);
        if sides != 0u {
            let i = index(cell);
            surface[i] = light[value_index(i)];
        }
    }
    cell_flags[id.y * flag_words() + id.x] = word;
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

// Makes a cell of a level from the finer one, of the first from the cells.
fn blur_finer(number: u32, id: vec2u) {
    let level = find_level(number);
    let finer = find_level(number - 1u);
    let last = vec2i(finer.size) - 1;
    let kernel = array(KERNEL_0, KERNEL_1, KERNEL_2, KERNEL_2, KERNEL_1, KERNEL_0);
    var sum = Sums();
    for (var y = 0; y < 6; y++) {
        for (var x = 0; x < 6; x++) {
            let at = vec2u(clamp(2 * vec2i(id) + vec2i(x, y) - 2, vec2i(0), last));
            var there: Sums;
            if number == 1u {
                there = sums_of_cell(at);
            } else {
                let i = level_index(finer, at);
                there = Sums(irradiance[i], sunk_emission[i]);
            }
            sum.irradiance += kernel[x] * kernel[y] * there.irradiance;
            sum.emission += kernel[x] * kernel[y] * there.emission;
        }
    }
    let i = level_index(level, id);
    irradiance[i] = sum.irradiance;
    sunk_emission[i] = sum.emission;
}

// Adds the coarser levels to a cell of a level.
fn add_interpolated(number: u32, id: vec2u) {
    let coarser = interpolated(find_level(number + 1u), id);
    let i = level_index(find_level(number), id);
    irradiance[i] += OCTAVE * coarser.irradiance;
    sunk_emission[i] += OCTAVE * coarser.emission;
}

@compute @workgroup_size(8, 8)
fn blur(@builtin(global_invocation_id) id: vec3u) {
    if all(id.xy < find_level(step).size) {
        blur_finer(step, id.xy);
    }
}

@compute @workgroup_size(8, 8)
fn add_coarser(@builtin(global_invocation_id) id: vec3u) {
    if all(id.xy < find_level(step).size) {
        add_interpolated(step, id.xy);
    }
}

// The number of levels, as `octaves` in the library's `walls.rs`.
fn octaves() -> u32 {
    var doublings = 0u;
    while f32(1u << doublings) < min(frame.wall_depth, MAX_WALL_DEPTH) + 1.0 {
        doublings++;
    }
    return doublings + 2u;
}

// A small level: makes all coarser ones, and adds them to it. A single workgroup does.
@compute @workgroup_size(COARSEST_LANES)
fn add_coarsest(@builtin(local_invocation_index) lane: u32) {
    let count = octaves();
    for (var number = step + 1u; number <= count; number++) {
        let size = find_level(number).size;
        for (var i = lane; i < size.x * size.y; i += COARSEST_LANES) {
            blur_finer(number, vec2u(i % size.x, i / size.x));
        }
        storageBarrier();
    }
    for (var number = count - 1u; number >= step; number--) {
        let size = find_level(number).size;
        for (var i = lane; i < size.x * size.y; i += COARSEST_LANES) {
            add_interpolated(number, vec2u(i % size.x, i / size.x));
        }
        storageBarrier();
    }
}

@compute @workgroup_size(8, 8)
fn sink(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    let flags = flags_at(id.xy);
    if flags == 0u {
        return;
    }
    var arrives: vec3f;
    var glow: vec3f;
    let sum = interpolated(find_level(1u), id.xy);
    if (flags & SIDES) == 0u {
        arrives = faded(sum.irradiance);
        glow = faded(sum.emission);
    } else {
        arrives = along_surface(id.xy, flags);
        glow = shared_by_faces() * sum.emission.rgb / sum.emission.w;
    }
    light[value_index(i)] = vec4f(arrives + max(emission_of(id.xy, flags), glow), 1.0);
}
