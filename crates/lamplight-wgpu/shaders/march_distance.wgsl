// The march of the seeds: steps by the distance field until it falls under `hit_distance`. Near matter
// steps go from cell edge to cell edge, so that no occupied cell is stepped over.

override NEVER: f32;
override NONE: u32;
override MARGIN: f32;

@group(0) @binding(4) var<storage, read> nearest: array<u32>;
@group(0) @binding(5) var<storage, read> distance: array<f32>;

// The distance field between cell centres.
fn distance_at(at: vec2f) -> f32 {
    let corner = floor(at - 0.5);
    let past = at - 0.5 - corner;
    let last = vec2i(frame.size) - 1;
    let low = vec2u(clamp(vec2i(corner), vec2i(0), last));
    let high = vec2u(clamp(vec2i(corner) + 1, vec2i(0), last));
    let above = distance[index(low)] * (1.0 - past.x)
        + distance[index(vec2u(high.x, low.y))] * past.x;
    let below = distance[index(vec2u(low.x, high.y))] * (1.0 - past.x)
        + distance[index(high)] * past.x;
    return above * (1.0 - past.y) + below * past.y;
}

// What an occupied cell sends out on the side of a face.
fn touch(cell: vec2u, face: u32, travelled: f32) -> vec4f {
    let i = index(cell);
    if source[i].w == SOLID {
        return vec4f(fade(wall(i, face), travelled), 0.0);
    }
    return vec4f(fade(source[i].rgb, travelled), 0.0);
}

// Radiance that arrives along a ray that starts in an open cell; one from a face first has to leave
// its wall. Changes are not looked for: leaps pass over cells that changed and are empty now.
fn march(start: vec2f, first: vec2f, way: vec2f, from_face: bool) -> vec4f {
    let inverse = 1.0 / select(way, vec2f(NEVER), abs(way) < vec2f(NEVER));
    let ahead = select(vec2i(0), vec2i(1), way >= vec2f(0.0));
    let sign = select(vec2i(1), vec2i(-1), way < vec2f(0.0));
    var at = start;
    var cell = vec2i(first);
    var travelled = 0.0;
    var away = !from_face;
    for (var leap = 0u; leap < frame.steps; leap++) {
        if !inside(cell) || nearest[index(vec2u(cell))] == NONE {
            return vec4f(sky(way.y), 0.0);
        }
        let i = index(vec2u(cell));
        let close = distance_at(at);
        let near = close < frame.hit_distance;
        if away && near {
            let other = vec2u(nearest[i] & 0xffffu, nearest[i] >> 16u);
            let offset = vec2i(other) - cell;
            let along_x = abs(offset.x) >= abs(offset.y);
            return touch(other, face(along_x, vec2f(offset)), travelled);
        }
        away = away || !near;
        let clear = distance[i] - MARGIN;
        var advance = max(close, frame.least_step);
        if clear >= frame.least_step {
            advance = min(close, clear);
        }
        let to = at + way * advance;
        if advance <= clear {
            cell = vec2i(floor(to));
        } else {
            // Edge by edge; which cell it ends in is not decided by rounding.
            loop {
                let t = (vec2f(cell + ahead) - at) * inverse;
                let along_x = t.x < t.y;
                if min(t.x, t.y) >= advance {
                    break;
                }
                cell += select(vec2i(0, sign.y), vec2i(sign.x, 0), along_x);
                if !inside(cell) {
                    break;
                }
                if distance[index(vec2u(cell))] == 0.0 {
                    return touch(vec2u(cell), face(along_x, way), travelled);
                }
            }
        }
        travelled += advance;
        at = to;
    }
    return vec4f(0.0);
}
