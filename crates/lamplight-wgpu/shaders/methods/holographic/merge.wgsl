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
#import methods/holographic/quadrant
#import methods/holographic/sky

// Cones that a thread makes, one after another.
override RUN: u32;

@group(0) @binding(2) var<storage, read> cones: array<vec4f>;
@group(0) @binding(3) var<storage, read> intervals: array<vec2u>;
@group(0) @binding(4) var<storage, read> tints: array<u32>;
@group(0) @binding(5) var<storage, read_write> radiance: array<vec2u>;

// The ray that stands for one that may lie beyond an edge of the quadrant, where none are made.
fn made(ray: i32) -> i32 {
    return clamp(ray, 0, 2i << sweep.level);
}

// The interval along a ray from a row of the plane p. A plane of even index is a plane of the level above: nothing
// lies between.
fn near(p: u32, ray: i32, row: u32) -> Interval {
    if (p & 1u) == 0u {
        return nothing();
    }
    let rays = (2u << sweep.level) + 1u;
    let slot = p / 2u - sweep.odd_first.x;
    return unpack(fetch_words(sweep.odd.x + (slot * rays + u32(made(ray))) * sweep.rows + row));
}

// The light of a cone, or of a half, of the level above.
fn far(plane: u32, cone: u32, row: i32) -> vec3f {
    if row < 0 || row >= i32(sweep.rows) || plane >= planes(sweep.level + 1u) {
        return sky_in(cone);
    }
    let slot = (sweep.far - plane) * cone_count(sweep.level + 1u) + cone;
    return unpack_rgb(radiance[sweep.above + slot * sweep.rows + u32(row)]);
}

// The light that arrives through part of a cone of the level above: along a ray, from the plane that it leads to.
fn along(p: u32, ray: i32, row: u32, cone: u32, interval: Interval) -> vec3f {
    let rows = select(0i, made(ray) - (1i << sweep.level), (p & 1u) == 1u);
    let behind = far((p + 1u) / 2u, cone, i32(row) + rows);
    var light = interval.transmittance * behind;
    if (p & 1u) == 1u {
        light += interval.light * cones[sweep.cones_above + cone].x;
    }
    return light;
}

// The light of a cone; none of the outermost. `low` and `high` are the intervals along the rays beside it.
fn light_of(p: u32, cone: i32, row: u32, low: Interval, high: Interval) -> vec3f {
    if cone <= 0 || cone + 1 >= i32(cone_count(sweep.level)) {
        return vec3f(0.0);
    }
    let half = u32(2 * cone - 2);
    let ray = cone - BEYOND;
    return along(p, ray, row, half, low) + along(p, ray + 1, row, half + 1u, high);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let z = select_quadrant(id.z);
    let row = id.x;
    let p = sweep.first + z;
    let count = i32(cone_count(sweep.level));
    if row >= sweep.rows || z >= sweep.planes || i32(id.y * RUN) >= count {
        return;
    }
    let plane = sweep.below + (sweep.below_far - p) * u32(count) * sweep.rows + row;
    // Halves take light from a cone to each side.
    let beside = i32(sweep.halves);
    let first = i32(id.y * RUN);
    let end = min(first + i32(RUN), count);
    var high = near(p, first - beside - BEYOND, row);
    var before = vec3f(0.0);
    var own = vec3f(0.0);
    for (var cone = first - beside; cone < end + beside; cone++) {
        let low = high;
        high = near(p, cone - BEYOND + 1, row);
        let after = light_of(p, cone, row, low, high);
        if cone - beside >= first {
            let half = 0.5 * own + 0.25 * (before + after);
            let at = plane + u32(cone - beside) * sweep.rows;
            radiance[at] = pack_rgb(select(after, half, sweep.halves == 1u));
        }
        before = own;
        own = after;
    }
}

// The level that pixels gather from, on planes of odd index: its cones are half as wide, those of the level
// above. The middle of each lies at a quarter between the rays on both sides of it; two cones share these.
@compute @workgroup_size(64)
fn finish(@builtin(global_invocation_id) id: vec3u) {
    let z = select_quadrant(id.z);
    let row = id.x;
    let p = 2u * (sweep.first + z) - 1u;
    if row >= sweep.rows || z >= sweep.planes || p >= planes(sweep.level) {
        return;
    }
    let count = cone_count(sweep.level + 1u);
    let plane = sweep.below + (sweep.below_far - p) / 2u * count * sweep.rows + row;
    let ray = i32(id.y) - BEYOND / 2;
    let low = near(p, ray, row);
    let high = near(p, ray + 1, row);
    // The outermost cones have no light.
    for (var cone = max(2u * id.y, 1u); cone < min(2u * id.y + 2u, count - 1u); cone++) {
        let weight = select(0.25, 0.75, (cone & 1u) == 0u);
        let light = weight * along(p, ray, row, cone, low) + (1.0 - weight) * along(p, ray + 1, row, cone, high);
        radiance[plane + cone * sweep.rows] = pack_rgb(light);
    }
}
