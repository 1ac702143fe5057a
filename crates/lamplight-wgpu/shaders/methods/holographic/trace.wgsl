// Traces the first level of intervals: bundles, each the mean of parallel rays, from every point of the planes,
// and filters the light of small sources across rows (prefilter.wgsl). A lane is a row of cells. If several rows share a
// point, its bundle is the mean over those from the rows that it stands for, so that no path leads through a wall.

#import methods/holographic/interval
#import methods/holographic/point_rows
#import methods/holographic/prefilter
#import methods/holographic/store_interval

// Rows that a workgroup stores. It traces those of one more point to each side.
override STORED: u32 = TILE - 2u * SPACING;
// Bundles from a row, and rays of each.
override BUNDLES: u32;
override RAYS: u32;

@group(0) @binding(7) var<storage, read_write> made: array<vec2u>;
@group(0) @binding(8) var<storage, read_write> made_tints: array<u32>;

// Rows of the tile from which each bundle may meet matter, and a small source.
var<workgroup> meets: array<vec4u, BUNDLES>;
// Rows from which each ray of each bundle that may meet matter is stopped, and those from which it has to be traced.
var<workgroup> rays: array<vec4u, RAYS * BUNDLES>;
// The light of a bundle from each row: of even bundles, and of odd ones.
var<workgroup> traced: array<vec2u, 2u * TILE>;
// The light and the transmittance of the bundles of all rows of cells, where several share a point.
var<workgroup> of_rows: array<vec3u, 2u * TILE>;

// The first entry of a bundle: a mask with an entry per slab, then the crossings of each ray.
fn entry_of(bundle: u32, slabs: u32) -> u32 {
    return sweep.footprints + bundle * (slabs + RAYS);
}

// The mean interval of the rays of a bundle from a lane's row.
fn mean_of_rays(bundle: u32, slabs: u32, slab: u32, row: u32, lane: u32) -> Interval {
    let entry = entry_of(bundle, slabs) + slabs;
    var sum = Interval(vec3f(0.0), vec3f(0.0));
    for (var i = 0u; i < RAYS; i++) {
        let met = rays[bundle * RAYS + i];
        if has(met.zw, lane) {
            let one = march(slab, row, lane, footprints[entry + i]);
            sum.light += one.light;
            sum.transmittance += one.transmittance;
        } else if !has(met.xy, lane) {
            sum.transmittance += 1.0;
        }
    }
    return Interval(sum.light / f32(RAYS), sum.transmittance / f32(RAYS));
}

// The mean over the rows of a lane's point that count. Nothing passes if none does.
fn mean_of_point(lane: u32, counting: vec2u) -> Interval {
    let first = lane - lane % SPACING;
    var sum = Interval(vec3f(0.0), vec3f(0.0));
    var count = 0.0;
    for (var row = first; row < first + SPACING; row++) {
        if has(counting, row) {
            sum.light += bitcast<vec3f>(of_rows[2u * row]);
            sum.transmittance += bitcast<vec3f>(of_rows[2u * row + 1u]);
            count += 1.0;
        }
    }
    let share = 1.0 / max(count, 1.0);
    return Interval(share * sum.light, share * sum.transmittance);
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    select_quadrant(group.z);
    // Not that of `sweep`: browsers reject a barrier after a return that may depend on a variable.
    let own = sweeps[group.z % sweeps[0].quadrants];
    if group.y >= own.planes || STORED * group.x >= own.cell_rows {
        return;
    }
    let plane = sweep.first + group.y;
    let length = SPACING << sweep.level;
    let slab = plane * length;
    let first_row = i32(STORED * group.x) - i32(SPACING);
    fetch(lane, TILE, slab, first_row, length);
    workgroupBarrier();
    let slabs = length + 1u;
    for (var bundle = lane; bundle < BUNDLES; bundle += TILE) {
        let mask = entry_of(bundle, slabs);
        meets[bundle] = vec4u(meeting(MATTER, mask, 0u, slabs), meeting(LAST, mask, 0u, slabs));
    }
    workgroupBarrier();
    for (var ray = lane; ray < RAYS * BUNDLES; ray += TILE) {
        let bundle = ray / RAYS;
        if any(meets[bundle].xy != vec2u(0u)) {
            let entry = entry_of(bundle, slabs) + slabs + ray % RAYS;
            rays[ray] = first_met(footprints[entry], 0u, meets[bundle].xy);
        }
    }
    let row = first_row + i32(lane);
    let inside = row >= 0 && row < i32(sweep.cell_rows);
    let point = row / i32(SPACING);
    let stores = inside && lane % SPACING == 0u && lane >= SPACING && lane < SPACING + STORED;
    let in_points = rows_in_points(open_rows(0u, first_row)).yz;
    let apart = rows_apart(length, first_row);
    let odd = (plane & 1u) == 1u;
    let place = plane / 2u - sweep.stored;
    let base = select(sweep.even, sweep.odd, odd);
    workgroupBarrier();
    for (var bundle = 0u; bundle < BUNDLES; bundle++) {
        var interval = nothing();
        let met = meets[bundle];
        if inside && has(met.xy, lane) {
            interval = mean_of_rays(bundle, slabs, slab, u32(row), lane);
        }
        if SPACING > 1u {
            of_rows[2u * lane] = bitcast<vec3u>(interval.light);
            of_rows[2u * lane + 1u] = bitcast<vec3u>(interval.transmittance);
            workgroupBarrier();
            let ends_apart = shifted(apart, u32(ASIDE) + SPACING * bundle - length);
            interval = mean_of_point(lane, in_points & ~ends_apart);
        }
        var words = pack(interval);
        let side = TILE * (bundle % 2u);
        traced[side + lane] = words.xy;
        workgroupBarrier();
        if stores {
            // Bits of rows that exchange light with the row after them.
            let exchange = exchanging(in_points, any_of_points(met.zw));
            var light = vec3f(0.0);
            if point > 0 && has(exchange, lane - 1u) {
                light += gained(words.xy, traced[side + lane - SPACING]);
            }
            if point + 1 < i32(sweep.rows) && has(exchange, lane + SPACING - 1u) {
                light += gained(words.xy, traced[side + lane + SPACING]);
            }
            if any(light != vec3f(0.0)) {
                var gaining = unpack(words);
                gaining.light += exchanged(bundle, BUNDLES) * light;
                words = pack(gaining);
            }
            store_words(base + (place * BUNDLES + bundle) * sweep.rows + u32(point), words);
        }
    }
}
