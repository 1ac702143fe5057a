// What is seen: colour × light and what glows, exposed, tone mapped, and encoded where the target
// does not do so itself. The formulas are those of `stages/display.rs` of the library.

const NEAREST: u32 = 0u;

const WHITE: u32 = 0u;
const OF_CELLS: u32 = 1u;
const OVER_VIEW: u32 = 2u;
const UNDER_TARGET: u32 = 3u;

const REINHARD: u32 = 1u;
const ACES: u32 = 2u;
const AGX: u32 = 3u;

// `Look` in src/stages/display.rs, field by field.
struct Look {
    // What of the grid is seen, in cells: left and top, and from there to the right and down.
    corner: vec2f,
    right: vec2f,
    down: vec2f,
    gain: f32,
    tonemap: u32,
    filter_light: u32,
    color_from: u32,
    // Whether the colour's own glow is given, which is then shown instead of the cells'.
    color_glows: u32,
    // Whether there is light besides the grid's.
    more_light: u32,
    luma: vec3f,
    brightest: f32,
    // Arrives everywhere.
    ambient: vec3f,
    keep_alpha: u32,
    // a, b, c, d of x(ax + b) / (x(cx + d) + e).
    aces: vec4f,
    aces_end: f32,
    aces_white: f32,
    stops: vec2f,
    // Columns.
    inset: mat3x3f,
    outset: mat3x3f,
    // Coefficients of x⁶ … x³, then x² … x⁰ and the display's gamma.
    contrast: array<vec4f, 2>,
}

// Whether the target stores what it is given, and does not encode it.
override ENCODE: bool;
override STRAIGHT: f32;
override SLOPE: f32;
override OFFSET: f32;
override GAMMA: f32;

@group(0) @binding(1) var<uniform> look: Look;
@group(0) @binding(2) var<storage, read> light: array<vec4f>;
@group(0) @binding(3) var emission: texture_2d<f32>;
@group(0) @binding(4) var matter: texture_2d<f32>;
@group(0) @binding(5) var color: texture_2d<f32>;
@group(0) @binding(6) var color_glow: texture_2d<f32>;
@group(0) @binding(7) var more: texture_2d<f32>;

struct Seen {
    @builtin(position) position: vec4f,
    // Across the viewport, 0 to 1, y down.
    @location(0) across: vec2f,
}

// One triangle that covers the viewport.
@vertex
fn cover(@builtin(vertex_index) corner: u32) -> Seen {
    let across = vec2f(f32(corner & 1u), f32(corner >> 1u)) * 2.0;
    return Seen(vec4f(across.x * 2.0 - 1.0, 1.0 - across.y * 2.0, 0.0, 1.0), across);
}

// The texel of a pixel, of a picture as large as the target.
fn under_target(seen: Seen, picture: texture_2d<f32>) -> vec4f {
    return textureLoad(picture, min(vec2u(seen.position.xy), textureDimensions(picture) - 1u), 0);
}

// What light falls on, where that is not given by cells.
fn colored(seen: Seen) -> vec4f {
    if look.color_from == UNDER_TARGET {
        return under_target(seen, color);
    }
    if look.color_from == OVER_VIEW {
        let size = textureDimensions(color);
        let at = min(vec2u(seen.across * vec2f(size)), size - 1u);
        return textureLoad(color, at, 0);
    }
    return vec4f(1.0);
}

// What falls on a cell, and what it gives off.
struct Radiance {
    arrives: vec3f,
    glow: vec3f,
}

// Cells beyond the grid look as those at its edge.
fn radiance(near: vec2i) -> Radiance {
    let at = vec2u(clamp(near, vec2i(0), vec2i(frame.size) - 1));
    let tint_opacity = textureLoad(matter, at, 0);
    let own = textureLoad(emission, at, 0).rgb;
    var seen = Radiance(light[index(at)].rgb, own);
    if tint_opacity.a >= 1.0 {
        // The light of walls holds what they give off.
        seen.arrives = max(seen.arrives - own, vec3f(0.0));
    } else {
        seen.glow *= 1.0 - (1.0 - tint_opacity.a) * tint_opacity.rgb;
    }
    if look.more_light != 0u {
        seen.arrives += textureLoad(more, at, 0).rgb;
    }
    seen.arrives += look.ambient;
    if look.color_from == OF_CELLS {
        seen.arrives *= textureLoad(color, at, 0).rgb;
    }
    return seen;
}

fn mixed(a: Radiance, b: Radiance, share: f32) -> Radiance {
    return Radiance(mix(a.arrives, b.arrives, share), mix(a.glow, b.glow, share));
}

// Between the four nearest cell centres.
fn between(place: vec2f) -> Radiance {
    let low = floor(place - 0.5);
    let past = place - 0.5 - low;
    let at = vec2i(low);
    let above = mixed(radiance(at), radiance(at + vec2i(1, 0)), past.x);
    let below = mixed(radiance(at + vec2i(0, 1)), radiance(at + vec2i(1, 1)), past.x);
    return mixed(above, below, past.y);
}

fn aces_curve(x: vec3f) -> vec3f {
    let a = look.aces;
    return clamp((x * (a.x * x + a.y)) / (x * (a.z * x + a.w) + look.aces_end), vec3f(0.0), vec3f(1.0));
}

fn aces(rgb: vec3f) -> vec3f {
    let luma = dot(rgb, look.luma);
    let white = min(luma * luma / (look.aces_white + luma), 1.0);
    return mix(aces_curve(rgb), aces_curve(vec3f(luma)), white);
}

fn agx(rgb: vec3f) -> vec3f {
    let stops = log2(clamp(look.inset * rgb, vec3f(exp2(look.stops.x)), vec3f(exp2(look.stops.y))));
    let x = (stops - look.stops.x) / (look.stops.y - look.stops.x);
    let high = look.contrast[0];
    let low = look.contrast[1];
    let curve = (((((high.x * x + high.y) * x + high.z) * x + high.w) * x + low.x) * x + low.y) * x + low.z;
    return pow(max(look.outset * curve, vec3f(0.0)), vec3f(low.w));
}

fn encoded(linear: vec3f) -> vec3f {
    let curve = (1.0 + OFFSET) * pow(linear, vec3f(1.0 / GAMMA)) - OFFSET;
    return select(curve, linear * SLOPE, linear <= vec3f(STRAIGHT));
}

@fragment
fn show(seen: Seen) -> @location(0) vec4f {
    let place = look.corner + seen.across.x * look.right + seen.across.y * look.down;
    var cell: Radiance;
    if look.filter_light == NEAREST {
        cell = radiance(vec2i(floor(place)));
    } else {
        cell = between(place);
    }
    let falls_on = colored(seen);
    var rgb: vec3f;
    if look.color_glows != 0u {
        rgb = falls_on.rgb * (cell.arrives + under_target(seen, color_glow).rgb);
    } else {
        rgb = falls_on.rgb * cell.arrives + cell.glow;
    }
    rgb = clamp(rgb * look.gain, vec3f(0.0), vec3f(look.brightest));
    if look.tonemap == REINHARD {
        rgb = rgb / (1.0 + rgb);
    } else if look.tonemap == ACES {
        rgb = min(aces(rgb), vec3f(1.0));
    } else if look.tonemap == AGX {
        rgb = min(agx(rgb), vec3f(1.0));
    }
    if ENCODE {
        rgb = encoded(rgb);
    }
    return vec4f(rgb, select(1.0, falls_on.a, look.keep_alpha != 0u));
}
