// Traces the first level of intervals: bundles, each the mean of parallel rays, from every row of the planes
// that lie 2^level slabs apart, and filters the light of small sources across rows (prefilter.wgsl).

#import methods/holographic/footprint
#import methods/holographic/prefilter
#import methods/holographic/store_interval

// Rows that a workgroup stores. It traces one more to each side.
const STORED: u32 = TILE - 2u;

@group(0) @binding(7) var<storage, read_write> intervals: array<vec2u>;
@group(0) @binding(8) var<storage, read_write> tints: array<u32>;

// By lane.
var<workgroup> traced: array<Traced, 4u * TILE>;

// The interval of a bundle from a lane's row.
fn bundle_of(bundle: u32, slab: u32, row: u32, lane: u32, length: u32) -> Interval {
    // The footprint of a bundle: a mask of two words per slab, then the first crossing of each ray and the
    // number of its crossings.
    let masks = 2u * (length + 1u);
    if !any_of(OCCUPIED, lane, bundle, length + 1u) {
        return nothing();
    }
    var sum = Interval(vec3f(0.0), vec3f(0.0));
    for (var i = 0u; i < sweep.rays; i++) {
        let footprint = bundle + masks + 2u * i;
        let one = march(slab, row, lane, footprints[footprint], footprints[footprint + 1u]);
        sum.light += one.light;
        sum.transmittance += one.transmittance;
    }
    return Interval(sum.light / f32(sweep.rays), sum.transmittance / f32(sweep.rays));
}

@compute @workgroup_size(64, 4)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(local_invocation_index) index: u32,
) {
    let plane = sweep.first + group.y;
    let length = 1u << sweep.level;
    let slab = plane << sweep.level;
    let first_row = i32(STORED * group.x) - 1;
    fetch(index, 4u * TILE, slab, first_row, length);
    workgroupBarrier();
    let empty = atomicLoad(&any_near) == 0u;
    let row = first_row + i32(local.x);
    let inside = row >= 0 && row < i32(sweep.rows);
    let stores = inside && local.x > 0u && local.x <= STORED;
    let is_open = inside && !is_solid(local.x, 0, 0);
    let rays = 2u * length + 1u;
    let odd = (plane & 1u) == 1u;
    let place = select(plane / 2u - sweep.even_first, plane / 2u - sweep.odd_first.x, odd);
    let base = select(sweep.even, sweep.odd.x, odd);
    let size = 2u * (length + 1u) + 2u * sweep.rays;
    for (var first = 0u; first < rays; first += 4u) {
        let ray = first + local.y;
        let bundle = sweep.footprints + ray * size;
        var words = pack(nothing());
        var small = false;
        if inside && ray < rays && !empty {
            words = pack(bundle_of(bundle, slab, u32(row), local.x, length));
            small = any_of(SMALL, local.x, bundle, length + 1u);
        }
        let own = Traced(words.xy, is_open, small);
        traced[index] = own;
        workgroupBarrier();
        if stores && ray < rays {
            let light = gained(own, traced[index - 1u]) + gained(own, traced[index + 1u]);
            if any(light != vec3f(0.0)) {
                var interval = unpack(words);
                interval.light += light;
                words = pack(interval);
            }
            store_words(base + (place * rays + ray) * sweep.rows + u32(row), words);
        }
        workgroupBarrier();
    }
}
