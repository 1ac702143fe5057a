// `flood`: rays drawn into the grid (`methods/flood` of the library). A cell keeps the brightest ray
// through it, channel by channel, so it does not matter which comes first: light is never negative,
// and floats that are not compare as their bits do.

override RAYS: u32;
override MATTER_RAYS: u32;
override BOUNCE_RAYS: u32;
// The rule of the source: 1/(1 + STEEPNESS·d²/D), D the grid's longer side, up to REACH·√D px.
override STEEPNESS: f32;
override REACH: f32;

@group(0) @binding(4) var emission: texture_2d<f32>;
@group(0) @binding(5) var albedo: texture_2d<f32>;
// Directions and their inverses: of lamps, then of matter, then of bounces.
@group(0) @binding(6) var<storage, read> ways: array<vec4f>;
// Four numbers a cell, the last unused.
@group(0) @binding(7) var<storage, read_write> cells: array<atomic<u32>>;

const BY_SOURCE: u32 = 3u;
const VISITS_EMPTY: bool = true;

// The ray on its way.
var<private> color: vec3f;
var<private> energy: f32;
// How it fades.
var<private> fading: Lamp;
// The last cell that it crossed, where it crossed any.
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

fn visit(enter: f32, leave: f32, cell: vec2u, kind: u32) {
    let left = color * (energy * fade(0.5 * (enter + leave)));
    for (var c = 0u; c < 3u; c++) {
        if left[c] > 0.0 {
            atomicMax(&cells[4u * index(cell) + c], bitcast<u32>(left[c]));
        }
    }
    if kind == FOG {
        color *= exp(log_transmittance(textureLoad(matter, cell, 0)) * (leave - enter));
    }
    last_cell = cell;
    crossed_any = true;
}

fn way_at(i: u32) -> Way {
    let known = ways[i];
    let sign = select(vec2f(-1.0), vec2f(1.0), known.zw > vec2f(0.0));
    return Way(known.xy, sign, known.zw);
}

// Draws a ray, and those that are sent on from before the wall where it ends.
fn draw(from_: vec2f, way: Way, leaving: bool) {
    crossed_any = false;
    let hit = walk(from_, way, fading.reach, leaving, true);
    if hit.cell == NO_CELL || !crossed_any {
        return;
    }
    let wall = vec2u(hit.cell & 0xffffu, hit.cell >> 16u);
    let share = textureLoad(albedo, wall, 0).rgb;
    if all(share == vec3f(0.0)) {
        return;
    }
    let sent = color * share;
    let start = vec2f(last_cell) + 0.5;
    energy *= fade(hit.length);
    for (var i = 0u; i < BOUNCE_RAYS; i++) {
        color = sent;
        _ = walk(start, way_at(RAYS + MATTER_RAYS + i), fading.reach, false, true);
    }
}

@compute @workgroup_size(64)
fn lamp_rays(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let ray = ray_of(group, groups, lane);
    if !ray.is_one {
        return;
    }
    fading = lamps.list[ray.lamp];
    color = fading.strength;
    energy = in_cone(fading, ray.number, fading.count);
    if energy > 0.0 && any(color > vec3f(0.0)) {
        draw(fading.position, way_at(ray.number), false);
    }
}

// As the rays of matter and of the sky fade.
fn fade_by_source() {
    fading.falloff = BY_SOURCE;
    fading.reach = REACH * sqrt(longer_side());
    energy = 1.0;
}

// What a cell sends out: walls with a face or a corner in the open, fog by the share it stops.
fn glow(cell: vec2u) -> vec3f {
    let own = textureLoad(emission, cell, 0).rgb;
    let kind = kind_at(vec2i(cell));
    if all(own == vec3f(0.0)) || kind == EMPTY || kind == BEYOND {
        return vec3f(0.0);
    }
    if kind == FOG {
        return own * (1.0 - exp(log_transmittance(textureLoad(matter, cell, 0))));
    }
    for (var i = 0i; i < 9i; i++) {
        if open(vec2i(cell) + vec2i(i % 3i - 1i, i / 3i - 1i)) {
            return own;
        }
    }
    return vec3f(0.0);
}

// Cells of a tile that glow, one after the other, so that its threads share their rays evenly.
var<workgroup> glowing: array<u32, 64>;
var<workgroup> glowing_count: atomic<u32>;

@compute @workgroup_size(8, 8)
fn matter_rays(
    @builtin(global_invocation_id) id: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    if !outside(id.xy) && any(glow(id.xy) > vec3f(0.0)) {
        glowing[atomicAdd(&glowing_count, 1u)] = lane;
    }
    workgroupBarrier();
    let tasks = atomicLoad(&glowing_count) * MATTER_RAYS;
    for (var task = lane; task < tasks; task += 64u) {
        let place = glowing[task / MATTER_RAYS];
        let cell = 8u * tile.xy + vec2u(place % 8u, place / 8u);
        fade_by_source();
        color = glow(cell);
        draw(vec2f(cell) + 0.5, way_at(RAYS + task % MATTER_RAYS), true);
    }
}

// Rays from the middle of every side of a cell at the border.
@compute @workgroup_size(64)
fn sky_rays(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) lane: u32,
) {
    let task = (group.y * groups.x + group.x) * 64u + lane;
    let way = way_at(RAYS + task % MATTER_RAYS);
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
    color = sky(-way.along.y);
    if dot(way.along, normal) > 0.0 && any(color > vec3f(0.0)) {
        fade_by_source();
        draw(start, way, false);
    }
}
