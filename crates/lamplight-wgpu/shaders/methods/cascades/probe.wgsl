// The radiance that a probe sees along a ray (docs/cascades.md): its own interval, then what the probes of
// the next cascade have gathered, `L = r + T·L_next`.

#import methods/cascades/interval
#import shared/moment
#import shared/sky
#import shared/uniforms

// True if a ray leads to each of the four probes around, so that every path is unbroken.
override BILINEAR_FIX: bool;

// `Path` in src/methods/cascades/ladder.rs, field by field.
struct Path {
    start: vec2f,
    // From its start to its end.
    step: vec2f,
    direction: vec2f,
    length: f32,
    // The sine by which it sees a gradient.
    sine: f32,
}

// `Layer` in src/methods/cascades/ladder.rs, field by field: one cascade in one batch, and the next cascade.
struct Layer {
    count: vec2u,
    spacing: f32,
    // The first of its paths.
    path: u32,
    far_count: vec2u,
    // 0 if the sky takes the place of a next cascade.
    far_spacing: f32,
    // Cones of the nearest cascade in this batch, and the first of them.
    cones: u32,
    cone: u32,
    // Rays of the nearest cascade.
    rays: u32,
    // The number of its first path among those of its cascade, and the angle that each stands for.
    number: u32,
    angle: f32,
}

@group(0) @binding(1) var<storage, read> paths: array<Path>;
@group(0) @binding(2) var<storage, read> far: array<vec4f>;
@group(0) @binding(8) var<uniform> layer: Layer;
@group(0) @binding(10) var panorama: texture_2d<f32>;

// Radiance, and its first moment, if it is found.
struct Seen {
    light: vec3f,
    moment_x: vec3f,
    moment_y: vec3f,
}

// The number of values that are stored per probe and cone.
fn values() -> u32 {
    return select(1u, 3u, MOMENT);
}

// The light of an interval, and what arrives from behind it.
fn behind(near: Interval, direction: vec2f, far: Seen) -> Seen {
    var seen = Seen();
    seen.light = near.light + near.transmittance * far.light;
    if MOMENT {
        seen.moment_x = near.light * direction.x + near.transmittance * far.moment_x;
        seen.moment_y = near.light * direction.y + near.transmittance * far.moment_y;
    }
    return seen;
}

// Adds a multiple.
fn add(sum: ptr<function, Seen>, weight: f32, seen: Seen) {
    (*sum).light += weight * seen.light;
    if MOMENT {
        (*sum).moment_x += weight * seen.moment_x;
        (*sum).moment_y += weight * seen.moment_y;
    }
}

// What a probe of the next cascade has gathered.
fn gathered(at: u32) -> Seen {
    var seen = Seen();
    seen.light = far[values() * at].rgb;
    if MOMENT {
        seen.moment_x = far[values() * at + 1u].rgb;
        seen.moment_y = far[values() * at + 2u].rgb;
    }
    return seen;
}

// The position of a probe. The lattice of probes is centred on the grid.
fn position(probe: vec2f, count: vec2u, spacing: f32) -> vec2f {
    return (probe - 0.5 * vec2f(count - 1u)) * spacing + 0.5 * vec2f(frame.size);
}

// The four probes of the next cascade around a point: the first, its index, and the weights of all.
struct Around {
    before: vec2f,
    first: u32,
    weight: vec4f,
}

fn around(at: vec2f) -> Around {
    if layer.far_spacing == 0.0 {
        return Around();
    }
    let last = vec2f(layer.far_count - 1u);
    let place = (at - 0.5 * vec2f(frame.size)) * (1.0 / layer.far_spacing) + 0.5 * last;
    let before = clamp(floor(place), vec2f(0.0), last - 1.0);
    let past = place - before;
    let left = 1.0 - past;
    let weight = vec4f(left.x * left.y, past.x * left.y, left.x * past.y, past.x * past.y);
    let first = vec2u(before);
    return Around(before, first.y * layer.far_count.x + first.x, weight);
}

// Radiance that arrives at a point by ray `ray` of the layer. `normal` is that of the face if the point lies
// on one, else 0: with the bilinear fix, rays that would run into the face itself are left out.
fn see(at: vec2f, around: Around, ray: u32, normal: vec2f) -> Seen {
    let path = paths[layer.path + ray];
    let start = at + path.start;
    let angles = f32(layer.number + ray) * layer.angle + vec2f(0.0, layer.angle);
    let columns = vec2f(sky_place(angles.x), sky_place(angles.y));
    if layer.far_spacing == 0.0 {
        let near = trace(start, path.direction, path.length, columns);
        if INFLOW {
            return behind(near, path.direction, Seen());
        }
        let sky = sky_between(path.sine, angles.x, angles.y);
        return behind(near, path.direction, Seen(sky, sky * path.direction.x, sky * path.direction.y));
    }
    let probes = layer.far_count.x * layer.far_count.y;
    let first = ray * probes + around.first;
    let on_face = any(normal != vec2f(0.0));
    var reach = max(abs(path.step.x), abs(path.step.y));
    if BILINEAR_FIX {
        reach += layer.far_spacing;
    }
    let clear = is_clear(start, reach);
    let traced = BILINEAR_FIX && !clear;
    var seen = Seen();
    var weights = 0.0;
    for (var corner = 0u; corner < 4u; corner++) {
        let offset = vec2u(corner & 1u, corner >> 1u);
        var weight = around.weight[corner];
        var light = gathered(first + offset.y * layer.far_count.x + offset.x);
        if traced {
            let probe = around.before + vec2f(offset);
            let shift = position(probe, layer.far_count, layer.far_spacing) - at;
            let step = shift + path.step;
            if on_face && dot(step, normal) <= 0.0 {
                continue;
            }
            let length = max(sqrt(dot(step, step)), 1e-30);
            let direction = step / length;
            light = behind(trace(start, direction, length, columns), direction, light);
        }
        weights += weight;
        add(&seen, weight, light);
    }
    if traced && on_face {
        // At least one of the four probes lies in the direction of the ray, so the weights are not all 0.
        return Seen(seen.light / weights, seen.moment_x / weights, seen.moment_y / weights);
    }
    if !BILINEAR_FIX && !clear {
        let near = trace(start, path.direction, path.length, columns);
        return behind(near, path.direction, seen);
    }
    return seen;
}
