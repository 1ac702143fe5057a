// The light that solid cells show: it sinks in from their faces, and emission shows on top. The library's
// `walls.rs` derives it, and its `pyramid.rs` the blurs.

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

// The flag of solid cells beside those of their open sides: left, right, upper, lower.
const SOLID: u32 = 16u;

// The level of the pyramid; the cells are level 0.
@group(0) @binding(2) var<uniform> step: u32;
@group(0) @binding(3) var emission: texture_2d<f32>;
// The light of faces, and the open sides of solid cells; 0 in other cells.
@group(0) @binding(4) var<storage, read_write> surface: array<vec4f>;
// All levels from 1 on: irradiance and its weight.
@group(0) @binding(5) var<storage, read_write> irradiance: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> sunk_emission: array<vec4f>;
@group(0) @binding(7) var<storage, read_write> light: array<vec4f>;

struct Sums {
    irradiance: vec4f,
    emission: vec4f,
}

fn open(at: vec2i) -> bool {
    return inside(at) && !solid(at);
}

fn level_size(level: u32) -> vec2u {
    return (frame.size + (1u << level) - 1u) >> vec2u(level);
}

fn level_index(level: u32, at: vec2u) -> u32 {
    var start = 0u;
    for (var finer = 1u; finer < level; finer++) {
        let size = level_size(finer);
        start += size.x * size.y;
    }
    return start + at.y * level_size(level).x + at.x;
}

fn emits(at: vec2i) -> bool {
    return any(textureLoad(emission, at, 0).rgb != vec3f(0.0));
}

// The number of sides of a cell that emits, inside a wall, towards cells that do not.
fn sides_of_glow(at: vec2i) -> u32 {
    if !emits(at) {
        return 0u;
    }
    let offsets = array(vec2i(-1, 0), vec2i(1, 0), vec2i(0, -1), vec2i(0, 1));
    var count = 0u;
    for (var side = 0u; side < 4u; side++) {
        let beside = at + offsets[side];
        count += select(0u, 1u, inside(beside) && !emits(beside));
    }
    return count;
}

// The sums of one cell of the grid.
fn sums_of_cell(at: vec2u) -> Sums {
    let here = surface[index(at)];
    let sides = u32(here.w);
    if sides == 0u {
        return Sums();
    }
    let own = textureLoad(emission, at, 0).rgb;
    if sides == SOLID {
        let length = sqrt(f32(sides_of_glow(vec2i(at))));
        return Sums(vec4f(0.0), length * vec4f(own, 1.0));
    }
    let length = sqrt(f32(countOneBits(sides & ~SOLID)));
    return Sums(length * vec4f(here.rgb, 1.0), length * vec4f(own, 1.0));
}

fn sums_at(level: u32, at: vec2u) -> Sums {
    if level == 0u {
        return sums_of_cell(at);
    }
    let i = level_index(level, at);
    return Sums(irradiance[i], sunk_emission[i]);
}

// Weights of the coarse cells around a fine one, along an axis.
fn weights(x: u32) -> vec3f {
    let even = 2.0 * vec3f(KERNEL_1, KERNEL_2, KERNEL_0);
    return select(even, even.zyx, (x & 1u) != 0u);
}

// The sums of a level, interpolated at a cell of the finer one.
fn interpolated(level: u32, at: vec2u) -> Sums {
    let last = vec2i(level_size(level)) - 1;
    let columns = weights(at.x);
    let rows = weights(at.y);
    var sum = Sums();
    for (var y = 0; y < 3; y++) {
        for (var x = 0; x < 3; x++) {
            let coarse = clamp(vec2i(at / 2u) + vec2i(x, y) - 1, vec2i(0), last);
            let there = sums_at(level, vec2u(coarse));
            sum.irradiance += columns[x] * rows[y] * there.irradiance;
            sum.emission += columns[x] * rows[y] * there.emission;
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

// The means over a cell with a face and those nearby that face the same way. A depth below 1 px leaves the cell
// more to itself.
fn along_surface(at: vec2u, sides: u32) -> Sums {
    let along = vec3f(ALONG_0, ALONG_1, ALONG_2);
    var sum = Sums();
    for (var y = -2; y <= 2; y++) {
        for (var x = -2; x <= 2; x++) {
            let other = vec2i(at) + vec2i(x, y);
            if !inside(other) {
                continue;
            }
            let there = surface[index(vec2u(other))];
            let other_sides = u32(there.w) & ~SOLID;
            if (sides & other_sides) != 0u {
                let share = select(min(frame.wall_depth, 1.0), 1.0, x == 0 && y == 0);
                let weight = f32(countOneBits(other_sides)) * along[abs(x)] * along[abs(y)] * share;
                sum.irradiance += weight * vec4f(there.rgb, 1.0);
                sum.emission += weight * vec4f(textureLoad(emission, other, 0).rgb, 1.0);
            }
        }
    }
    return sum;
}

@compute @workgroup_size(8, 8)
fn find_sides(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let at = vec2i(id.xy);
    var sides = 0u;
    if solid(at) {
        sides = SOLID
            | select(0u, 1u, open(at - vec2i(1, 0))) | select(0u, 2u, open(at + vec2i(1, 0)))
            | select(0u, 4u, open(at - vec2i(0, 1))) | select(0u, 8u, open(at + vec2i(0, 1)));
    }
    surface[index(id.xy)] = vec4f(light[index(id.xy)].rgb, f32(sides));
}

// Makes a level from the finer one.
@compute @workgroup_size(8, 8)
fn blur(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= level_size(step)) {
        return;
    }
    let last = vec2i(level_size(step - 1u)) - 1;
    let kernel = array(KERNEL_0, KERNEL_1, KERNEL_2, KERNEL_2, KERNEL_1, KERNEL_0);
    var sum = Sums();
    for (var y = 0; y < 6; y++) {
        for (var x = 0; x < 6; x++) {
            let finer = clamp(2 * vec2i(id.xy) + vec2i(x, y) - 2, vec2i(0), last);
            let there = sums_at(step - 1u, vec2u(finer));
            sum.irradiance += kernel[x] * kernel[y] * there.irradiance;
            sum.emission += kernel[x] * kernel[y] * there.emission;
        }
    }
    let i = level_index(step, id.xy);
    irradiance[i] = sum.irradiance;
    sunk_emission[i] = sum.emission;
}

// Adds the coarser levels to a level.
@compute @workgroup_size(8, 8)
fn add_coarser(@builtin(global_invocation_id) id: vec3u) {
    if any(id.xy >= level_size(step)) {
        return;
    }
    let coarser = interpolated(step + 1u, id.xy);
    let i = level_index(step, id.xy);
    irradiance[i] += OCTAVE * coarser.irradiance;
    sunk_emission[i] += OCTAVE * coarser.emission;
}

@compute @workgroup_size(8, 8)
fn sink(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    let sides = u32(surface[i].w);
    if sides == 0u {
        return;
    }
    var arrives = vec3f(0.0);
    var glow = vec3f(0.0);
    if sides != SOLID {
        let sum = along_surface(id.xy, sides);
        arrives = sum.irradiance.rgb / sum.irradiance.w;
        glow = sum.emission.rgb / sum.emission.w;
    } else if frame.wall_depth > 0.0 {
        let sum = interpolated(1u, id.xy);
        arrives = faded(sum.irradiance);
        glow = faded(sum.emission);
    }
    light[i] = vec4f(arrives + max(textureLoad(emission, id.xy, 0).rgb, glow), 1.0);
}
