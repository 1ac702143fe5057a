// The mean direction from a pixel at `off` towards the part of a lamp whose middle is at a place across it, −1 to 1;
// shorter than 1, as directions to a disc differ (`shadow_map.rs` of the library), and weighted by the elevation of the
// lamp's light (`elevation.rs`).

#import shared/lamps
#import shared/uniforms

fn towards(lamp: Lamp, off: vec2f, middle: f32) -> vec2f {
    let distance = length(off);
    if distance == 0.0 {
        return vec2f(0.0);
    }
    let k = lamp.size / distance;
    let part = middle * k;
    let way = vec2f(-off.x - part * off.y, -off.y + part * off.x);
    var weight = select(asinh(k) / k, 1.0 - k * k / 6.0, k < 0.1);
    if lamp.height > 0.0 {
        // The longest moment of all lights bounds that of each.
        weight *= min(distance / lamp.height * frame.elevation_tangent, frame.longest_moment);
    }
    return way / length(way) * weight;
}
