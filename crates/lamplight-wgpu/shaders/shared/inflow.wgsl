// Light that enters a grid by place on its border and by direction (crates/lamplight/src/inflow.rs). Each border cell has
// a strip of columns in `panorama`.

#import shared/sky
#import shared/uniforms

// The mean light between two columns at a place along a side: 0 for the top, 1 for the right, 2 for the bottom, 3 for the
// left.
fn entering(side: u32, along: f32, columns: vec2f) -> vec3f {
    let odd = side & 1u;
    let count = frame.size[odd];
    let first = odd * frame.size.x + (side >> 1u) * (frame.size.x + frame.size.y);
    let at = clamp(along - 0.5, 0.0, f32(count - 1u));
    let before = min(u32(at), max(count, 2u) - 2u);
    let past = at - f32(before);
    let one = mean_of_columns(first + before, columns);
    if past == 0.0 {
        return one;
    }
    return mix(one, mean_of_columns(first + before + 1u, columns), past);
}
