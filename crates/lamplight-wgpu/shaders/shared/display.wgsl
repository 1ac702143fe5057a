// The displayed picture: colour × light, plus emission, exposed, tone mapped, and encoded unless the target
// encodes. The formulas are those of `display.rs` of the library.
// Shaders that import it declare `light_at`: the light of a cell, or a component of its first moment behind that of all cells.

#import shared/luminance
#import shared/uniforms

const WHITE: u32 = 0u;
const OF_CELLS: u32 = 1u;
const OVER_VIEW: u32 = 2u;
const UNDER_TARGET: u32 = 3u;

// What normals belong to.
const NO_NORMALS: u32 = 0u;
const NORMALS_OF_CELLS: u32 = 1u;
const NORMALS_OF_COLOR: u32 = 2u;

const REINHARD: u32 = 1u;
const ACES: u32 = 2u;
const AGX: u32 = 3u;

// `ComposeUniforms` in src/stages/display.rs, field by field.
struct ComposeUniforms {
    // The visible part of the grid, in cells: its corner, and its edges from there to the right and down.
    corner: vec2f,
    right: vec2f,
    down: vec2f,
    gain: f32,
    brightest: f32,
    luma: vec3f,
    aces_end: f32,
    // Light that arrives everywhere, whatever the normal.
    ambient: vec3f,
    aces_white: f32,
    // a, b, c, d of x(ax + b) / (x(cx + d) + e).
    aces: vec4f,
    stops: vec2f,
    // Of the elevation of light.
    cotangent: f32,
    // Strength and exponent of highlights.
    specular: f32,
    // Columns.
    inset: mat3x3f,
    outset: mat3x3f,
    // Coefficients of x⁶ … x³, then x² … x⁰ and the display's gamma.
    contrast: array<vec4f, 2>,
    // Gain, power and saturation.
    look: vec3f,
    exponent: f32,
}

// The picture that is drawn, `Drawn` in src/stages/display.rs. These are constants because software GPUs take both
// sides of a branch.
override TONEMAP: u32;
// False: each pixel shows the cell it lies in.
override FILTERED: bool;
override COLOR_FROM: u32;
// True if the colour has an emission of its own, which replaces that of the cells.
override COLOR_EMITS: bool;
// True if light is added to the grid's.
override MORE_LIGHT: bool;
// True if the emission that is seen is not that of the matter.
override HAS_SHOWN: bool;
override NORMALS: u32;
// True if there are highlights.
override SHINES: bool;
// True if the shader encodes, because the target does not.
override ENCODE: bool;
override STRAIGHT: f32;
override SLOPE: f32;
override OFFSET: f32;
override GAMMA: f32;
// The least light ÷ the length of its moment that counts for highlights.
override LEAST_LIGHT: f32;

@group(0) @binding(1) var<uniform> params: ComposeUniforms;
@group(0) @binding(3) var emission: texture_2d<f32>;
@group(0) @binding(4) var matter: texture_2d<f32>;
@group(0) @binding(5) var color: texture_2d<f32>;
@group(0) @binding(6) var color_emission: texture_2d<f32>;
@group(0) @binding(7) var more: texture_2d<f32>;
@group(0) @binding(8) var shown: texture_2d<f32>;
@group(0) @binding(9) var normals: texture_2d<f32>;

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

// The texel of a picture as large as the target, at a pixel.
fn under_target(seen: Seen, picture: texture_2d<f32>) -> vec4f {
    return textureLoad(picture, min(vec2u(seen.position.xy), textureDimensions(picture) - 1u), 0);
}

// The texel of a picture over the viewport, at a pixel.
fn over_view(seen: Seen, picture: texture_2d<f32>) -> vec4f {
    let size = textureDimensions(picture);
    return textureLoad(picture, min(vec2u(seen.across * vec2f(size)), size - 1u), 0);
}

