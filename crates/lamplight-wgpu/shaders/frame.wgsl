// What every shader knows of a frame: `Frame` in src/frame.rs, field by field.
struct Frame {
    size: vec2u,
    number: u32,
    key: u32,
    zenith: vec3f,
    threshold: f32,
    horizon: vec3f,
    multiplier: f32,
    ground: vec3f,
    wall_depth: f32,
    rays: u32,
    steps: u32,
    noise: u32,
    gap: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;

// What a cell is to a ray, in `source.w`.
const CLEAR: f32 = 0.0;
const MEDIUM: f32 = 1.0;
const SOLID: f32 = 2.0;

fn outside(at: vec2u) -> bool {
    return any(at >= frame.size);
}

fn index(at: vec2u) -> u32 {
    return at.y * frame.size.x + at.x;
}
