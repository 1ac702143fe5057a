// Traces the shortest intervals, from cell centre to cell centre with exact lengths.

#import methods/holographic/paper/interval
#import shared/absorptance
#import shared/class
#import shared/transmittance

@group(0) @binding(3) var<storage, read> source: array<vec4f>;
@group(0) @binding(4) var matter: texture_2d<f32>;
// The first piece of each ray and the number of its pieces; then pieces: a cell by slabs and rows from the
// first, px through it as bits, and 0, or, if the ray then passes the corner between the next slab and the
// next row, its direction across rows.
@group(0) @binding(5) var<storage, read> footprints: array<vec4i>;

fn beyond(at: vec2i) -> bool {
    return at.x >= i32(sweep.depth) || at.y < 0 || at.y >= i32(sweep.rows);
}

fn seen(at: vec2i) -> vec4f {
    return source[index(cell_of(u32(at.x), u32(at.y)))];
}

fn wall(emission: vec3f) -> Interval {
    return Interval(emission, vec3f(0.0));
}

fn trace(start: vec2i, footprint: vec2i) -> Interval {
    var interval = nothing();
    for (var i = footprint.x; i < footprint.x + footprint.y; i++) {
        let piece = footprints[i];
        let at = start + piece.xy;
        // A straight ray that has left the grid does not come back.
        if beyond(at) {
            return interval;
        }
        let cell = seen(at);
        if class_of(cell) == SOLID {
            return then(interval, wall(cell.rgb));
        }
        if class_of(cell) == MEDIUM {
            let tint_opacity = textureLoad(matter, cell_of(u32(at.x), u32(at.y)), 0);
            let depth = extinction_of(tint_opacity) * bitcast<f32>(piece.z);
            interval = then(interval, Interval(absorptance(depth) * cell.rgb, exp(-depth)));
        }
        let next_slab = at + vec2i(1, 0);
        let next_row = at + vec2i(0, piece.w);
        // A corner stops the ray if both cells beside it are solid.
        if piece.w != 0 && !beyond(next_slab) && !beyond(next_row) {
            let a = seen(next_slab);
            let b = seen(next_row);
            if class_of(a) == SOLID && class_of(b) == SOLID {
                return then(interval, wall(0.5 * a.rgb + 0.5 * b.rgb));
            }
        }
    }
    return interval;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x < sweep.rows {
        let start = vec2i(i32(id.z << sweep.level), i32(id.x));
        let footprint = footprints[sweep.footprints + id.y].xy;
        store(place(sweep.level, id.z, id.y, id.x), trace(start, footprint));
    }
}
