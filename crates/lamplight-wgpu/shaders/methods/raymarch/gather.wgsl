// Gathers light by rays (docs/raymarch.md): for each open cell the mean radiance over all directions, for
// each solid cell the mean over its faces. `receive` gathers for each face of a solid cell, and each medium,
// what it scatters. The importing shader defines `march`.

#import methods/raymarch/accumulate
#import shared/class
#import shared/moment
#import shared/noise
#import shared/normal
#import shared/receive
#import shared/scatter
#import shared/surfaces
#import shared/uniforms

override GOLDEN_RATIO: f32;
// True if `traced` is needed.
override TRACED: bool = false;

@group(0) @binding(2) var<storage, read> directions: array<vec2f>;
@group(0) @binding(8) var albedo: texture_2d<f32>;
// Light of each cell, or scattered radiance of its faces.
@group(0) @binding(9) var<storage, read_write> light: array<vec4f>;
// Variance of the light's noise; 1 if what the cell sees changed.
@group(0) @binding(10) var<storage, read_write> traced: array<vec2f>;
@group(0) @binding(11) var panorama: texture_2d<f32>;

// Sine and cosine of an angle from 0 to 2π, within 2e-7: the built-in functions may be far less precise.
fn sine_cosine(angle: f32) -> vec2f {
    let quarter = round(angle * 0.63661977);
    // π/2 in two parts.
    let x = (angle - quarter * 1.5707964) + quarter * 4.371139e-8;
    let y = x * x;
    let sine = x + x * y * (-0.16666667 + y * (0.008333331 + y * (-0.00019840874 + y * 2.7525562e-6)));
    let cosine = 1.0 + y * (-0.5 + y * (0.041666638 + y * (-0.0013888378 + y * 2.4760495e-5)));
    let turn = u32(quarter) % 4u;
    let swapped = select(vec2f(sine, cosine), vec2f(cosine, sine), (turn & 1u) == 1u);
    return swapped * vec2f(select(1.0, -1.0, turn >= 2u), select(1.0, -1.0, turn == 1u || turn == 2u));
}

fn over_circle(at: vec2u) -> Mean {
    let rotation = sine_cosine(jitter(at) * frame.stride);
    var sum = Sum();
    for (var ray = 0u; ray < frame.rays; ray++) {
        let d = directions[ray];
        let direction = vec2f(rotation.y * d.x - rotation.x * d.y, rotation.x * d.x + rotation.y * d.y);
        let seen = march(vec2f(at) + 0.5, vec2f(at), direction, false);
        add(&sum, ray, seen);
        if MOMENT {
            sum.moment_x += direction.x * seen.rgb;
            sum.moment_y += direction.y * seen.rgb;
        }
    }
    return mean(sum);
}

// The irradiance of a face: the mean over rays that start evenly along it and leave with a density of
// ½cosθ.
fn over_face(at: vec2u, face: u32, normal: vec2f) -> Mean {
    let axis = select(1u, 0u, normal.x == 0.0);
    let offset = jitter_along(at[axis], axis);
    let shift = jitter(at + vec2u(17u * (face + 1u), 29u));
    let tangent = vec2f(-normal.y, normal.x);
    let centre = vec2f(at) + 0.5 + 0.5 * normal;
    var sum = Sum();
    for (var ray = 0u; ray < frame.rays; ray++) {
        let sine = (f32(ray) + offset) * (2.0 / f32(frame.rays)) - 1.0;
        let cosine = sqrt(max(1.0 - sine * sine, 0.0));
        let along = fract(f32(ray) * GOLDEN_RATIO + shift) - 0.5;
        let direction = cosine * normal + sine * tangent;
        add(&sum, ray, march(centre + along * tangent, vec2f(at) + normal, direction, true));
    }
    return mean(sum);
}

// The mean over the faces of a solid cell.
fn over_faces(at: vec2u) -> Mean {
    var sum = Mean();
    var count = 0.0;
    for (var face = 0u; face < 4u; face++) {
        if exposed(at, face) {
            let irradiance = over_face(at, face, vec2f(normal(face)));
            sum.light += irradiance.light;
            sum.variance += irradiance.variance;
            sum.invalidated = max(sum.invalidated, irradiance.invalidated);
            count += 1.0;
        }
    }
    sum.light /= max(count, 1.0);
    sum.variance /= max(count * count, 1.0);
    return sum;
}

// The scattered radiance of a scatterer. Once it has seen a change it stays invalidated for this frame.
fn scatterer(slot: u32, kind: f32, albedo: vec3f, incoming: Mean) -> vec4f {
    let invalidated = TRACKS
        && (incoming.invalidated > 0.0 || (step > 0u && scattered[slot].w >= INVALIDATED));
    return vec4f(albedo * incoming.light, kind + select(0.0, INVALIDATED, invalidated));
}

fn reflect_face(slot: u32, albedo: vec3f, at: vec2u, face: u32) {
    light[slot] = scatterer(slot, FACE, albedo, over_face(at, face, vec2f(normal(face))));
}

fn scatter(slot: u32, albedo: vec3f, at: vec2u) {
    light[slot] = scatterer(slot, VOLUME, albedo, over_circle(at));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    var seen: Mean;
    if class_of(source[i]) == SOLID {
        seen = over_faces(id.xy);
    } else {
        seen = over_circle(id.xy);
    }
    light[i] = vec4f(seen.light, 1.0);
    if MOMENT {
        light[moment_index(0u, i)] = vec4f(seen.moment_x, 1.0);
        light[moment_index(1u, i)] = vec4f(seen.moment_y, 1.0);
    }
    if TRACED {
        traced[i] = vec2f(seen.variance, seen.invalidated);
    }
}
