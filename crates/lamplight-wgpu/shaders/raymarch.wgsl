// Light by rays (docs/raymarch.md): of every open cell the mean radiance over all directions, of
// every wall the mean over its faces. `receive` gathers the same for what reflects: each face of a
// wall by itself, fog.

override GOLDEN_RATIO: f32;
// Whether `traced` is asked for.
override TRACED: bool = false;

@group(0) @binding(2) var<storage, read> directions: array<vec2f>;
@group(0) @binding(8) var albedo: texture_2d<f32>;
// Light a cell, or what its faces send on.
@group(0) @binding(9) var<storage, read_write> light: array<vec4f>;
// Variance of the light's noise; 1 where what the cell sees changed.
@group(0) @binding(10) var<storage, read_write> traced: array<vec2f>;

// Sine and cosine of an angle from 0 to 2π, within 2e-7: shaders' own may be off by far more.
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
    let turn = sine_cosine(first_angle(at) * frame.gap);
    var sum = Sum();
    for (var ray = 0u; ray < frame.rays; ray++) {
        let d = directions[ray];
        let way = vec2f(turn.y * d.x - turn.x * d.y, turn.x * d.x + turn.y * d.y);
        add(&sum, ray, march(vec2f(at) + 0.5, vec2f(at), way, false));
    }
    return mean(sum);
}

// The mean over rays that start evenly along a face and leave with a density of ½cosθ.
fn over_face(at: vec2u, face: u32, normal: vec2f) -> Mean {
    let turn = first_angle(at);
    let shift = first_angle(at + vec2u(17u * (face + 1u), 29u));
    let tangent = vec2f(-normal.y, normal.x);
    let centre = vec2f(at) + 0.5 + 0.5 * normal;
    var sum = Sum();
    for (var ray = 0u; ray < frame.rays; ray++) {
        let sine = (f32(ray) + turn) * (2.0 / f32(frame.rays)) - 1.0;
        let cosine = sqrt(max(1.0 - sine * sine, 0.0));
        let along = fract(f32(ray) * GOLDEN_RATIO + shift) - 0.5;
        let way = cosine * normal + sine * tangent;
        add(&sum, ray, march(centre + along * tangent, vec2f(at) + normal, way, true));
    }
    return mean(sum);
}

// The mean over the faces of a wall; how noisy it is nobody asks.
fn on_wall(at: vec2u) -> Mean {
    var sum = Mean();
    var count = 0.0;
    for (var face = 0u; face < 4u; face++) {
        if exposed(at, face) {
            let received = over_face(at, face, vec2f(normal(face)));
            sum.light += received.light;
            sum.changed = max(sum.changed, received.changed);
            count += 1.0;
        }
    }
    sum.light /= max(count, 1.0);
    return sum;
}

// What a surface sends on of what it receives. Once it has seen a change it stays news for this frame.
fn sends(slot: u32, kind: f32, share: vec3f, received: Mean) -> vec4f {
    let news = TRACKS && (received.changed > 0.0 || (step > 0u && sent[slot].w >= CHANGED));
    return vec4f(share * received.light, kind + select(0.0, CHANGED, news));
}

@compute @workgroup_size(8, 8)
fn receive(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    let kind = source[i].w;
    let share = textureLoad(albedo, id.xy, 0).rgb;
    let reflects = any(share != vec3f(0.0));
    for (var face = 0u; face < 4u; face++) {
        let slot = 4u * i + face;
        if reflects && kind == SOLID && exposed(id.xy, face) {
            light[slot] = sends(slot, FACE, share, over_face(id.xy, face, vec2f(normal(face))));
        } else if reflects && kind == MEDIUM && face == 0u {
            light[slot] = sends(slot, VOLUME, share, over_circle(id.xy));
        } else {
            light[slot] = vec4f(0.0);
        }
    }
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if outside(id.xy) {
        return;
    }
    let i = index(id.xy);
    var seen: Mean;
    if source[i].w == SOLID {
        seen = on_wall(id.xy);
    } else {
        seen = over_circle(id.xy);
    }
    light[i] = vec4f(seen.light, 1.0);
    if TRACED {
        traced[i] = vec2f(seen.variance, seen.changed);
    }
}
