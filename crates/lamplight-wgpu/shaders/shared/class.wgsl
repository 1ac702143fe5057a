// The class of a cell: `CellClass` of the library's `grid/class.rs`.

#import shared/uniforms

const EMPTY: u32 = 0u;
const MEDIUM: u32 = 1u;
const SOLID: u32 = 2u;
// Beyond the grid.
const OUTSIDE: u32 = 3u;

// Returns whether a cell of this tint and opacity interacts with light.
fn occupied(tint_opacity: vec4f) -> bool {
    return tint_opacity.a > frame.threshold || any(tint_opacity.rgb != vec3f(1.0));
}

// The class that the medium grid keeps beside the emitted radiance of a cell.
fn class_of(source: vec4f) -> u32 {
    return u32(source.w);
}
