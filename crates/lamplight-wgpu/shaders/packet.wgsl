// A ray through what lets light pass, as each of the library's packets of sixteen: from clear square to
// clear square, from cell edge to cell edge through fog.

override NEVER: f32;
override OPAQUE: f32;
override LONGEST: u32;
override MATTER: u32;
// Whether rays have an end of their own.
override ENDS: bool;

// Logarithm of what a px lets through; 1 in the fourth place where matter changed.
@group(0) @binding(4) var<storage, read> logs: array<vec4f>;
@group(0) @binding(5) var<storage, read> squares: array<u32>;

// What stays the same along a ray.
struct Heading {
    way: vec2f,
    inverse: vec2f,
    sign: vec2f,
    // An edge has the coordinate of the cell behind it, seen from the left or from above.
    beyond: vec2f,
    // Where in a cell's word the square of its quadrant stands.
    shift: u32,
}

// How far it is.
struct Ray {
    at: vec2f,
    cell: vec2f,
    // Whether it entered the cell by a step along x.
    along_x: bool,
    travelled: f32,
    // Gathered in fog, and the share of what lies behind that gets through.
    light: vec3f,
    through: vec3f,
}

fn heading(way: vec2f) -> Heading {
    let back = way < vec2f(0.0);
    return Heading(
        way,
        1.0 / select(way, vec2f(NEVER), abs(way) < vec2f(NEVER)),
        select(vec2f(1.0), vec2f(-1.0), back),
        select(vec2f(0.0), vec2f(1.0), back),
        select(0u, 8u, back.x) + select(0u, 16u, back.y),
    );
}

fn ray_from(start: vec2f, cell: vec2f) -> Ray {
    return Ray(start, cell, true, 0.0, vec3f(0.0), vec3f(1.0));
}

// The square that opens from a cell; 0: closed.
fn square_at(i: u32, heading: Heading) -> u32 {
    return (squares[i] >> heading.shift) & 255u;
}

// Crosses the square that opens from cell `i`, where the ray is; whether it came to its end in there, so
// many px from where it started.
fn leap(ray: ptr<function, Ray>, heading: Heading, i: u32, square: u32, end: f32) -> bool {
    let from_ = *ray;
    let next = from_.cell + heading.sign * f32(square & LONGEST);
    let edge = next + heading.beyond;
    let t = (edge - from_.at) * heading.inverse;
    var length = min(t.x, t.y);
    var crosses = vec2<bool>(t.x < t.y, !(t.x < t.y));
    var ends = false;
    if ENDS {
        let left = end - from_.travelled;
        ends = length >= left;
        length = min(length, left);
        crosses = crosses & vec2<bool>(!ends);
    }
    // Along the axis that it crosses a ray lands exactly on the edge; along the other it stays within
    // the square, whatever rounding says.
    let along = from_.at + heading.way * length;
    let last = next - heading.sign;
    let within = clamp(floor(along), min(from_.cell, last), max(from_.cell, last));
    (*ray).at = select(along, edge, crosses);
    (*ray).cell = select(within, next, crosses);
    (*ray).along_x = crosses.x;
    (*ray).travelled += length;
    if square >= MATTER {
        let passes = exp(logs[i].rgb * max(length, 0.0));
        (*ray).light += from_.through * (1.0 - passes) * fade(source[i].rgb, from_.travelled);
        (*ray).through *= passes;
    }
    return ends;
}

// Whether no more light gets through to a ray than none.
fn is_spent(ray: Ray) -> bool {
    return max(ray.through.r, max(ray.through.g, ray.through.b)) < OPAQUE;
}

fn has_left(ray: Ray) -> bool {
    return any(ray.cell < vec2f(0.0)) || any(ray.cell >= vec2f(frame.size));
}
