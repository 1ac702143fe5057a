// The class of a cell: `CellClass` of the library's `grid/class.rs`.

#import shared/uniforms

const EMPTY: u32 = 0u;
const MEDIUM: u32 = 1u;
const SOLID: u32 = 2u;
// Beyond the grid.
const OUTSIDE: u32 = 3u;

// Returns whether a cell of this tint and opacity interacts with light. Opacities up to `threshold` count as 0.
fn interacts(tint_opacity: vec4f, threshold: f32) -> bool {
    return tint_opacity.a > threshold || any(tint_opacity.rgb != vec3f(1.0));
}

// Returns whether a cell of this tint and opacity interacts with light in this frame.
fn occupied(tint_opacity: vec4f) -> bool {
    return interacts(tint_opacity, frame.threshold);
}

// The class of a cell of this tint and opacity. Opacities up to `threshold` count as 0.
fn classify(tint_opacity: vec4f, threshold: f32) -> u32 {
    if tint_opacity.a >= 1.0 {
        return SOLID;
    }
    return select(EMPTY, MEDIUM, interacts(tint_opacity, threshold));
}

// The class that the medium grid keeps beside the emitted radiance of a cell.
fn class_of(source: vec4f) -> u32 {
    return u32(source.w);
}
