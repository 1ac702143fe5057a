// The medium grid as rays of `raymarch` and `cascades` read it, and what they find where they end.

#import shared/class
#import shared/normal
#import shared/scatter
#import shared/uniforms

// True if rays report that they met matter that changed since the frame before.
override TRACKS: bool = false;

// Emitted radiance and class of each cell.
@group(0) @binding(3) var<storage, read> source: array<vec4f>;
// Scattered radiance of each of four faces; it counts from step 1 on. In `w` the kind of the scatterer.
@group(0) @binding(6) var<storage, read> scattered: array<vec4f>;
@group(0) @binding(7) var<uniform> step: u32;

// Fading of emission with distance, if it is switched on.
fn fade(radiance: vec3f, travelled: f32) -> vec3f {
    if frame.fade_range == 0.0 {
        return radiance;
    }
    let fraction = travelled / frame.fade_range;
    return radiance * pow(max(1.0 - fraction * fraction, 0.0), frame.fade_dropoff);
}

// The face (left, right, top, bottom) by which a ray that crosses an edge along an axis enters a cell.
fn face(along_x: bool, direction: vec2f) -> u32 {
    return select(2u + u32(direction.y < 0.0), u32(direction.x < 0.0), along_x);
}

// The radiance that leaves a face of a solid cell.
fn wall(i: u32, face: u32) -> vec3f {
    var radiance = source[i].rgb;
    if step > 0u {
        radiance += scattered[4u * i + face].rgb;
    }
    return radiance;
}

// Returns whether a face of a solid cell sees matter that changed.
fn wall_invalidated(i: u32, face: u32) -> bool {
    return step > 0u && scattered[4u * i + face].w >= INVALIDATED;
}

// Returns whether a face looks at a cell of the grid that is not solid.
fn exposed(at: vec2u, face: u32) -> bool {
    let front = vec2i(at) + normal(face);
    return inside(front) && class_of(source[index(vec2u(front))]) != SOLID;
}
