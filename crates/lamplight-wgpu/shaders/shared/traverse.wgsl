// The traversal of the grid by rays of lamps, from cell edge to cell edge (Amanatides and Woo 1987): the
// same numbers as `grid/traverse.rs` of the library, so that rays meet the same cells.
//
// The importing shader defines `visit(enter, leave, cell, cell_class)` and `VISITS_EMPTY`. If `visiting` is
// set, `visit` is called for each medium along the ray, and for each empty cell if `VISITS_EMPTY` is true;
// otherwise blocks of empty cells are skipped.

#import shared/class
#import shared/class_at
#import shared/direction
#import shared/ends
#import shared/hit
#import shared/uniforms

@group(0) @binding(2) var matter: texture_2d<f32>;

// The distances at which a ray enters the grid, 0 if it starts inside, and leaves it. A ray that misses the
// grid does not leave it later than it enters.
fn span(start: vec2f, ray: Direction) -> vec2f {
    let t0 = -start * ray.inverse;
    let t1 = (vec2f(frame.size) - start) * ray.inverse;
    let enter = min(t0, t1);
    let leave = max(t0, t1);
    return vec2f(max(max(enter.x, enter.y), 0.0), min(leave.x, leave.y));
}

// The cell at a point; at the border also if rounding puts the point just outside.
fn cell_at(at: vec2f) -> vec2i {
    return clamp(vec2i(floor(at)), vec2i(0), vec2i(frame.size) - 1);
}

// The cell that a ray from the cell `first` has reached at a distance along each axis: behind all edges that
// it crosses up to there, decided by the same numbers as cell by cell.
fn reached(start: vec2f, ray: Direction, first: vec2i, sign: vec2i, ahead: vec2i, distance: f32) -> vec2i {
    let estimate = vec2i(floor(start + ray.along * distance));
    // Not behind the start, nor beyond its block.
    let last = (first & vec2i(-4)) + 3 * ahead;
    var cell = clamp(estimate, min(first, last), max(first, last));
    let on = (vec2f(cell + ahead) - start) * ray.inverse <= vec2f(distance);
    cell += select(vec2i(0), sign, on & (cell != last));
    let early = (vec2f(cell + ahead - sign) - start) * ray.inverse > vec2f(distance);
    return cell - select(vec2i(0), sign, early & (cell != first));
}

// Follows a ray to a cell that ends it, to the border of the grid, or to `reach`. If `leaving` is set, the
// cell of the start does not end it.
fn traverse(start: vec2f, ray: Direction, reach: f32, leaving: bool, visiting: bool) -> Hit {
    let grid = span(start, ray);
    if !(grid.x < grid.y && grid.x < reach) {
        return no_hit();
    }
    let sign = vec2i(ray.sign);
    // An edge ahead has the coordinate of the cell or of the one after.
    let ahead = max(sign, vec2i(0));
    var at = grid.x;
    var cell = cell_at(start + ray.along * at);
    // A ray crosses no more edges than there are.
    let most = frame.size.x + frame.size.y + 2u;
    for (var crossed = 0u; crossed < most; crossed++) {
        if !inside(cell) {
            return no_hit();
        }
        let word = word_at(vec2u(cell));
        if word == 0u && !(visiting && VISITS_EMPTY) {
            let far_edge = vec2f((cell & vec2i(-4)) + 4 * ahead);
            let exit = (far_edge - start) * ray.inverse;
            let leave = min(exit.x, exit.y);
            if leave >= reach {
                return no_hit();
            }
            // A ray through the corner of a block goes cell by cell.
            if exit.x != exit.y {
                let crosses = exit.xy < exit.yx;
                cell = select(
                    reached(start, ray, cell, sign, ahead, leave),
                    vec2i(far_edge) + ahead - 1,
                    crosses,
                );
                at = leave;
                continue;
            }
        }
        let next = (vec2f(cell + ahead) - start) * ray.inverse;
        let leave = min(next.x, next.y);
        let cell_class = class_in(word, vec2u(cell));
        if ends(cell_class) {
            if !leaving || crossed > 0u {
                return Hit(at, packed(cell));
            }
        } else if visiting {
            visit(at, min(leave, reach), vec2u(cell), cell_class);
        }
        if leave >= reach {
            return no_hit();
        }
        // Through the exact corner of four cells light passes unless both cells beside it end rays.
        if next.x == next.y {
            let beside = cell + vec2i(sign.x, 0);
            if ends(class_at(beside)) && ends(class_at(cell + vec2i(0, sign.y))) {
                return Hit(leave, packed(beside));
            }
        }
        let crosses = next.xy <= next.yx;
        cell += select(vec2i(0), sign, crosses);
        at = leave;
    }
    return no_hit();
}
