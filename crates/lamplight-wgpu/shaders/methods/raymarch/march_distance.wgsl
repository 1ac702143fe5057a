// Sphere tracing by the distance field, and with it `raymarch` by distance: a ray steps by the distance
// until that falls below `hit_distance`. Near matter it goes from cell edge to cell edge, so that it steps
// over no occupied cell.

#import methods/raymarch/gather
#import shared/class
#import shared/inflow
#import shared/surfaces
#import shared/uniforms

override NEVER: f32;
override NO_SEED: u32;
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

// The radiance that leaves an occupied cell by a face.
fn touch(cell: vec2u, face: u32, travelled: f32) -> vec4f {
    let i = index(cell);
    if class_of(source[i]) == SOLID {
        return vec4f(fade(wall(i, face), travelled), 0.0);
    }
    return vec4f(fade(source[i].rgb, travelled), 0.0);
}

// Radiance that arrives along a ray that starts in an open cell; a ray from a face first has to leave its
// wall. Changes are not detected: steps pass over cells that changed and are empty now.
fn march(start: vec2f, first: vec2f, direction: vec2f, from_face: bool) -> vec4f {
    let inverse = 1.0 / select(direction, vec2f(NEVER), abs(direction) < vec2f(NEVER));
    let ahead = select(vec2i(0), vec2i(1), direction >= vec2f(0.0));
    let sign = select(vec2i(1), vec2i(-1), direction < vec2f(0.0));
    var at = start;
    var cell = vec2i(first);
    var travelled = 0.0;
    var away = !from_face;
    for (var steps = 0u; steps < frame.steps; steps++) {
        if !inside(cell) || nearest[index(vec2u(cell))] == NO_SEED {
            return vec4f(entering_along(at, direction), 0.0);
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
        var advance = max(close, frame.min_step);
        if clear >= frame.min_step {
            advance = min(close, clear);
        }
        let to = at + direction * advance;
        if advance <= clear {
            cell = vec2i(floor(to));
        } else {
            // Edge by edge, so that rounding does not decide in which cell it ends.
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
                    return touch(vec2u(cell), face(along_x, direction), travelled);
                }
            }
        }
        travelled += advance;
        at = to;
    }
    return vec4f(0.0);
}
