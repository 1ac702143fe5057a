// Visibility from viewers (`stages/sight.rs` of the library): of each cell the largest of all viewers, 0 to 1. Without a
// shadow map: a cell goes through the blocks of cells between itself and the eye.

#import methods/polar/penumbra
#import shared/angle
#import shared/class
#import shared/class_at
#import shared/cone
#import shared/luminance
#import shared/normal
#import shared/uniforms

struct Sight {
    position: vec2f,
    range: f32,
    // The part of the range over which sight fades, px.
    soft: f32,
    // As shared/cone.wgsl reads it.
    cone: vec3f,
    size: f32,
}

struct Sights {
    count: u32,
    list: array<Sight>,
}

@group(0) @binding(1) var<storage, read> sights: Sights;
@group(0) @binding(4) var<storage, read_write> visibility: array<f32>;

// The visibility without walls and media: the cone, and the soft end of the range.
fn share(sight: Sight, off: vec2f) -> f32 {
    let distance = length(off);
    if distance == 0.0 {
        return 1.0;
    }
    let left = sight.range - distance;
    if left <= 0.0 {
        return 0.0;
    }
    let t = min(left / max(sight.soft, MIN_POSITIVE), 1.0);
    return t * t * (3.0 - 2.0 * t) * cone_share(sight.cone, angle(off));
}

// The visibility of a place in the open.
fn visibility_at(sight: Sight, off: vec2f) -> f32 {
    let eye = LampDisc(sight.position, sight.size);
    let most = share(sight, off);
    if most == 0.0 || all(off == vec2f(0.0)) {
        return most;
    }
    hide_from(eye, off);
    // Rounding may find more than all of an eye that reaches over the border.
    let found = most * min(seen(), 1.0);
    if found == 0.0 || !meets_media {
        return found;
    }
    return found * luminance(through_media_to_lamp(eye, off));
}

// The direction to a cell that touches another by a corner only.
fn diagonal(i: u32) -> vec2i {
    return 2 * vec2i(i32(i & 1u), i32(i >> 1u)) - 1;
}

// The visibility of a solid cell: of the best seen of its faces, or of its corners if it has no face.
fn visibility_of_wall(sight: Sight, cell: vec2i) -> f32 {
    let has_face = exposed_faces(cell) != 0u;
    var best = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let way = select(diagonal(i), normal(i), has_face);
        let point = vec2f(cell) + 0.5 + (0.5 + OUTSIDE_OF_WALL) * vec2f(way);
        let off = point - sight.position;
        // No part of an eye behind a face is seen from there.
        if open(cell + way) && dot(off, vec2f(way)) < sight.size * length(vec2f(way)) {
            best = max(best, visibility_at(sight, off));
        }
    }
    return best;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let cell = vec2i(id.xy);
    let is_wall = class_at(cell) == SOLID;
    var best = 0.0;
    for (var i = 0u; i < sights.count && best < 1.0; i++) {
        let sight = sights.list[i];
        // An eye in a wall sees nothing.
        if class_at(vec2i(floor(sight.position))) == SOLID {
            continue;
        }
        if is_wall {
            best = max(best, visibility_of_wall(sight, cell));
        } else {
            best = max(best, visibility_at(sight, vec2f(cell) + 0.5 - sight.position));
        }
    }
    visibility[index(id.xy)] = best;
}
