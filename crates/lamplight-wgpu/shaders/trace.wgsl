// The first level of intervals: beams, each the mean of parallel rays, from every row of the planes
// that lie 2^level slabs apart.

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
    // A beam: a mask of two words a slab, then where each ray's crossings begin and their number.
    let masks = 2u * (length + 1u);
    let size = masks + 2u * sweep.rays;
    for (var ray = local.y; ray < rays; ray += 4u) {
        let beam = sweep.ways + ray * size;
        var met = nothing();
        if !empty && any_of(MATTER, local.x, beam, length + 1u) {
            met = Interval(vec3f(0.0), vec3f(0.0));
            for (var i = 0u; i < sweep.rays; i++) {
                let way = beam + masks + 2u * i;
                let one = march(slab, row, local.x, ways[way], ways[way + 1u]);
                met.light += one.light;
                met.through += one.through;
            }
            met.light /= f32(sweep.rays);
            met.through /= f32(sweep.rays);
        }
        let words = pack(met);
        let at = base + (place * rays + ray) * WORDS * sweep.rows + row;
        intervals[at] = words.x;
        intervals[at + sweep.rows] = words.y;
        if WORDS == 3u {
            intervals[at + 2u * sweep.rows] = words.z;
        }
    }
}
