// Pieces of matter, drawn on the lit grid or, where they glow, on the screen.

const CIRCLE: u32 = 1u;
const CAPSULE: u32 = 2u;
const TRIANGLE: u32 = 3u;
const LAMP: u32 = 4u;

// `Stage` in src/render/stage.rs: from cells to the target.
struct Stage {
    x_axis: vec2f,
    y_axis: vec2f,
    origin: vec2f,
    // Pixels of the target.
    size: vec2f,
    // World units a cell.
    cell: f32,
}

// `Piece` in src/pieces/piece.rs, on the grid: cells, y down.
struct Piece {
    x_axis: vec2f,
    y_axis: vec2f,
    origin: vec2f,
    texels_x: vec2f,
    texels_y: vec2f,
    texels_origin: vec2f,
    color: vec4f,
    substance: u32,
    shape: u32,
    layer: u32,
    param: f32,
}

// `Substance` in src/pieces/substance.rs.
struct Substance {
    emission: vec3f,
    opacity: f32,
    tint: vec3f,
    glow: f32,
    albedo: vec3f,
}

@group(0) @binding(0) var<uniform> stage: Stage;
@group(0) @binding(1) var<storage, read> pieces: array<Piece>;
@group(0) @binding(2) var<storage, read> substances: array<Substance>;
@group(1) @binding(0) var picture: texture_2d_array<f32>;
@group(1) @binding(1) var picture_sampler: sampler;

struct Drawn {
    @builtin(position) position: vec4f,
    // On the piece's unit square.
    @location(0) unit: vec2f,
    @location(1) @interpolate(flat) number: u32,
    // Of a lamp: its middle and its radius, in pixels of the target.
    @location(2) @interpolate(flat) disc: vec3f,
}

fn clip(place: vec2f) -> vec2f {
    return place.x * stage.x_axis + place.y * stage.y_axis + stage.origin;
}

fn pixel(place: vec2f) -> vec2f {
    return (clip(place) * vec2f(0.5, -0.5) + 0.5) * stage.size;
}

// Two triangles that cover the unit square; one and a half nothing for a triangle.
@vertex
fn place(@builtin(vertex_index) vertex: u32, @builtin(instance_index) number: u32) -> Drawn {
    let corners = array(
        vec2f(0.0, 0.0), vec2f(1.0, 0.0), vec2f(0.0, 1.0),
        vec2f(1.0, 0.0), vec2f(1.0, 1.0), vec2f(0.0, 1.0),
    );
    let piece = pieces[number];
    var unit = corners[vertex];
    var disc = vec3f(0.0);
    if piece.shape == TRIANGLE && vertex >= 3u {
        unit = vec2f(0.0);
    }
    if piece.shape == LAMP {
        let middle = pixel(piece.origin + 0.5 * (piece.x_axis + piece.y_axis));
        disc = vec3f(middle, 0.5 * distance(pixel(piece.origin), pixel(piece.origin + piece.x_axis)));
        // Every pixel that it touches, not only those whose centre it covers.
        unit += (unit - 0.5) * 1.5 / max(disc.z, 1e-3);
    }
    let at = piece.origin + unit.x * piece.x_axis + unit.y * piece.y_axis;
    return Drawn(vec4f(clip(at), 0.0, 1.0), unit, number, disc);
}

// A disc's half chord, integrated from its middle: ∫₀ᵗ √(r² − s²) ds.
fn integral(t: f32, r: f32) -> f32 {
    return 0.5 * (t * sqrt(max(r * r - t * t, 0.0)) + r * r * asin(clamp(t / r, -1.0, 1.0)));
}

// Area of a disc round the origin that lies left of x and above y; as `coverage.rs` of the library.
fn corner_area(place: vec2f, r: f32) -> f32 {
    let at = clamp(place, vec2f(-r), vec2f(r));
    let a = vec2f(integral(at.x, r), integral(at.y, r));
    let quarter = 0.7853981634 * r * r;
    if dot(at, at) < r * r {
        return quarter + at.x * at.y + a.x + a.y;
    }
    if at.x >= 0.0 {
        return select(2.0 * (quarter + a.y), 2.0 * (a.x + a.y), at.y >= 0.0);
    }
    return select(0.0, 2.0 * (quarter + a.x), at.y >= 0.0);
}

// Shares nearer than this to 0 or 1 are rounding.
const ROUNDING: f32 = 1e-4;

// Share of a pixel that a disc covers.
fn disc_share(disc: vec3f, center: vec2f) -> f32 {
    let low = center - 0.5 - disc.xy;
    let high = low + 1.0;
    let area = corner_area(high, disc.z) - corner_area(vec2f(low.x, high.y), disc.z)
        - corner_area(vec2f(high.x, low.y), disc.z) + corner_area(low, disc.z);
    return select(select(area, 1.0, area > 1.0 - ROUNDING), 0.0, area < ROUNDING);
}

// Colour of a piece, and the share of the pixel that it covers.
fn shown(in: Drawn) -> vec4f {
    let piece = pieces[in.number];
    let texel = piece.texels_origin + in.unit.x * piece.texels_x + in.unit.y * piece.texels_y;
    var color = textureSampleLevel(picture, picture_sampler, texel, piece.layer, 0.0) * piece.color;
    let from_middle = in.unit - 0.5;
    if piece.shape == CIRCLE {
        color.a *= f32(dot(from_middle, from_middle) <= 0.25);
    } else if piece.shape == CAPSULE {
        let across = 2.0 * abs(from_middle) * vec2f(piece.param, 1.0);
        let past = vec2f(across.x, max(across.y - (1.0 - piece.param), 0.0));
        color.a *= f32(length(past) <= piece.param);
    } else if piece.shape == LAMP {
        color.a *= disc_share(in.disc, in.position.xy);
    } else if piece.param < 0.0 {
        color.a = 1.0;
    } else if piece.param > 0.0 {
        color.a = f32(color.a >= piece.param);
    }
    return clamp(color, vec4f(0.0), vec4f(65504.0, 65504.0, 65504.0, 1.0));
}

// Sums over all that lies in a cell, each covered by what lies above it. Emission and albedo count by
// the opacity that they bring, as `Matter::over` of the library.
struct Matter {
    @location(0) emission: vec4f,
    @location(1) albedo: vec4f,
    @location(2) tint: vec4f,
    @location(3) opacity: vec4f,
}

@fragment
fn matter(in: Drawn) -> Matter {
    let color = shown(in);
    let substance = substances[pieces[in.number].substance];
    let share = color.a;
    if share <= 0.0 {
        discard;
    }
    // Through so many world units.
    let through = 1.0 - substance.opacity;
    let opacity = share * (1.0 - select(0.0, pow(through, stage.cell), through > 0.0));
    let tint = select(vec3f(0.0), pow(substance.tint, vec3f(stage.cell)), substance.tint > vec3f(0.0));
    return Matter(
        vec4f(substance.emission * color.rgb * opacity, share),
        vec4f(substance.albedo * min(color.rgb, vec3f(1.0)) * opacity, share),
        vec4f(tint * share, share),
        vec4f(opacity, 0.0, 0.0, share),
    );
}

// Radiance by which what is seen of a piece glows besides the light that falls on it.
@fragment
fn glow(in: Drawn) -> @location(0) vec4f {
    let share = shown(in).a;
    let substance = substances[pieces[in.number].substance];
    return vec4f(substance.emission * (substance.glow * share), share);
}
