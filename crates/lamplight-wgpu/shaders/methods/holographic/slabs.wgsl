// The cells as quadrants read them: five bits per cell, slab by slab along both axes, 32 rows per word. The
// irradiance that matter has from the gather before is cleared.

#import methods/holographic/packed_rgb
#import methods/holographic/quadrant
#import shared/uniforms

// The bits: anything but empty space; a medium; emission, or scattered radiance; a small source;
// emission.
override OCCUPIED: u32;
override MEDIUM: u32;
override EMITTING: u32;
override SMALL: u32;
override PRIMARY: u32;

@group(0) @binding(2) var emission: texture_2d<f32>;
@group(0) @binding(3) var matter: texture_2d<f32>;
@group(0) @binding(4) var<storage, read> scattered: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> cell_bits: array<u32>;
@group(0) @binding(6) var<storage, read_write> irradiance: array<vec2u>;

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

// Returns whether at most two cells in a row emit with this one, or six if points lie 2 px apart; `step` leads from one to
// the next.
fn is_thin(at: vec2i, step: vec2i) -> bool {
    var left = (4i << sweep.spacing_level) - 3;
    for (var side = -1; side < 2 && left >= 0; side += 2) {
        for (var i = 1; left >= 0 && is_emitting(at + side * i * step); i++) {
            left--;
        }
    }
    return left >= 0;
}

// Returns whether a cell that emits is a source so wide and high at most, with nothing solid around it.
fn is_small(at: vec2u) -> bool {
    let cell = vec2i(at);
    return is_alone(at) && is_thin(cell, vec2i(1, 0)) && is_thin(cell, vec2i(0, 1));
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

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    select_quadrant(id.z);
    let slab = id.x;
    let words = sweep.cell_words;
    if slab >= sweep.cell_depth || id.y >= words {
        return;
    }
    var bits = vec4u(0u);
    var primary = 0u;
    for (var bit = 0u; bit < 32u && 32u * id.y + bit < sweep.cell_rows; bit++) {
        let at = cell_of(slab, 32u * id.y + bit);
        let tint_opacity = textureLoad(matter, at, 0);
        if any(tint_opacity != vec4f(1.0, 1.0, 1.0, 0.0)) {
            let own = emits_itself(at);
            let emitting = own || scatters(at);
            let small = emitting && is_small(at);
            bits |= vec4u(1u, u32(tint_opacity.a < 1.0), u32(emitting), u32(small)) << vec4u(bit);
            primary |= u32(own) << bit;
            for (var face = 0u; face < 4u && sweep.axis == 0u; face++) {
                irradiance[4u * index(at) + face] = vec2u(0u);
            }
        }
    }
    let place = sweep.cell_bits + slab * words + id.y;
    cell_bits[place + OCCUPIED * sweep.cell_depth * words] = bits.x;
    cell_bits[place + MEDIUM * sweep.cell_depth * words] = bits.y;
    cell_bits[place + EMITTING * sweep.cell_depth * words] = bits.z;
    cell_bits[place + SMALL * sweep.cell_depth * words] = bits.w;
    cell_bits[place + PRIMARY * sweep.cell_depth * words] = primary;
}
