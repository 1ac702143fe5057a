// What a piece of a ray brings back, and how much gets through it. Pieces start and end anywhere, in
// the grid or beyond it, where all is empty.

struct Interval {
    light: vec3f,
    through: vec3f,
}

// Whether nothing lies within so many px of a point along each axis: of the squares that open from its
// cell into the four quadrants the least counts, and a cell of matter has it in all four.
fn is_clear(at: vec2f, reach: f32) -> bool {
    if any(at < vec2f(0.0)) || any(at >= vec2f(frame.size)) {
        return false;
    }
    let word = squares[index(vec2u(at))];
    let sides = vec4u(word, word >> 8u, word >> 16u, word >> 24u) & vec4u(255u);
    let least = min(min(sides.x, sides.y), min(sides.z, sides.w));
    return least < MATTER && f32(least) - 1.0 >= reach;
}

// Whether a ray that starts within a wall would have come in along x.
fn comes_in_along_x(at: vec2f, cell: vec2f, way: vec2f) -> bool {
    let edge = cell + select(vec2f(0.0), vec2f(1.0), way < vec2f(0.0));
    let back = (at - edge) / select(way, vec2f(NEVER), abs(way) < vec2f(NEVER));
    return !(back.y < back.x);
}

fn trace(start: vec2f, way: vec2f, length: f32) -> Interval {
    let size = vec2f(frame.size);
    var at = start;
    var reach = length;
    if any(start < vec2f(0.0)) || any(start >= size) {
        let inverse = 1.0 / select(way, vec2f(NEVER), abs(way) < vec2f(NEVER));
        let low = -start * inverse;
        let high = (size - start) * inverse;
        let enters = min(low, high);
        let leaves = max(low, high);
        let enter = max(max(enters.x, enters.y), 0.0);
        if !(enter < min(min(leaves.x, leaves.y), reach)) {
            return Interval(vec3f(0.0), vec3f(1.0));
        }
        at = start + way * enter;
        reach = length - enter;
    }
    let first = clamp(floor(at), vec2f(0.0), size - 1.0);
    // Each step leads over the edge of a cell, and none leads back.
    let ray = march_within(at, first, way, reach, frame.size.x + frame.size.y);
    if ray.why != CLOSED {
        return Interval(ray.light, ray.through);
    }
    var along_x = ray.along_x;
    if ray.travelled <= 0.0 {
        along_x = comes_in_along_x(ray.at, ray.cell, way);
    }
    let sent = wall(index(vec2u(ray.cell)), face(along_x, way));
    return Interval(ray.light + ray.through * sent, vec3f(0.0));
}
