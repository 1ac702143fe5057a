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
    hit_distance: f32,
    least_step: f32,
    // px at which emission has faded; 0: it does not fade.
    fade_range: f32,
    fade_dropoff: f32,
    // Where in the host's world the grid begins.
    origin: vec2i,
    // By how many cells it has moved there since the frame before.
    moved: vec2i,
    // What is remembered of the frames before: one of the three below.
    memory: u32,
}

const NOTHING: u32 = 0u;
// What surfaces sent on, but no light and no matter: the sky is another.
const SENT: u32 = 1u;
const ALL: u32 = 2u;

@group(0) @binding(0) var<uniform> frame: Frame;

// What a cell is to a ray, in `source.w`.
const CLEAR: f32 = 0.0;
const MEDIUM: f32 = 1.0;
const SOLID: f32 = 2.0;

// What sends light on, in `sent.w`; CHANGED more where it sees matter that changed.
const FACE: f32 = 1.0;
const VOLUME: f32 = 2.0;
const CHANGED: f32 = 4.0;

// What a cell is to a ray of a lamp, in two bits.
const EMPTY: u32 = 0u;
const FOG: u32 = 1u;
const WALL: u32 = 2u;
const BEYOND: u32 = 3u;

// Whether light notices what has this tint and opacity.
fn occupied(tint_opacity: vec4f) -> bool {
    return tint_opacity.a > frame.threshold || any(tint_opacity.rgb != vec3f(1.0));
}

fn outside(at: vec2u) -> bool {
    return any(at >= frame.size);
}

fn inside(at: vec2i) -> bool {
    return all(at >= vec2i(0)) && !outside(vec2u(at));
}

fn index(at: vec2u) -> u32 {
    return at.y * frame.size.x + at.x;
}
