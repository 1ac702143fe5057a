// How a ray of a fan finds its way out from the lamp: `Fan::trace` of the library.

// From edge to edge, a px at a time, or by the distance field.
override WALK: u32;
override MARGIN: f32;
const VISITS_EMPTY: bool = false;
const BY_EDGES: u32 = 0u;
const BY_DISTANCE: u32 = 2u;

// The distance field; one number where rays do not go by it.
@group(0) @binding(4) var<storage, read> distance_field: array<f32>;

// Walks by samples, the first at the start, each as far from the one before as is surely clear.
fn sample(from_: vec2f, way: Way, limit: f32, visiting: bool) -> Hit {
    let grid = span(from_, way);
    if !(grid.x < grid.y) {
        return Hit(FAR, NO_CELL);
    }
    let reach = min(limit, grid.y);
    var at = ceil(grid.x);
    while at < reach {
        let cell = cell_at(from_ + way.along * at);
        let kind = kind_at(cell);
        if ends(kind) {
            return Hit(at, packed(cell));
        }
        var next = at + 1.0;
        if WALK == BY_DISTANCE {
            next = at + max(distance_field[index(vec2u(cell))] - MARGIN, 1.0);
        }
        if visiting {
            visit(at, min(next, reach), vec2u(cell), kind);
        }
        at = next;
    }
    return Hit(FAR, NO_CELL);
}

// Sends a ray of a lamp's fan.
fn send(lamp: Lamp, ray: u32) -> Hit {
    if in_cone(lamp, ray, lamp.count) == 0.0 {
        return Hit(FAR, NO_CELL);
    }
    let way = way_of(ray, lamp.count);
    if WALK == BY_EDGES {
        return walk(lamp.position, way, lamp.reach, false, TRANSLUCENT);
    }
    return sample(lamp.position, way, lamp.reach, TRANSLUCENT);
}

fn visit(enter: f32, leave: f32, cell: vec2u, kind: u32) {
    if kind == FOG {
        let logarithm = log_transmittance(textureLoad(matter, cell, 0));
        medium(enter, leave, logarithm);
    }
}
