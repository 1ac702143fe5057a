// The way of lamps' rays through the grid, from cell edge to cell edge (Amanatides, Woo 1987): the
// same numbers as `ground.rs` of the library, so that rays meet the same cells.
//
// Who walks with `visiting` is told of every cell on the way: `visit(enter, leave, cell, kind)`.

// Whether fog lets light through, or ends rays.
override TRANSLUCENT: bool;

@group(0) @binding(2) var matter: texture_2d<f32>;
// Made by ground.wgsl.
@group(0) @binding(3) var<storage, read> kinds: array<u32>;

const EMPTY: u32 = 0u;
const FOG: u32 = 1u;
const WALL: u32 = 2u;
const BEYOND: u32 = 3u;

// Stands for infinity, which a shader may not rely on.
const FAR: f32 = 3.40282347e38;
const NO_CELL: u32 = 0xffffffffu;
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

fn word_at(cell: vec2u) -> u32 {
    return kinds[(cell.y >> 2u) * ((frame.size.x + 3u) >> 2u) + (cell.x >> 2u)];
}

fn kind_at(cell: vec2i) -> u32 {
    if !inside(cell) {
        return BEYOND;
    }
    let at = vec2u(cell);
    return word_at(at) >> (((at.y & 3u) << 3u) | ((at.x & 3u) << 1u)) & 3u;
}

fn ends(kind: u32) -> bool {
    return kind == WALL || (kind == FOG && !TRANSLUCENT);
}

fn packed(cell: vec2i) -> u32 {
    return u32(cell.x) | u32(cell.y) << 16u;
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

// Walks until a wall, the end of the grid or `reach`. With `leaving` the ray starts within its cell,
// even if that is a wall.
fn walk(from_: vec2f, way: Way, reach: f32, leaving: bool, visiting: bool) -> Hit {
    let nothing = Hit(FAR, NO_CELL);
    let grid = span(from_, way);
    if !(grid.x < grid.y && grid.x < reach) {
        return nothing;
    }
    let sign = vec2i(way.sign);
    var at = grid.x;
    var cell = cell_at(from_ + way.along * at);
    var edge = vec2f(cell) + max(way.sign, vec2f(0.0));
    var next = (edge - from_) * way.inverse;
    // It crosses no more edges than there are.
    let most = frame.size.x + frame.size.y + 2u;
    for (var crossed = 0u; crossed < most; crossed++) {
        let leave = min(next.x, next.y);
        let kind = kind_at(cell);
        if kind == BEYOND {
            return nothing;
        }
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
        edge += select(vec2f(0.0), way.sign, crosses);
        next = (edge - from_) * way.inverse;
        at = leave;
    }
    return nothing;
}