// The colour at a pixel, unless it is given per cell.
fn colored(seen: Seen) -> vec4f {
    if COLOR_FROM == UNDER_TARGET {
        return under_target(seen, color);
    }
    if COLOR_FROM == OVER_VIEW {
        return over_view(seen, color);
    }
    return vec4f(1.0);
}

// The unit normal of a texel; the viewer's direction where there is none.
fn normal_of(texel: vec4f) -> vec3f {
    let length = length(texel.xyz);
    return select(texel.xyz / length, vec3f(0.0, 0.0, 1.0), length < 1e-3);
}

// A light and a highlight: of a tilted surface (`relief.rs` of the library).
struct Shade {
    received: vec3f,
    highlight: vec3f,
}

fn shade(normal: vec3f, arrives: vec3f, moment: array<vec3f, 2>) -> Shade {
    let sides = normal.x * moment[0] + normal.y * moment[1];
    let received = max(normal.z * arrives + params.cotangent * sides, vec3f(0.0));
    let way = vec2f(luminance(moment[0]), luminance(moment[1]));
    let length = length(way);
    if !SHINES || length == 0.0 {
        return Shade(received, vec3f(0.0));
    }
    let up = clamp(luminance(arrives) / length, LEAST_LIGHT, 1.0);
    let to_light = normalize(vec3f(params.cotangent * way / length, up));
    let halfway = normalize(to_light + vec3f(0.0, 0.0, 1.0));
    let power = params.exponent;
    let lobe = pow(clamp(dot(normal, halfway), 0.0, 1.0), power) * max(dot(normal, to_light), 0.0);
    let gain = params.specular * (power + 8.0) / 8.0 * lobe / to_light.z;
    let lengths = sqrt(moment[0] * moment[0] + moment[1] * moment[1]);
    return Shade(received, gain * min(lengths, arrives));
}

// Light that arrives at a cell, its emitted radiance, its highlight, and the first moment of the light if a normal
// needs it.
struct Radiance {
    arrives: vec3f,
    emitted: vec3f,
    highlight: vec3f,
    moment: array<vec3f, 2>,
}

// Cells beyond the grid are shown like those at its edge.
fn radiance(near: vec2i) -> Radiance {
    let at = vec2u(clamp(near, vec2i(0), vec2i(frame.size) - 1));
    let tint_opacity = textureLoad(matter, at, 0);
    let own = textureLoad(emission, at, 0).rgb;
    let i = index(at);
    var seen = Radiance();
    seen.arrives = light_at(i);
    seen.emitted = own;
    if tint_opacity.a >= 1.0 {
        // The light of solid cells includes their emission.
        seen.arrives = max(seen.arrives - own, vec3f(0.0));
    } else {
        seen.emitted *= 1.0 - (1.0 - tint_opacity.a) * tint_opacity.rgb;
    }
    if HAS_SHOWN {
        seen.emitted = textureLoad(shown, at, 0).rgb;
    }
    if MORE_LIGHT {
        seen.arrives += textureLoad(more, at, 0).rgb;
    }
    if NORMALS != NO_NORMALS {
        let cells = frame.size.x * frame.size.y;
        seen.moment = array(light_at(cells + i), light_at(2u * cells + i));
    }
    if NORMALS == NORMALS_OF_CELLS {
        let shade = shade(normal_of(textureLoad(normals, at, 0)), seen.arrives, seen.moment);
        seen.arrives = shade.received;
        seen.highlight = shade.highlight;
    }
    if NORMALS != NORMALS_OF_COLOR {
        seen.arrives += params.ambient;
    }
    if COLOR_FROM == OF_CELLS {
        seen.arrives *= textureLoad(color, at, 0).rgb;
    }
    return seen;
}

