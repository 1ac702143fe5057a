// Light that enters a grid by place on its border and by direction (crates/lamplight/src/inflow.rs). Each border cell has
// a strip of columns in `panorama`.

#import shared/sky
#import shared/uniforms

// The mean light between two columns at a place along a side: 0 for the top, 1 for the right, 2 for the bottom, 3 for the
// left.
fn entering(side: u32, along: f32, columns: vec2f) -> vec3f {
    let cells = frame.size[side & 1u];
    let first = (side & 1u) * frame.size.x + (side >> 1u) * (frame.size.x + frame.size.y);
    let at = clamp(along - 0.5, 0.0, f32(cells - 1u));
    let past = fract(at);
    // In a loop, which compilers for CPUs leave where no lane is at the border.
    var light = vec3f(0.0);
    for (var next = 0u; next < 2u; next++) {
        let weight = select(1.0 - past, past, next == 1u);
        light += weight * mean_of_columns(first + min(u32(at) + next, cells - 1u), columns);
    }
    return light;
}

// The same at a place on the border, on the side that is nearest to it.
fn entering_at(place: vec2f, columns: vec2f) -> vec3f {
    let size = vec2f(frame.size);
    let away = abs(vec4f(place.y, size.x - place.x, size.y - place.y, place.x));
    var side = 0u;
    for (var other = 1u; other < 4u; other++) {
        side = select(side, other, away[other] < away[side]);
    }
    return entering(side, place[side & 1u], columns);
}

// Where a straight line that passes a point leaves the grid for good.
fn exit(at: vec2f, direction: vec2f) -> vec2f {
    let size = vec2f(frame.size);
    let ends = select(vec2f(0.0), size, direction > vec2f(0.0));
    let lengths = select((ends - at) / direction, vec2f(1e30), direction == vec2f(0.0));
    return clamp(at + direction * min(lengths.x, lengths.y), vec2f(0.0), size);
}

// The light that enters along a ray, which leaves the grid and passes a point: that of the sky without INFLOW.
fn entering_along(at: vec2f, direction: vec2f) -> vec3f {
    if !INFLOW {
        return sky(direction);
    }
    return entering_at(exit(at, direction), vec2f(sky_place(angle(direction))));
}
