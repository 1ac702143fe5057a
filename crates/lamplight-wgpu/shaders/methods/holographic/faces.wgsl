// The faces of solid cells, and media: `scatter` turns irradiance into scattered radiance (`scatter_compared`
// also measures the change), `show` shows the mean over its faces on each solid cell.

#import methods/holographic/packed_rgb
#import shared/change
#import shared/solid
#import shared/uniforms

// Bits of cells, as slabs.wgsl makes them.
override MATTER: u32;
override MEDIUM: u32;
// True if the scattered radiance is kept for the next frame, with a mark of each medium.
override MARKS: bool = false;

@group(0) @binding(2) var albedo: texture_2d<f32>;
@group(0) @binding(3) var<storage, read> irradiance: array<vec2u>;
// Direct light of lamps and suns: E/2 of faces, J of media; a single value if there is none.
@group(0) @binding(4) var<storage, read> direct: array<vec4f>;
@group(0) @binding(5) var<storage, read_write> scattered: array<vec2u>;
@group(0) @binding(6) var<storage, read_write> light: array<vec4f>;
// The bits of cells; those of the axis along x, column by column, come first.
@group(0) @binding(7) var<storage, read> cell_bits: array<u32>;
// Bound if light bounces until it has converged.
@group(0) @binding(8) var<storage, read_write> changes: array<Change>;
@group(0) @binding(9) var<uniform> step: u32;

// The light that a face scatters, E/2, or a medium with its first face; in `w` 1 if it exists.
fn incoming(at: vec2u, face: u32, tint_opacity: vec4f) -> vec4f {
    let slot = 4u * index(at) + face;
    if tint_opacity.a >= 1.0 {
        if exposed(at, face) {
            return vec4f(0.5 * unpack_rgb(irradiance[slot]), 1.0);
        }
    } else if face == 0u && any(tint_opacity != vec4f(1.0, 1.0, 1.0, 0.0)) {
        return vec4f(unpack_rgb(irradiance[slot]), 1.0);
    }
    return vec4f(0.0);
}

// What a face, or a medium, scatters.
fn scattered_by(at: vec2u, face: u32, own_albedo: vec3f, gathered: vec3f) -> vec3f {
    if arrayLength(&direct) == 1u {
        return own_albedo * gathered;
    }
    // Lamps take no more light than there is.
    return own_albedo * max(gathered + direct[4u * index(at) + face].rgb, vec3f(0.0));
}

@compute @workgroup_size(8, 8)
fn scatter(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let own_albedo = textureLoad(albedo, id.xy, 0).rgb;
    let tint_opacity = textureLoad(matter, id.xy, 0);
    for (var face = 0u; face < 4u; face++) {
        let gathered = incoming(id.xy, face, tint_opacity).rgb;
        let radiance = scattered_by(id.xy, face, own_albedo, gathered);
        scattered[4u * index(id.xy) + face] = pack_rgb(radiance);
    }
    if MARKS && tint_opacity.a < 1.0 {
        scattered[4u * index(id.xy) + 1u] = KEPT_MEDIUM;
    }
}

// Both sides of the comparison are read as they are stored, so that what stays the same is no change, however
// bright it is.
@compute @workgroup_size(SIDE, SIDE)
fn scatter_compared(thread: TileThread) {
    let id = thread.id;
    var own: Change;
    if !outside(id.xy) {
        let own_albedo = textureLoad(albedo, id.xy, 0).rgb;
        let scatters = any(own_albedo != vec3f(0.0));
        let tint_opacity = textureLoad(matter, id.xy, 0);
        for (var face = 0u; face < 4u; face++) {
            let slot = 4u * index(id.xy) + face;
            let light = incoming(id.xy, face, tint_opacity);
            let now = pack_rgb(scattered_by(id.xy, face, own_albedo, light.rgb));
            // Before the first bounce there is no scattered radiance.
            let old = select(scattered[slot], vec2u(0u), step == 0u);
            scattered[slot] = now;
            if scatters && light.w > 0.0 {
                own = both(own, change_of(unpack_rgb(old), unpack_rgb(now)));
            }
        }
    }
    let all = over_group(own, thread.lane);
    if thread.lane == 0u {
        changes[tile_index(thread.tile)] = all;
    }
}

// Returns whether a cell has a bit, 32 of which take less to read than a texel.
fn is(bit: u32, at: vec2u) -> bool {
    let words = (frame.size.y + 31u) / 32u;
    return ((cell_bits[(bit * frame.size.x + at.x) * words + at.y / 32u] >> (at.y % 32u)) & 1u) == 1u;
}

@compute @workgroup_size(8, 8)
fn show(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) || !is(MATTER, id.xy) || is(MEDIUM, id.xy) {
        return;
    }
    var sum = vec4f(0.0);
    for (var face = 0u; face < 4u; face++) {
        sum += incoming(id.xy, face, vec4f(1.0));
    }
    light[index(id.xy)] = vec4f(sum.rgb / max(sum.a, 1.0), 1.0);
}
