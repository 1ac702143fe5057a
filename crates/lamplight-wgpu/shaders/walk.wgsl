// The way of lamps' rays through the grid, from cell edge to cell edge (Amanatides, Woo 1987): the
// same numbers as `ground.rs` of the library, so that rays meet the same cells.
//
// Who walks with `visiting` is told of cells on the way: `visit(enter, leave, cell, kind)`; of empty
// ones only with `VISITS_EMPTY`, and otherwise blocks of empty cells are crossed at once.

// Whether fog lets light through, or ends rays.
override TRANSLUCENT: bool;

@group(0) @binding(2) var matter: texture_2d<f32>;

// The least number that is not 0, to precision.
const LEAST: f32 = 1.17549435e-38;

// How far a ray came, FAR where it met nothing, and the wall, packed as seeds are.
struct Hit {
    length: f32,
    cell: u32,
}

// A direction with what a walk needs of it.
struct Way {
    along: vec2f,
    // 1 or −1: to which side edges lie; of zeros too.
    sign: vec2f,
    inverse: vec2f,
}

fn way(magnitude: vec2f, sign: vec2f) -> Way {
    // Never 1/0, so that no edge is 0·∞ px away.
    return Way(sign * magnitude, sign, sign / max(magnitude, vec2f(LEAST)));
}

fn ends(kind: u32) -> bool {
    return kind == WALL || (kind == FOG && !TRANSLUCENT);
}

fn packed(cell: vec2i) -> u32 {
    return u32(cell.x) | (u32(cell.y) << 16u);
}

// Where a ray enters the grid, 0 when it starts inside, and leaves it; no more than it enters when it
// misses.
fn span(from_: vec2f, way: Way) -> vec2f {
    let t0 = -from_ * way.inverse;
    let t1 = (vec2f(frame.size) - from_) * way.inverse;
    let enter = min(t0, t1);
    let leave = max(t0, t1);
    return vec2f(max(max(enter.x, enter.y), 0.0), min(leave.x, leave.y));
}

// The cell at a point, at the border where rounding puts it just outside.
fn cell_at(at: vec2f) -> vec2i {
    return clamp(vec2i(floor(at)), vec2i(0), vec2i(frame.size) - 1);
}

// How far a ray is at a distance along each axis, coming from a cell: behind all edges that it crosses
// up to there, counted by the same numbers as step by step.
fn reached(from_: vec2f, way: Way, start: vec2i, sign: vec2i, ahead: vec2i, distance: f32) -> vec2i {
    let about = vec2i(floor(from_ + way.along * distance));
    // Not behind the start, nor beyond its block.
    let last = (start & vec2i(-4)) + 3 * ahead;
    var cell = clamp(about, min(start, last), max(start, last));
    let on = (vec2f(cell + ahead) - from_) * way.inverse <= vec2f(distance);
    cell += select(vec2i(0), sign, on & (cell != last));
    let early = (vec2f(cell + ahead - sign) - from_) * way.inverse > vec2f(distance);
    return cell - select(vec2i(0), sign, early & (cell != start));
}

// Walks until a wall, the end of the grid or `reach`. With `leaving` the ray starts within its cell,
// even if that is a wall.
fn walk(from_: vec2f, way: Way, reach: f32, leaving: bool, visiting: bool) -> Hit {
    let nothing = Hit(FAR, NO_CELL);
    let grid = span(from_, way);
    if !(grid.x < grid.y && grid.x < reach) {
        return nothing;
    }
    let sign = vec2i(way.sign);
    // An edge ahead has the coordinate of the cell or of the one after.
    let ahead = max(sign, vec2i(0));
    var at = grid.x;
    var cell = cell_at(from_ + way.along * at);
    // It crosses no more edges than there are.
    let most = frame.size.x + frame.size.y + 2u;
    for (var crossed = 0u; crossed < most; crossed++) {
        if !inside(cell) {
            return nothing;
        }
        let word = word_at(vec2u(cell));
        if word == 0u && !(visiting && VISITS_EMPTY) {
            let far_edge = vec2f((cell & vec2i(-4)) + 4 * ahead);
            let exit = (far_edge - from_) * way.inverse;
            let leave = min(exit.x, exit.y);
            if leave >= reach {
                return nothing;
            }
            // Through the corner of a block goes who goes step by step.
            if exit.x != exit.y {
                let crosses = exit.xy < exit.yx;
                cell = select(
                    reached(from_, way, cell, sign, ahead, leave),
                    vec2i(far_edge) + ahead - 1,
                    crosses,
                );
                at = leave;
                continue;
            }
        }
        let next = (vec2f(cell + ahead) - from_) * way.inverse;
        let leave = min(next.x, next.y);
        let kind = kind_in(word, vec2u(cell));
        if ends(kind) {
            if !leaving || crossed > 0u {
                return Hit(at, packed(cell));
            }
        } else if visiting {
            visit(at, min(leave, reach), vec2u(cell), kind);
        }
        if leave >= reach {
            return nothing;
        }
        // Through the exact corner of four cells light passes unless both cells beside it are walls.
        if next.x == next.y {
            let beside = cell + vec2i(sign.x, 0);
            if ends(kind_at(beside)) && ends(kind_at(cell + vec2i(0, sign.y))) {
                return Hit(leave, packed(beside));
            }
        }
        let crosses = next.xy <= next.yx;
        cell += select(vec2i(0), sign, crosses);
        at = leave;
    }
    return nothing;
}
