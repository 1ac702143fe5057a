// One ray through what lets light pass, as each of the library's packets of sixteen: from clear square
// to clear square, from cell edge to cell edge through fog, until it has left the grid, come to a wall
// or gone as far as it was to.

override NEVER: f32;
override OPAQUE: f32;
override LONGEST: u32;
override MATTER: u32;
// Whether rays have an end of their own.
override ENDS: bool;

@group(0) @binding(4) var<storage, read> logs: array<vec4f>;
@group(0) @binding(5) var<storage, read> squares: array<u32>;

// Why a ray stopped.
const LEFT: u32 = 0u;
// It ran out of steps or of light.
const TIRED: u32 = 1u;
const REACHED: u32 = 2u;
const CLOSED: u32 = 3u;

struct Stopped {
    why: u32,
    at: vec2f,
    cell: vec2f,
    // Whether it entered the cell by a step along x.
    along_x: bool,
    travelled: f32,
    // Gathered in fog, and the share of what lies behind that gets through.
    light: vec3f,
    through: vec3f,
}

// A ray from a point in a cell of the grid.
fn march_within(start: vec2f, first: vec2f, way: vec2f, reach: f32, steps: u32) -> Stopped {
    let inverse = 1.0 / select(way, vec2f(NEVER), abs(way) < vec2f(NEVER));
    let back = way < vec2f(0.0);
    let sign = select(vec2f(1.0), vec2f(-1.0), back);
    // An edge has the coordinate of the cell behind it, seen from the left or from above.
    let beyond = select(vec2f(0.0), vec2f(1.0), back);
    let shift = select(0u, 8u, back.x) + select(0u, 16u, back.y);
    let size = vec2f(frame.size);
    var ray = Stopped(TIRED, start, first, true, 0.0, vec3f(0.0), vec3f(1.0));
    var i = index(vec2u(first));
    var square = squares[i] >> shift & 255u;
    if square == 0u {
        ray.why = CLOSED;
        return ray;
    }
    for (var leap = 0u; leap < steps; leap++) {
        let next = ray.cell + sign * f32(square & LONGEST);
        let edge = next + beyond;
        let t = (edge - ray.at) * inverse;
        var length = min(t.x, t.y);
        var crosses = vec2<bool>(t.x < t.y, !(t.x < t.y));
        var ends = false;
        if ENDS {
            let left = reach - ray.travelled;
            ends = length >= left;
            length = min(length, left);
            crosses = crosses & vec2<bool>(!ends);
        }
        // Along the axis that it crosses a ray lands exactly on the edge; along the other it stays
        // within the square, whatever rounding says.
        let along = ray.at + way * length;
        let last = next - sign;
        let within = clamp(floor(along), min(ray.cell, last), max(ray.cell, last));
        ray.at = select(along, edge, crosses);
        ray.cell = select(within, next, crosses);
        ray.along_x = crosses.x;
        if square >= MATTER {
            let passes = exp(logs[i].rgb * max(length, 0.0));
            ray.light += ray.through * (1.0 - passes) * fade(source[i].rgb, ray.travelled);
            ray.through *= passes;
            if max(ray.through.r, max(ray.through.g, ray.through.b)) < OPAQUE {
                return ray;
            }
        }
        ray.travelled += length;
        if ends {
            ray.why = REACHED;
            return ray;
        }
        if any(ray.cell < vec2f(0.0)) || any(ray.cell >= size) {
            ray.why = LEFT;
            return ray;
        }
        i = index(vec2u(ray.cell));
        square = squares[i] >> shift & 255u;
        if square == 0u {
            ray.why = CLOSED;
            return ray;
        }
    }
    return ray;
}
