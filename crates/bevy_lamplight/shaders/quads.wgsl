// Quads of matter, drawn on the lit grid and, if they emit light, on the screen.

const CIRCLE: u32 = 1u;
const CAPSULE: u32 = 2u;
const TRIANGLE: u32 = 3u;
const LAMP: u32 = 4u;
// The bit of a shape that covers cells by the fraction of their area where its material lets light through.
const BY_AREA: u32 = 8u;

// `TargetTransform` in src/render/pipelines.rs: from cells to the render target.
struct TargetTransform {
    x_axis: vec2f,
    y_axis: vec2f,
    origin: vec2f,
    // Pixels of the target.
    size: vec2f,
    // World units per cell.
    cell: f32,
    unused_0: f32,
    unused_1: vec2f,
}

// Attributes of an instance: `Quad` in src/quads/quad.rs, on the grid (cells, y down), and its `QuadMaterial` in
// src/quads/material.rs.
struct QuadIn {
    // The x axis and the y axis.
    @location(0) axes: vec4f,
    // The origin, and the x axis of the texels.
    @location(1) origin_texels: vec4f,
    // The y axis and the origin of the texels.
    @location(2) texels: vec4f,
    @location(3) color: vec4f,
    // The shape and the layer of the image.
    @location(4) numbers: vec2u,
    @location(5) param: f32,
    // The emission and the opacity.
    @location(6) emission: vec4f,
    // The tint and the glow.
    @location(7) tint: vec4f,
    @location(8) albedo: vec3f,
    // The encoding of a normal map, or light layers.
    @location(9) bits: u32,
}

struct Quad {
    x_axis: vec2f,
    y_axis: vec2f,
    origin: vec2f,
    texels_x: vec2f,
    texels_y: vec2f,
    texels_origin: vec2f,
    color: vec4f,
    shape: u32,
    layer: u32,
    param: f32,
}

struct Material {
    emission: vec3f,
    opacity: f32,
    tint: vec3f,
    glow: f32,
    albedo: vec3f,
    bits: u32,
}

@group(0) @binding(0) var<uniform> target_transform: TargetTransform;
// `image_at` samples the image of a quad; it is written by src/render/pipelines.rs.

struct VertexOut {
    @builtin(position) position: vec4f,
    // Place in the unit square.
    @location(0) unit: vec2f,
    // The quad, as in `QuadIn`.
    @location(1) @interpolate(flat) axes: vec4f,
    @location(2) @interpolate(flat) origin_texels: vec4f,
    @location(3) @interpolate(flat) texels: vec4f,
    @location(4) @interpolate(flat) color: vec4f,
    @location(5) @interpolate(flat) numbers: vec3u,
    @location(6) @interpolate(flat) emission: vec4f,
    @location(7) @interpolate(flat) tint: vec4f,
    @location(8) @interpolate(flat) albedo: vec3f,
    // Centre and radius of a lamp, in pixels of the target, and the parameter of the shape.
    @location(9) @interpolate(flat) disc: vec4f,
}

fn quad_of(in: VertexOut) -> Quad {
    return Quad(
        in.axes.xy, in.axes.zw, in.origin_texels.xy, in.origin_texels.zw, in.texels.xy, in.texels.zw,
        in.color, in.numbers.x, in.numbers.y, in.disc.w,
    );
}

fn material_of(in: VertexOut) -> Material {
    return Material(in.emission.rgb, in.emission.a, in.tint.rgb, in.tint.a, in.albedo, in.numbers.z);
}

fn shape_of(quad: Quad) -> u32 {
    return quad.shape & (BY_AREA - 1u);
}

fn is_by_area(quad: Quad, opacity: f32) -> bool {
    return (quad.shape & BY_AREA) != 0u && opacity < 1.0;
}

fn clip(cell: vec2f) -> vec2f {
    let to = target_transform;
    return cell.x * to.x_axis + cell.y * to.y_axis + to.origin;
}

fn pixel(cell: vec2f) -> vec2f {
    return (clip(cell) * vec2f(0.5, -0.5) + 0.5) * target_transform.size;
}

