// What rays find where they end.

// Whether rays tell if they met matter that changed since the frame before.
override TRACKS: bool = false;

@group(0) @binding(3) var<storage, read> source: array<vec4f>;
// What surfaces send on, on each of four faces; it counts in steps after the first.
@group(0) @binding(6) var<storage, read> sent: array<vec4f>;
@group(0) @binding(7) var<uniform> step: u32;

// Seed 1's fading of emission with distance, where it is switched on.
fn fade(radiance: vec3f, travelled: f32) -> vec3f {
    if frame.fade_range == 0.0 {
        return radiance;
    }
    let share = travelled / frame.fade_range;
    return radiance * pow(max(1.0 - share * share, 0.0), frame.fade_dropoff);
}

// Left, right, top, bottom: the face by which a way along an axis enters a cell.
fn face(along_x: bool, way: vec2f) -> u32 {
    return select(2u + u32(way.y < 0.0), u32(way.x < 0.0), along_x);
}

// What a face of a wall sends out.
fn wall(i: u32, face: u32) -> vec3f {
    var radiance = source[i].rgb;
    if step > 0u {
        radiance += sent[4u * i + face].rgb;
    }
    return radiance;
}

// Whether a face of a wall sees matter that changed.
fn wall_changed(i: u32, face: u32) -> bool {
    return step > 0u && sent[4u * i + face].w >= CHANGED;
}

// Whether a face looks at a cell that is not solid.
fn exposed(at: vec2u, face: u32) -> bool {
    let open = vec2i(at) + normal(face);
    return inside(open) && source[index(vec2u(open))].w != SOLID;
}
