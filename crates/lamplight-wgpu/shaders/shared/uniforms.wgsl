// The uniforms of a frame, bound at 0 by every shader, and indices into its grid.

// `FrameUniforms` in src/uniforms.rs, field by field.
struct FrameUniforms {
    size: vec2u,
    number: u32,
    seed: u32,
    zenith: vec3f,
    threshold: f32,
    horizon: vec3f,
    emission_multiplier: f32,
    ground: vec3f,
    wall_depth: f32,
    rays: u32,
    steps: u32,
    noise: u32,
    // Angle between neighbouring rays.
    stride: f32,
    hit_distance: f32,
    min_step: f32,
    // Distance in px at which emission has faded; 0 if it does not fade.
    fade_range: f32,
    fade_dropoff: f32,
    // The grid's first cell, in cells of the host's world.
    origin: vec2i,
    // The change of `origin` since the frame before.
    moved: vec2i,
    // The size of the grid of the frame before.
    size_before: vec2u,
    // The data that the frame may take from the frames before, a `HISTORY_` constant.
    history: u32,
    // Columns of the sky if it is a panorama, else 0; and the place of the angle 0 on its strip, in columns from the
    // middle of the first.
    sky_columns: u32,
    sky_origin: f32,
    // The tangent of the elevation of all light.
    elevation_tangent: f32,
    // The most that the first moment may have of its light: above 1 where lights have an elevation of their own.
    longest_moment: f32,
}

const HISTORY_NONE: u32 = 0u;
// Scattered radiance, but neither light nor matter: the sky or the size of the grid has changed.
const HISTORY_INDIRECT_ONLY: u32 = 1u;
const HISTORY_FULL: u32 = 2u;

@group(0) @binding(0) var<uniform> frame: FrameUniforms;

fn outside(at: vec2u) -> bool {
    return any(at >= frame.size);
}

fn inside(at: vec2i) -> bool {
    return all(at >= vec2i(0)) && !outside(vec2u(at));
}

fn index(at: vec2u) -> u32 {
    return at.y * frame.size.x + at.x;
}
