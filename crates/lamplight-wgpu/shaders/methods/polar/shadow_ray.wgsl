// A ray of a lamp's shadow map, traced outwards from the lamp (`shadow_map.rs` of the library).

#import methods/polar/transmittance_curve
#import shared/circle
#import shared/class
#import shared/class_at
#import shared/hit
#import shared/lamps
#import shared/transmittance
#import shared/traverse

// The advance of rays: from edge to edge, a px at a time, or by the distance field.
override TRAVERSAL: u32;
override MARGIN: f32;
const VISITS_EMPTY: bool = false;
const BY_EDGES: u32 = 0u;
const BY_DISTANCE: u32 = 2u;

// The distance field; a single number if rays do not use it.
@group(0) @binding(4) var<storage, read> distance_field: array<f32>;

// Traverses the grid by samples, the first at the start, each as far from the one before as is surely empty.
fn traverse_by_samples(start: vec2f, ray: Direction, limit: f32, visiting: bool) -> Hit {
    let grid = span(start, ray);
    if !(grid.x < grid.y) {
        return no_hit();
    }
    let reach = min(limit, grid.y);
    var at = ceil(grid.x);
    while at < reach {
        let cell = cell_at(start + ray.along * at);
        let cell_class = class_at(cell);
        if ends(cell_class) {
            return Hit(at, packed(cell));
        }
        var next = at + 1.0;
        if TRAVERSAL == BY_DISTANCE {
            next = at + max(distance_field[index(vec2u(cell))] - MARGIN, 1.0);
        }
        if visiting {
            visit(at, min(next, reach), vec2u(cell), cell_class);
        }
        at = next;
    }
    return no_hit();
}

// Traces a ray of a lamp.
fn trace(lamp: Lamp, ray: u32) -> Hit {
    if in_cone(lamp, ray, lamp.count) == 0.0 {
        return no_hit();
    }
    let direction = direction_of(ray, lamp.count);
    if TRAVERSAL == BY_EDGES {
        return traverse(lamp.position, direction, lamp.reach, false, TRANSLUCENT);
    }
    return traverse_by_samples(lamp.position, direction, lamp.reach, TRANSLUCENT);
}

fn visit(enter: f32, leave: f32, cell: vec2u, cell_class: u32) {
    if cell_class == MEDIUM {
        append_medium(enter, leave, extinction_of(textureLoad(matter, cell, 0)));
    }
}
