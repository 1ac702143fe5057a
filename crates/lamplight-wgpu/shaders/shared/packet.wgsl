// A ray through empty cells and media, as each lane of the library's packets of sixteen: it skips empty
// space square by square, and goes from cell edge to cell edge through media.

#import shared/absorptance
#import shared/surfaces
#import shared/uniforms

override NEVER: f32;
override OPAQUE_TRANSMITTANCE: f32;
override MAX_SKIP: u32;
override HAS_MEDIUM: u32;
// True if rays have an end of their own.
override ENDS: bool;

// Extinction per px; in `w` 1 where matter changed.
@group(0) @binding(4) var<storage, read> extinction: array<vec4f>;
// Squares to skip, as stages/empty_space.wgsl makes them.
@group(0) @binding(5) var<storage, read> squares: array<u32>;

// The values that stay the same along a ray.
struct Heading {
    direction: vec2f,
    inverse: vec2f,
    sign: vec2f,
    // The offset from a cell to the edge by which the ray leaves the cell before it.
    beyond: vec2f,
    // The bit at which the square of its quadrant begins in a cell's word.
    shift: u32,
}

// The progress of a ray.
struct Ray {
    at: vec2f,
    cell: vec2f,
    // True if it entered the cell by a step along x.
    along_x: bool,
    travelled: f32,
    // Radiance gathered in media, and the transmittance up to here.
    light: vec3f,
    transmittance: vec3f,
}

fn heading(direction: vec2f) -> Heading {
    let back = direction < vec2f(0.0);
    return Heading(
        direction,
        1.0 / select(direction, vec2f(NEVER), abs(direction) < vec2f(NEVER)),
        select(vec2f(1.0), vec2f(-1.0), back),
        select(vec2f(0.0), vec2f(1.0), back),
        select(0u, 8u, back.x) + select(0u, 16u, back.y),
    );
}

fn ray_from(start: vec2f, cell: vec2f) -> Ray {
    return Ray(start, cell, true, 0.0, vec3f(0.0), vec3f(1.0));
}

// The square that opens from a cell; 0 if the cell stops rays.
fn square_at(i: u32, heading: Heading) -> u32 {
    return (squares[i] >> heading.shift) & 255u;
}

// Crosses the square that opens from cell `i`, in which the ray is. Returns whether the ray reaches its own
// end in the square, `end` px from its start.
fn skip(ray: ptr<function, Ray>, heading: Heading, i: u32, square: u32, end: f32) -> bool {
    let before = *ray;
    let next = before.cell + heading.sign * f32(square & MAX_SKIP);
    let edge = next + heading.beyond;
    let t = (edge - before.at) * heading.inverse;
    var length = min(t.x, t.y);
    var crosses = vec2<bool>(t.x < t.y, !(t.x < t.y));
    var ends = false;
    if ENDS {
        let left = end - before.travelled;
        ends = length >= left;
        length = min(length, left);
        crosses = crosses & vec2<bool>(!ends);
    }
    // Along the axis that it crosses a ray lands exactly on the edge; along the other it stays within
    // the square, whatever the rounding.
    let along = before.at + heading.direction * length;
    let last = next - heading.sign;
    let within = clamp(floor(along), min(before.cell, last), max(before.cell, last));
    (*ray).at = select(along, edge, crosses);
    (*ray).cell = select(within, next, crosses);
    (*ray).along_x = crosses.x;
    (*ray).travelled += length;
    if square >= HAS_MEDIUM {
        let depth = extinction[i].rgb * max(length, 0.0);
        (*ray).light += before.transmittance * absorptance(depth) * fade(source[i].rgb, before.travelled);
        (*ray).transmittance *= exp(-depth);
    }
    return ends;
}

// Returns whether the transmittance up to here counts as none.
fn is_spent(ray: Ray) -> bool {
    return max(ray.transmittance.r, max(ray.transmittance.g, ray.transmittance.b)) < OPAQUE_TRANSMITTANCE;
}

fn has_left(ray: Ray) -> bool {
    return any(ray.cell < vec2f(0.0)) || any(ray.cell >= vec2f(frame.size));
}
