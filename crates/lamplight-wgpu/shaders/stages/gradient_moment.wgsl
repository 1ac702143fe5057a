// The first moment of light by its gradient, for methods that find no light by direction (`gradient_moment.rs` of
// the library derives it).

#import shared/luminance
#import shared/moment
#import shared/solid
#import shared/uniforms

// The distance of a small light at which half of its moment is found, px.
override HALF: f32;

@group(0) @binding(2) var<storage, read_write> light: array<vec4f>;

fn brightness(at: vec2i) -> f32 {
    return luminance(light[index(vec2u(at))].rgb);
}

// The slope along an axis; beside a wall or the border that of the other side alone.
fn slope(at: vec2i, axis: vec2i) -> f32 {
    let before = select(at, at - axis, inside(at - axis) && !solid(at - axis));
    let after = select(at, at + axis, inside(at + axis) && !solid(at + axis));
    let px = dot(after - before, axis);
    return (brightness(after) - brightness(before)) / f32(max(px, 1));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let at = vec2i(id.xy);
    let i = index(id.xy);
    var gradient = vec2f(0.0);
    if !solid(at) {
        gradient = vec2f(slope(at, vec2i(1, 0)), slope(at, vec2i(0, 1)));
    }
    let own = light[i].rgb;
    let whole = max(length(gradient) + brightness(at) / HALF, 1.17549435e-38);
    light[moment_index(0u, i)] = vec4f(own * gradient.x / whole, 1.0);
    light[moment_index(1u, i)] = vec4f(own * gradient.y / whole, 1.0);
}
