// Traces the first level of intervals: bundles, each the mean of parallel rays, from every row of the planes
// that lie 2^level slabs apart, and filters the light of small sources across rows (prefilter.wgsl).

#import methods/holographic/footprint
#import methods/holographic/prefilter
#import methods/holographic/store_interval

// Rows that a workgroup stores. It traces one more to each side.
const STORED: u32 = TILE - 2u;
// Bundles from a row.
override BUNDLES: u32;

@group(0) @binding(7) var<storage, read_write> intervals: array<vec2u>;
@group(0) @binding(8) var<storage, read_write> tints: array<u32>;

// By lane.
var<workgroup> traced: array<Traced, 4u * TILE>;
// Rows of the tile from which each bundle meets matter, and a small source.
var<workgroup> meets: array<vec4u, BUNDLES>;

// The interval of a bundle from a lane's row. Its footprint is a mask with an entry per slab, then the crossings
// of each ray.
fn bundle_of(bundle: u32, slab: u32, row: u32, lane: u32, length: u32) -> Interval {
    var sum = Interval(vec3f(0.0), vec3f(0.0));
    for (var i = 0u; i < sweep.rays; i++) {
        let one = march(slab, row, lane, footprints[bundle + length + 1u + i]);
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
    let size = length + 1u + sweep.rays;
    if index < BUNDLES {
        meets[index] = meeting(OCCUPIED, SMALL, sweep.footprints + index * size, length + 1u);
    }
    workgroupBarrier();
    let row = first_row + i32(local.x);
    let inside = row >= 0 && row < i32(sweep.rows);
    let stores = inside && local.x > 0u && local.x <= STORED;
    let is_open = inside && !is_solid(local.x, 0, 0);
    let odd = (plane & 1u) == 1u;
    let place = select(plane / 2u - sweep.even_first, plane / 2u - sweep.odd_first.x, odd);
    let base = select(sweep.even, sweep.odd.x, odd);
    for (var first = 0u; first < BUNDLES; first += 4u) {
        let ray = first + local.y;
        let bundle = sweep.footprints + ray * size;
        var words = pack(nothing());
        var small = false;
        if inside && ray < BUNDLES {
            let word = select(meets[ray].xz, meets[ray].yw, local.x >= 32u);
            let met = (word >> vec2u(local.x % 32u)) & vec2u(1u);
            if met.x == 1u {
                words = pack(bundle_of(bundle, slab, u32(row), local.x, length));
            }
            small = met.y == 1u;
        }
        let own = Traced(words.xy, is_open, small);
        traced[index] = own;
        workgroupBarrier();
        if stores && ray < BUNDLES {
            let light = gained(own, traced[index - 1u]) + gained(own, traced[index + 1u]);
            if any(light != vec3f(0.0)) {
                var interval = unpack(words);
                interval.light += light;
                words = pack(interval);
            }
            store_words(base + (place * BUNDLES + ray) * sweep.rows + u32(row), words);
        }
        workgroupBarrier();
    }
}