// Two triangles that cover the unit square. For a triangle, the second one is degenerate.
@vertex
fn place(@builtin(vertex_index) vertex: u32, in: QuadIn) -> VertexOut {
    let corners = array(
        vec2f(0.0, 0.0), vec2f(1.0, 0.0), vec2f(0.0, 1.0),
        vec2f(1.0, 0.0), vec2f(1.0, 1.0), vec2f(0.0, 1.0),
    );
    var out = VertexOut();
    out.axes = in.axes;
    out.origin_texels = in.origin_texels;
    out.texels = in.texels;
    out.color = in.color;
    out.numbers = vec3u(in.numbers, in.bits);
    out.emission = in.emission;
    out.tint = in.tint;
    out.albedo = in.albedo;
    out.disc.w = in.param;
    let quad = quad_of(out);
    var unit = corners[vertex];
    let shape = shape_of(quad);
    if shape == TRIANGLE && vertex >= 3u {
        unit = vec2f(0.0);
    }
    if shape == LAMP {
        let middle = pixel(quad.origin + 0.5 * (quad.x_axis + quad.y_axis));
        let radius = 0.5 * distance(pixel(quad.origin), pixel(quad.origin + quad.x_axis));
        out.disc = vec4f(middle, radius, in.param);
        // Covers every pixel that the disc touches, not only those whose centre it contains.
        unit += (unit - 0.5) * 1.5 / max(radius, 1e-3);
    }
    if is_by_area(quad, in.emission.a) {
        let ends = mat2x2f(pixel(quad.x_axis) - pixel(vec2f(0.0)), pixel(quad.y_axis) - pixel(vec2f(0.0)));
        // The distance between opposite sides; their pixels reach a px farther.
        let area = abs(determinant(ends));
        unit += (unit - 0.5) * 2.0 * vec2f(length(ends[1]), length(ends[0])) / max(area, 1e-3);
    }
    let at = quad.origin + unit.x * quad.x_axis + unit.y * quad.y_axis;
    out.position = vec4f(clip(at), 0.0, 1.0);
    out.unit = unit;
    return out;
}

// The half chord of a disc, integrated from its centre: ∫₀ᵗ √(r² − s²) ds.
fn integral(t: f32, r: f32) -> f32 {
    return 0.5 * (t * sqrt(max(r * r - t * t, 0.0)) + r * r * asin(clamp(t / r, -1.0, 1.0)));
}

// The area of a disc around the origin to the left of x and above y; the counterpart of
// `coverage.rs` in `lamplight`.
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

// The last place of a side of the unit square.
const LAST: f32 = 0.99999994;

// Fractions closer to 0 or 1 than this are rounding errors.
const ROUNDING: f32 = 1e-4;

// A covered fraction without what rounding adds or leaves: a trace of fog would make a wall a medium.
fn snapped(area: f32) -> f32 {
    return select(select(area, 1.0, area > 1.0 - ROUNDING), 0.0, area < ROUNDING);
}

// The fraction of a pixel that a disc covers.
fn disc_coverage(disc: vec3f, center: vec2f) -> f32 {
    let low = center - 0.5 - disc.xy;
    let high = low + 1.0;
    let area = corner_area(high, disc.z) - corner_area(vec2f(low.x, high.y), disc.z)
        - corner_area(vec2f(high.x, low.y), disc.z) + corner_area(low, disc.z);
    return snapped(area);
}

// The depth of a point of the unit square inside a circle or an upright capsule; below 0 outside. The unit is arbitrary.
fn depth(quad: Quad, unit: vec2f) -> f32 {
    if shape_of(quad) == CIRCLE {
        return 0.5 - length(unit - 0.5);
    }
    let across = 2.0 * abs(unit - 0.5) * vec2f(quad.param, 1.0);
    return quad.param - length(vec2f(across.x, max(across.y - (1.0 - quad.param), 0.0)));
}

// The fraction of a pixel that the unit square covers of one axis: `at` is the place of the pixel's middle, `width` its
// width on the axis.
fn overlap(at: f32, width: f32) -> f32 {
    return max(min(at + 0.5 * width, 1.0) - max(at - 0.5 * width, 0.0), 0.0) / max(width, 1e-12);
}

