// Traces the first level of intervals: bundles, each the mean of parallel rays, from every row of the planes
// that lie 2^level slabs apart, and filters the light of small sources across rows (prefilter.wgsl).

#import methods/holographic/footprint
#import methods/holographic/interval
#import methods/holographic/prefilter
#import methods/holographic/store_interval

// Rows that a workgroup stores. It traces one more to each side.
const STORED: u32 = TILE - 2u;
// Bundles from a row.
override BUNDLES: u32;

@group(0) @binding(7) var<storage, read_write> made: array<vec2u>;
@group(0) @binding(8) var<storage, read_write> made_tints: array<u32>;

// Rows of the tile from which each bundle meets matter, and a small source.
var<workgroup> meets: array<vec4u, BUNDLES>;
// The light of a bundle from each row: of even bundles, and of odd ones.
var<workgroup> traced: array<vec2u, 2u * TILE>;

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

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    select_quadrant(group.z);
    let plane = sweep.first + group.y;
    let length = 1u << sweep.level;
    let slab = plane << sweep.level;
    let first_row = i32(STORED * group.x) - 1;
    fetch(lane, TILE, slab, first_row, length);
    workgroupBarrier();
    let size = length + 1u + sweep.rays;
    for (var ray = lane; ray < BUNDLES; ray += TILE) {
        meets[ray] = meeting(OCCUPIED, LAST, sweep.footprints + ray * size, length + 1u);
    }
    let row = first_row + i32(lane);
    let inside = row >= 0 && row < i32(sweep.rows);
    let stores = inside && group.y < sweep.planes && lane > 0u && lane <= STORED;
    let open = ~solid_rows();
    let odd = (plane & 1u) == 1u;
    let place = plane / 2u - sweep.stored;
    let base = select(sweep.even, sweep.odd, odd);
    workgroupBarrier();
    for (var ray = 0u; ray < BUNDLES; ray++) {
        let met = meets[ray];
        var words = pack(nothing());
        if inside && has(met.xy, lane) {
            words = pack(bundle_of(sweep.footprints + ray * size, slab, u32(row), lane, length));
        }
        let side = TILE * (ray % 2u);
        traced[side + lane] = words.xy;
        workgroupBarrier();
        if stores {
            // Bits of rows that exchange light with the row after them.
            let exchange = exchanging(open, met.zw);
            var light = vec3f(0.0);
            if row > 0 && has(exchange, lane - 1u) {
                light += gained(words.xy, traced[side + lane - 1u]);
            }
            if row + 1 < i32(sweep.rows) && has(exchange, lane) {
                light += gained(words.xy, traced[side + lane + 1u]);
            }
            if any(light != vec3f(0.0)) {
                var interval = unpack(words);
                interval.light += light;
                words = pack(interval);
            }
            store_words(base + (place * BUNDLES + ray) * sweep.rows + u32(row), words);
        }
    }
}
