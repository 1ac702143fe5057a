// The mean direction from a pixel at `off` towards the part of a lamp whose middle is at a place across it, −1 to 1;
// shorter than 1, as directions to a disc differ (`shadow_map.rs` of the library).
fn towards(off: vec2f, size: f32, middle: f32) -> vec2f {
    let distance = length(off);
    if distance == 0.0 {
        return vec2f(0.0);
    }
    let k = size / distance;
    let part = middle * k;
    let way = vec2f(-off.x - part * off.y, -off.y + part * off.x);
    return way / length(way) * select(asinh(k) / k, 1.0 - k * k / 6.0, k < 0.1);
}