fn mixed(a: Radiance, b: Radiance, weight: f32) -> Radiance {
    return Radiance(
        mix(a.arrives, b.arrives, weight),
        mix(a.emitted, b.emitted, weight),
        mix(a.highlight, b.highlight, weight),
        array(mix(a.moment[0], b.moment[0], weight), mix(a.moment[1], b.moment[1], weight)),
    );
}

// Bilinear interpolation between cell centres.
fn between(place: vec2f) -> Radiance {
    let low = floor(place - 0.5);
    let past = place - 0.5 - low;
    let at = vec2i(low);
    let above = mixed(radiance(at), radiance(at + vec2i(1, 0)), past.x);
    let below = mixed(radiance(at + vec2i(0, 1)), radiance(at + vec2i(1, 1)), past.x);
    return mixed(above, below, past.y);
}

fn aces_curve(x: vec3f) -> vec3f {
    let a = params.aces;
    return clamp((x * (a.x * x + a.y)) / (x * (a.z * x + a.w) + params.aces_end), vec3f(0.0), vec3f(1.0));
}

fn aces(rgb: vec3f) -> vec3f {
    let luma = dot(rgb, params.luma);
    let white = min(luma * luma / (params.aces_white + luma), 1.0);
    return mix(aces_curve(rgb), aces_curve(vec3f(luma)), white);
}

fn agx(rgb: vec3f) -> vec3f {
    let radiance = params.inset * (params.look.x * rgb);
    let stops = log2(clamp(radiance, vec3f(exp2(params.stops.x)), vec3f(exp2(params.stops.y))));
    let x = (stops - params.stops.x) / (params.stops.y - params.stops.x);
    let high = params.contrast[0];
    let low = params.contrast[1];
    let curve = (((((high.x * x + high.y) * x + high.z) * x + high.w) * x + low.x) * x + low.y) * x + low.z;
    let powered = pow(max(curve, vec3f(0.0)), vec3f(params.look.y));
    let looked = mix(vec3f(dot(powered, params.luma)), powered, params.look.z);
    return pow(max(params.outset * looked, vec3f(0.0)), vec3f(low.w));
}

fn encoded(linear: vec3f) -> vec3f {
    let curve = (1.0 + OFFSET) * pow(linear, vec3f(1.0 / GAMMA)) - OFFSET;
    return select(curve, linear * SLOPE, linear <= vec3f(STRAIGHT));
}

@fragment
fn show(seen: Seen) -> @location(0) vec4f {
    let place = params.corner + seen.across.x * params.right + seen.across.y * params.down;
    var cell: Radiance;
    if FILTERED {
        cell = between(place);
    } else {
        cell = radiance(vec2i(floor(place)));
    }
    let falls_on = colored(seen);
    if NORMALS == NORMALS_OF_COLOR {
        var texel: vec4f;
        if COLOR_FROM == UNDER_TARGET {
            texel = under_target(seen, normals);
        } else {
            texel = over_view(seen, normals);
        }
        let shade = shade(normal_of(texel), cell.arrives, cell.moment);
        // Ambient light has no direction: no normal changes it.
        cell.arrives = shade.received + params.ambient;
        cell.highlight = shade.highlight;
    }
    var rgb: vec3f;
    if COLOR_EMITS {
        rgb = falls_on.rgb * (cell.arrives + under_target(seen, color_emission).rgb);
    } else {
        rgb = falls_on.rgb * cell.arrives + cell.emitted;
    }
    rgb += cell.highlight;
    rgb = clamp(rgb * params.gain, vec3f(0.0), vec3f(params.brightest));
    if TONEMAP == REINHARD {
        rgb = rgb / (1.0 + rgb);
    } else if TONEMAP == ACES {
        rgb = min(aces(rgb), vec3f(1.0));
    } else if TONEMAP == AGX {
        rgb = min(agx(rgb), vec3f(1.0));
    }
    if ENCODE {
        rgb = encoded(rgb);
    }
    return vec4f(rgb, select(1.0, falls_on.a, COLOR_FROM == UNDER_TARGET));
}
