// Merges the light of cones down from the far end of the grid, level by level (Freeman, Sannikov and Margel
// 2025). Cones overlap: the light of each is weighted by a quadratic B-spline over slope, and taken apart into
// halves, one for each of the rays beside it,
// `H_n(p, j) = ¼·R_n(p, j − 1) + ½·R_n(p, j) + ¼·R_n(p, j + 1)`. With s ∈ {0, 1}, j = 2i + s, k = i + s:
//
// planes of odd index: `R_n(p, i) = Σ_s A_{n+1}(j)·r(T_n(p, k)) + t(T_n(p, k))·H_{n+1}(p + v_n(k), j)`;
// planes of even index are planes of the level above: `R_n(p, i) = Σ_s H_{n+1}(p, j)`.
//
// crates/lamplight/src/methods/holographic/merge.rs says why.

#import methods/holographic/fetch_interval
#import methods/holographic/packed_rgb
#import methods/holographic/sky
#import methods/holographic/sweep

// Cones that a thread makes, one after another.
override RUN: u32;

@group(0) @binding(2) var<storage, read> cones: array<vec4f>;
@group(0) @binding(3) var<storage, read> intervals: array<vec2u>;
@group(0) @binding(4) var<storage, read> tints: array<u32>;
@group(0) @binding(5) var<storage, read_write> radiance: array<vec2u>;

// An interval from a row of the plane p, whose index is odd.
fn interval(p: u32, ray: u32, row: u32) -> Interval {
    let rays = (2u << sweep.level) + 1u;
    let slot = p / 2u - sweep.odd_first.x;
    return unpack(fetch_words(sweep.odd.x + (slot * rays + ray) * sweep.rows + row));
}

// The light of a cone, or of a half, of the level above.
fn far(plane: u32, cone: u32, row: i32) -> vec3f {
    if row < 0 || row >= i32(sweep.rows) || plane >= planes(sweep.level + 1u) {
        return sky_in(cone);
    }
    let slot = (sweep.far - plane) * cone_count(sweep.level + 1u) + cone;
    return unpack_rgb(radiance[sweep.above + slot * sweep.rows + u32(row)]);
}

// The light that arrives through part of a cone of the level above: along a ray, from the plane that it
// leads to.
fn along(p: u32, ray: i32, row: u32, cone: u32) -> vec3f {
    // Rays beyond the edges of the quadrant are not made; those at the edges stand for them.
    let made = clamp(ray, 0, 2i << sweep.level);
    let near = interval(p, u32(made), row);
    let behind = far((p + 1u) / 2u, cone, i32(row) + made - (1i << sweep.level));
    return near.light * cones[sweep.cones_above + cone].x + near.transmittance * behind;
}

// The light of a cone; none of the outermost.
fn light_of(p: u32, cone: u32, row: u32) -> vec3f {
    if cone == 0u || cone + 1u >= cone_count(sweep.level) {
        return vec3f(0.0);
    }
    let half = 2u * cone - 2u;
    if (p & 1u) == 0u {
        return far(p / 2u, half, i32(row)) + far(p / 2u, half + 1u, i32(row));
    }
    let ray = i32(cone) - BEYOND;
    return along(p, ray, row, half) + along(p, ray + 1, row, half + 1u);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x;
    let p = sweep.first + id.z;
    if row >= sweep.rows || p >= planes(sweep.level) {
        return;
    }
    let count = cone_count(sweep.level);
    let first = id.y * RUN;
    let plane = sweep.below + (sweep.below_far - p) * count * sweep.rows + row;
    var before = vec3f(0.0);
    if sweep.halves == 1u && first > 0u {
        before = light_of(p, first - 1u, row);
    }
    var own = light_of(p, first, row);
    for (var cone = first; cone < min(first + RUN, count); cone++) {
        let after = light_of(p, cone + 1u, row);
        let half = 0.5 * own + 0.25 * (before + after);
        radiance[plane + cone * sweep.rows] = pack_rgb(select(own, half, sweep.halves == 1u));
        before = own;
        own = after;
    }
}

// The level that pixels gather from, on planes of odd index: its cones are half as wide, those of the level
// above. The middle of each lies at a quarter between the rays on both sides of it.
@compute @workgroup_size(64)
fn finish(@builtin(global_invocation_id) id: vec3u) {
    let row = id.x;
    let p = 2u * (sweep.first + id.z) - 1u;
    if row >= sweep.rows || p >= planes(sweep.level) {
        return;
    }
    let cone = id.y + 1u;
    // Rounded down, below 0 too.
    let ray = (i32(cone) - BEYOND) >> 1u;
    let weight = select(0.25, 0.75, (cone & 1u) == 0u);
    let light = weight * along(p, ray, row, cone) + (1.0 - weight) * along(p, ray + 1, row, cone);
    let slot = (sweep.below_far - p) / 2u * cone_count(sweep.level + 1u) + cone;
    radiance[sweep.below + slot * sweep.rows + row] = pack_rgb(light);
}
