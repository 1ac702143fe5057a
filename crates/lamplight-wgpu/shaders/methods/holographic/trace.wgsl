// Traces the first level of intervals: bundles, each the mean of parallel rays, from every row of the planes
// that lie 2^level slabs apart.

#import methods/holographic/footprint
#import methods/holographic/interval

@group(0) @binding(7) var<storage, read_write> intervals: array<u32>;

@compute @workgroup_size(64, 4)
fn main(
    @builtin(workgroup_id) group: vec3u,
    @builtin(local_invocation_id) local: vec3u,
    @builtin(local_invocation_index) index: u32,
) {
    let plane = sweep.first + group.y;
    let length = 1u << sweep.level;
    let slab = plane << sweep.level;
    fetch(index, 4u * TILE, slab, TILE * group.x, length);
    workgroupBarrier();
    let empty = atomicLoad(&any_near) == 0u;
    let row = TILE * group.x + local.x;
    if row >= sweep.rows {
        return;
    }
    let rays = 2u * length + 1u;
    let odd = (plane & 1u) == 1u;
    let place = select(plane / 2u - sweep.even_first, plane / 2u - sweep.odd_first.x, odd);
    let base = select(sweep.even, sweep.odd.x, odd);
    // The footprint of a bundle: a mask of two words per slab, then the first crossing of each ray and the
    // number of its crossings.
    let masks = 2u * (length + 1u);
    let size = masks + 2u * sweep.rays;
    for (var ray = local.y; ray < rays; ray += 4u) {
        let bundle = sweep.footprints + ray * size;
        var sum = nothing();
        if !empty && any_of(OCCUPIED, local.x, bundle, length + 1u) {
            sum = Interval(vec3f(0.0), vec3f(0.0));
            for (var i = 0u; i < sweep.rays; i++) {
                let footprint = bundle + masks + 2u * i;
                let first = footprints[footprint];
                let one = march(slab, row, local.x, first, footprints[footprint + 1u]);
                sum.light += one.light;
                sum.transmittance += one.transmittance;
            }
            sum.light /= f32(sweep.rays);
            sum.transmittance /= f32(sweep.rays);
        }
        let words = pack(sum);
        let at = base + (place * rays + ray) * WORDS * sweep.rows + row;
        intervals[at] = words.x;
        intervals[at + sweep.rows] = words.y;
        if WORDS == 3u {
            intervals[at + 2u * sweep.rows] = words.z;
        }
    }
}
