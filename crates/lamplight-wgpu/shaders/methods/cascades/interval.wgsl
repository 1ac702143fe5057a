// The interval of a segment of a ray. Segments start and end anywhere, in the grid or beyond it, where space
// is empty. With INFLOW they end at the border, with the light that enters there.

#import shared/inflow
#import shared/interval
#import shared/packet
#import shared/surfaces
#import shared/uniforms

// Returns whether space is empty within `reach` px of a point along each axis. The smallest square counts of
// those that open from its cell into the four quadrants, and a cell of matter has matter in all four.
fn is_clear(at: vec2f, reach: f32) -> bool {
    if any(at < vec2f(0.0)) || any(at >= vec2f(frame.size)) {
        return false;
    }
    let cell = floor(at);
    let to_border = min(cell, vec2f(frame.size) - 1.0 - cell);
    if INFLOW && min(to_border.x, to_border.y) < reach {
        return false;
    }
    let word = squares[index(vec2u(at))];
    let sides = vec4u(word, word >> 8u, word >> 16u, word >> 24u) & vec4u(255u);
    let smallest = min(min(sides.x, sides.y), min(sides.z, sides.w));
    return smallest < HAS_MEDIUM && f32(smallest) - 1.0 >= reach;
}

// Returns whether a ray that starts within a solid cell would have entered it along x.
fn enters_along_x(ray: Ray, heading: Heading) -> bool {
    let back = (ray.at - (ray.cell + heading.beyond)) * heading.inverse;
    return !(back.y < back.x);
}

// Returns the interval of a ray that stands for the angles between two columns.
fn trace(start: vec2f, direction: vec2f, length: f32, columns: vec2f) -> Interval {
    if !INFLOW {
        return march(start, direction, length);
    }
    let end = exit(start, direction);
    var near = nothing();
    if all(start >= vec2f(0.0)) && all(start < vec2f(frame.size)) {
        near = march(start, direction, length);
        if distance(start, end) >= length {
            return near;
        }
    }
    // One that starts outside has left the grid on its way.
    return Interval(near.light + near.transmittance * entering_at(end, columns), vec3f(0.0));
}

fn march(start: vec2f, direction: vec2f, length: f32) -> Interval {
    let heading = heading(direction);
    let size = vec2f(frame.size);
    var at = start;
    var reach = length;
    if any(start < vec2f(0.0)) || any(start >= size) {
        let low = -start * heading.inverse;
        let high = (size - start) * heading.inverse;
        let enters = min(low, high);
        let leaves = max(low, high);
        let enter = max(max(enters.x, enters.y), 0.0);
        if !(enter < min(min(leaves.x, leaves.y), reach)) {
            return nothing();
        }
        at = start + direction * enter;
        reach = length - enter;
    }
    var ray = ray_from(at, clamp(floor(at), vec2f(0.0), size - 1.0));
    // Each step leads over the edge of a cell, and none leads back.
    for (var left = frame.size.x + frame.size.y + 1u; left > 0u; left--) {
        let i = index(vec2u(ray.cell));
        let square = square_at(i, heading);
        if square == 0u {
            if ray.travelled <= 0.0 {
                ray.along_x = enters_along_x(ray, heading);
            }
            let radiance = wall(i, face(ray.along_x, direction));
            return Interval(ray.light + ray.transmittance * radiance, vec3f(0.0));
        }
        if skip(&ray, heading, i, square, reach) || is_spent(ray) || has_left(ray) {
            break;
        }
    }
    return Interval(ray.light, ray.transmittance);
}
