// The shortest intervals, traced from cell centre to cell centre with exact lengths.

@group(0) @binding(3) var<storage, read> source: array<vec4f>;
@group(0) @binding(4) var matter: texture_2d<f32>;
// Where the pieces of a ray begin and their number, ray by ray; then pieces: a cell by slabs and rows
// from the first, px through it as bits, and whether a corner follows, between the next slab and the next
// row: 0, or which way the ray goes.
@group(0) @binding(5) var<storage, read> ways: array<vec4i>;

fn beyond(at: vec2i) -> bool {
    return at.x >= i32(sweep.depth) || at.y < 0 || at.y >= i32(sweep.rows);
}

fn seen(at: vec2i) -> vec4f {
    return source[index(cell_of(u32(at.x), u32(at.y)))];
}

fn wall(emission: vec3f) -> Interval {
    return Interval(emission, vec3f(0.0));
}

fn trace(start: vec2i, way: vec2i) -> Interval {
    var met = nothing();
    for (var i = way.x; i < way.x + way.y; i++) {
        let piece = ways[i];
        let at = start + piece.xy;
        // A straight ray that has left the grid does not come back.
        if beyond(at) {
            return met;
        }
        let cell = seen(at);
        if cell.w == SOLID {
            return then(met, wall(cell.rgb));
        }
        if cell.w == MEDIUM {
            let logs = log_transmittance(textureLoad(matter, cell_of(u32(at.x), u32(at.y)), 0));
            let through = exp(logs * bitcast<f32>(piece.z));
            met = then(met, Interval((1.0 - through) * cell.rgb, through));
        }
        let next_slab = at + vec2i(1, 0);
        let next_row = at + vec2i(0, piece.w);
        // A corner stops the ray where both cells beside it are solid.
        if piece.w != 0 && !beyond(next_slab) && !beyond(next_row) {
            let a = seen(next_slab);
            let b = seen(next_row);
            if a.w == SOLID && b.w == SOLID {
                return then(met, wall(0.5 * a.rgb + 0.5 * b.rgb));
            }
        }
    }
    return met;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x < sweep.rows {
        let start = vec2i(i32(id.z << sweep.level), i32(id.x));
        let way = ways[sweep.ways + id.y].xy;
        store(place(sweep.level, id.z, id.y, id.x), trace(start, way));
    }
}
