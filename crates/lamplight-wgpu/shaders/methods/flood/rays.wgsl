// Rays drawn into the grid (`methods/flood` of the library). A cell keeps the brightest ray through it per
// channel, so the order of rays does not matter. Light is never negative, and nonnegative floats compare
// like their bits.

#import shared/absorptance
#import shared/angle
#import shared/class
#import shared/class_at
#import shared/hit
#import shared/lamps
#import shared/sky
#import shared/transmittance
#import shared/traverse
#import shared/uniforms

override RAYS: u32;
override MATTER_RAYS: u32;
override BOUNCE_RAYS: u32;
// The rule of the source: 1/(1 + STEEPNESS·d²/D), D the grid's longer side, up to REACH·√D px.
override STEEPNESS: f32;
override REACH: f32;
// Distance between the rays of a lamp per px of their length; 0 under the rule of the source.
override SPACING: f32;

@group(0) @binding(4) var emission: texture_2d<f32>;
@group(0) @binding(5) var albedo: texture_2d<f32>;
// Directions and their inverses: of lamps, then of matter, then of bounces.
@group(0) @binding(6) var<storage, read> directions: array<vec4f>;
// Four numbers per cell, the last unused.
@group(0) @binding(7) var<storage, read_write> cells: array<atomic<u32>>;
@group(0) @binding(8) var panorama: texture_2d<f32>;

const BY_SOURCE: u32 = 3u;
const VISITS_EMPTY: bool = true;

// The state of the current ray.
var<private> color: vec3f;
var<private> energy: f32;
// Distance to the next ray per px of length.
var<private> spacing: f32;
// Its source, which decides how it fades.
var<private> fading: Lamp;
// The last cell that it crossed, if it crossed any.
var<private> last_cell: vec2u;
var<private> crossed_any: bool;

fn longer_side() -> f32 {
    return f32(max(frame.size.x, frame.size.y));
}

fn fade(distance: f32) -> f32 {
    if fading.falloff == BY_SOURCE {
        return 1.0 / (1.0 + STEEPNESS * distance * distance / longer_side());
    }
    return falloff(fading, distance);
}

fn visit(enter: f32, leave: f32, cell: vec2u, cell_class: u32) {
    let distance = 0.5 * (enter + leave);
    let left = color * (energy * fade(distance) * max(spacing * distance, 1.0));
    for (var c = 0u; c < 3u; c++) {
        if left[c] > 0.0 {
            atomicMax(&cells[4u * index(cell) + c], bitcast<u32>(left[c]));
        }
    }
    if cell_class == MEDIUM {
        color *= exp(-extinction_of(textureLoad(matter, cell, 0)) * (leave - enter));
    }
    last_cell = cell;
    crossed_any = true;
}

fn direction_at(i: u32) -> Direction {
    let stored = directions[i];
    let sign = select(vec2f(-1.0), vec2f(1.0), stored.zw > vec2f(0.0));
    return Direction(stored.xy, sign, stored.zw);
}

// Draws a ray, and the rays that the solid cell at its end reflects, from the cell before it.
fn draw(origin: vec2f, ray: Direction, leaving: bool) {
    crossed_any = false;
    let hit = traverse(origin, ray, fading.reach, leaving, true);
    if hit.cell == NO_CELL || !crossed_any {
        return;
    }
    let own = textureLoad(albedo, unpacked(hit.cell), 0).rgb;
    if all(own == vec3f(0.0)) {
        return;
    }
    let reflected = color * own;
    let start = vec2f(last_cell) + 0.5;
    energy *= fade(hit.length);
    spacing = 0.0;
    for (var i = 0u; i < BOUNCE_RAYS; i++) {
        color = reflected;
        _ = traverse(start, direction_at(RAYS + MATTER_RAYS + i), fading.reach, false, true);
    }
}

@compute @workgroup_size(64)
fn lamp_rays(thread: RayThread) {
    let ray = ray_of(thread);
    if !ray.exists {
        return;
    }
    fading = lamps.list[ray.lamp];
    color = fading.strength;
    spacing = SPACING;
    energy = in_cone(fading, ray.number, fading.count);
    if energy > 0.0 && any(color > vec3f(0.0)) {
        draw(fading.position, direction_at(ray.number), false);
    }
}

// Sets the rule by which rays of matter and of the sky fade.
fn fade_by_source() {
    fading.falloff = BY_SOURCE;
    fading.reach = REACH * sqrt(longer_side());
    energy = 1.0;
}

// The radiance that leaves a cell: of solid cells if a face or a corner is open, of media the fraction that
// they do not transmit.
fn emitted(cell: vec2u) -> vec3f {
    let own = textureLoad(emission, cell, 0).rgb;
    let cell_class = class_at(vec2i(cell));
    if all(own == vec3f(0.0)) || cell_class == EMPTY || cell_class == OUTSIDE {
        return vec3f(0.0);
    }
    if cell_class == MEDIUM {
        return own * absorptance(extinction_of(textureLoad(matter, cell, 0)));
    }
    for (var i = 0i; i < 9i; i++) {
        if open(vec2i(cell) + vec2i(i % 3i - 1i, i / 3i - 1i)) {
            return own;
        }
    }
    return vec3f(0.0);
}

// The emitting cells of a tile, one after the other, so that its threads divide their rays evenly.
var<workgroup> emitting: array<u32, 64>;
var<workgroup> emitting_count: atomic<u32>;

@compute @workgroup_size(8, 8)
fn matter_rays(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    if !outside(id.xy) && any(emitted(id.xy) > vec3f(0.0)) {
        emitting[atomicAdd(&emitting_count, 1u)] = lane;
    }
    workgroupBarrier();
    let tasks = atomicLoad(&emitting_count) * MATTER_RAYS;
    for (var task = lane; task < tasks; task += 64u) {
        let place = emitting[task / MATTER_RAYS];
        let cell = 8u * tile.xy + vec2u(place % 8u, place / 8u);
        fade_by_source();
        color = emitted(cell);
        draw(vec2f(cell) + 0.5, direction_at(RAYS + task % MATTER_RAYS), true);
    }
}

// Rays from the middle of every outer side of a cell at the border.
@compute @workgroup_size(64)
fn sky_rays(thread: RayThread) {
    let task = first_ray(thread.group, thread.groups) + thread.lane;
    let ray = direction_at(RAYS + task % MATTER_RAYS);
    let size = frame.size;
    var side = task / MATTER_RAYS;
    var start: vec2f;
    var normal: vec2f;
    if side < 2u * size.x {
        start = vec2f(f32(side / 2u) + 0.5, select(0.0, f32(size.y), side % 2u == 1u));
        normal = vec2f(0.0, select(1.0, -1.0, side % 2u == 1u));
    } else {
        side -= 2u * size.x;
        start = vec2f(select(0.0, f32(size.x), side % 2u == 1u), f32(side / 2u) + 0.5);
        normal = vec2f(select(1.0, -1.0, side % 2u == 1u), 0.0);
        if side >= 2u * size.y {
            return;
        }
    }
    // What is narrow in a panorama may lie between two rays.
    let seen = -ray.along;
    let middle = angle(seen);
    let half = 0.5 * RADIANS_PER_TURN / f32(MATTER_RAYS);
    color = sky_between(seen.y, middle - half, middle + half);
    if dot(ray.along, normal) > 0.0 && any(color > vec3f(0.0)) {
        fade_by_source();
        draw(start, ray, false);
    }
}