// The fraction of a pixel that a quad covers by its area. `right` and `down` are the steps of a pixel in the unit square.
// Exact for upright squares, elsewhere as if the edge were straight and faced the pixel.
fn area(quad: Quad, unit: vec2f, right: vec2f, down: vec2f) -> f32 {
    if shape_of(quad) == CIRCLE || shape_of(quad) == CAPSULE {
        let slope = vec2f(
            depth(quad, unit + 0.5 * right) - depth(quad, unit - 0.5 * right),
            depth(quad, unit + 0.5 * down) - depth(quad, unit - 0.5 * down),
        );
        return snapped(saturate(0.5 + depth(quad, unit) / max(length(slope), 1e-12)));
    }
    return snapped(overlap(unit.x, length(vec2f(right.x, down.x))) * overlap(unit.y, length(vec2f(right.y, down.y))));
}

// The colour of a quad; alpha is the fraction of the pixel that it covers.
fn color_at(in: VertexOut) -> vec4f {
    let quad = quad_of(in);
    let right = dpdx(in.unit);
    let down = dpdy(in.unit);
    let by_area = is_by_area(quad, in.emission.a);
    // Beyond the edge its nearest texel counts.
    let unit = select(in.unit, clamp(in.unit, vec2f(0.0), vec2f(LAST)), by_area);
    let texel = quad.texels_origin + unit.x * quad.texels_x + unit.y * quad.texels_y;
    var color = image_at(texel, quad.layer) * quad.color;
    if shape_of(quad) == CIRCLE || shape_of(quad) == CAPSULE {
        color.a *= f32(by_area || depth(quad, in.unit) >= 0.0);
    } else if shape_of(quad) == LAMP {
        color.a *= disc_coverage(in.disc.xyz, in.position.xy);
    } else if quad.param < 0.0 {
        color.a = 1.0;
    } else if quad.param > 0.0 {
        color.a = f32(color.a >= quad.param);
    }
    if by_area {
        color.a *= area(quad, in.unit, right, down);
    }
    return clamp(color, vec4f(0.0), vec4f(65504.0, 65504.0, 65504.0, 1.0));
}

// The largest radiance, as `BRIGHTEST` of components/lamps.rs.
const BRIGHTEST: f32 = 60000.0;

// Sums over everything in a cell, composited from bottom to top. Emission and albedo are weighted by
// opacity, as in `Matter::over` of `lamplight`.
struct Matter {
    @location(0) emission: vec4f,
    @location(1) albedo: vec4f,
    @location(2) tint: vec4f,
    @location(3) opacity: vec4f,
}

@fragment
fn matter(in: VertexOut) -> Matter {
    let color = color_at(in);
    let material = material_of(in);
    let coverage = color.a;
    if coverage <= 0.0 {
        discard;
    }
    // Per cell instead of per world unit.
    let cell = target_transform.cell;
    let transmittance = 1.0 - material.opacity;
    let opacity = coverage * (1.0 - select(0.0, pow(transmittance, cell), transmittance > 0.0));
    let tint = select(vec3f(0.0), pow(material.tint, vec3f(cell)), material.tint > vec3f(0.0));
    return Matter(
        vec4f(min(material.emission * color.rgb, vec3f(BRIGHTEST)) * opacity, coverage),
        vec4f(material.albedo * min(color.rgb, vec3f(1.0)) * opacity, coverage),
        vec4f(tint * coverage, coverage),
        vec4f(opacity, 0.0, 0.0, coverage),
    );
}

// The emission coefficient of a lamp of this radiance L and radius R, `2L/(πR)`, by coverage: the counterpart
// of `lamp_discs.rs` in `lamplight`.
@fragment
fn lamp(in: VertexOut) -> @location(0) vec4f {
    let material = material_of(in);
    return vec4f(material.emission * (color_at(in).a * 0.6366197724 / in.disc.z), 0.0);
}

// The emitted radiance of a quad on the screen, which is added to the light that it reflects.
@fragment
fn glow(in: VertexOut) -> @location(0) vec4f {
    let coverage = color_at(in).a;
    let material = material_of(in);
    return vec4f(material.emission * (material.glow * coverage), coverage);
}

// The light layers of a quad, in the cells of which it covers half or more.
@fragment
fn layers(in: VertexOut) -> @location(0) f32 {
    if color_at(in).a < 0.5 {
        discard;
    }
    return f32(material_of(in).bits) / 255.0;
}
